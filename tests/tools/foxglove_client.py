"""A client of the Foxglove WebSocket protocol that is not ours.

foxglove_client.py read PORT SECONDS RECORDING PICTURED TOPIC...
    subscribes to the topics as soon as they are advertised, and to nothing else; after SECONDS without a message, compares
    what came with RECORDING, and pictures with PICTURED, byte for byte, decodes every message by mcap-ros2-support, and prints
    the number of messages of each topic as JSON. It waits until both recordings exist.
foxglove_client.py stall PORT
    subscribes to everything and reads nothing any longer, until its standard input ends.
"""

import json
import socket
import struct
import sys
import time
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2._dynamic import generate_dynamic
from websockets.sync.client import connect

PICTURES = ("/packing/points", "/packing/markers")


def join(port, **options):
    """A connection, for a `with`, once the server is there."""
    limit = time.monotonic() + 20
    while True:
        try:
            socket.create_connection(("127.0.0.1", int(port))).close()
            break
        except OSError:
            if time.monotonic() > limit:
                raise
            time.sleep(0.05)
    options |= {"subprotocols": ["foxglove.sdk.v1"], "max_size": None, "compression": None}
    return connect(f"ws://127.0.0.1:{port}", **options)


class Reader:
    """Subscriptions of one client, and the messages that came."""

    def __init__(self, client, topics):
        self.client = client
        self.topics = set(topics)
        self.channels = {}
        self.names = {}
        self.messages = {}
        self.advertised = set()

    def handle(self, frame):
        """One frame; true for a message of a topic."""
        if isinstance(frame, bytes):
            kind, subscription, log_time = struct.unpack_from("<BIQ", frame)
            if kind != 1:
                return False
            self.messages.setdefault(self.names[subscription], []).append((log_time, frame[13:]))
            return True
        text = json.loads(frame)
        if text["op"] == "advertise":
            new = []
            for channel in text["channels"]:
                self.advertised.add(channel["topic"])
                if channel["topic"] not in self.topics:
                    continue
                assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg"), channel
                self.channels[channel["topic"]] = channel
                self.names[len(self.names)] = channel["topic"]
                new.append({"id": len(self.names) - 1, "channelId": channel["id"]})
            if new:
                self.client.send(json.dumps({"op": "subscribe", "subscriptions": new}))
        return False

    def run(self, seconds, done):
        """Until nothing has come for some seconds and `done` is true."""
        last = time.monotonic()
        while not (done() and time.monotonic() - last > seconds):
            try:
                if self.handle(self.client.recv(timeout=0.2)):
                    last = time.monotonic()
            except TimeoutError:
                pass


def recorded(path):
    """The payloads of each topic of a recording."""
    files = [path] if path.is_file() else sorted(path.glob("*.mcap"))
    found = {}
    for file in files:
        with open(file, "rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages():
                found.setdefault(channel.topic, set()).add(message.data)
    return found


def read(port, seconds, recording, pictured, *topics):
    recording, pictured = Path(recording), Path(pictured)
    with join(port) as client:
        reader = Reader(client, topics)
        reader.run(float(seconds), lambda: recording.exists() and pictured.exists())
    truth = recorded(recording) | {name: recorded(pictured)[name] for name in PICTURES}
    counts = {}
    for topic, messages in reader.messages.items():
        channel = reader.channels[topic]
        decode = generate_dynamic(channel["schemaName"], channel["schema"])[channel["schemaName"]]
        for _, payload in messages:
            decoded = decode(payload)
            assert payload in truth[topic], f"{topic}: not in the recording: {decoded}"
        times = [log_time for log_time, _ in messages]
        assert all(time > 1_700_000_000_000_000_000 for time in times), times[0]
        counts[topic] = len(messages)
    print(json.dumps({"counts": counts, "advertised": sorted(reader.advertised)}))


def stall(port):
    with join(port, max_queue=1) as client:
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        subscribed = set()
        while not {"/packing", "/packing/markers", "/stress"} <= subscribed:
            frame = client.recv()
            text = json.loads(frame) if isinstance(frame, str) else {}
            for channel in text.get("channels", []) if text.get("op") == "advertise" else []:
                wanted = [{"id": channel["id"], "channelId": channel["id"]}]
                client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
                subscribed.add(channel["topic"])
        print(json.dumps({"subscribed": sorted(subscribed)}), flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    {"read": read, "stall": stall}[sys.argv[1]](*sys.argv[2:])
