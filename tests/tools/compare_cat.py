"""Compares the output of `grainlab bag cat` with what independent readers give.

compare_cat.py mcap FILE.mcap LINES    every message by mcap and mcap-ros2-support
compare_cat.py rosbags PATH LINES      every message by rosbags; PATH is a directory or a file

Times, topics, types and all values have to be equal. Prints the number of messages; exit 1 at the first difference.
"""

import json
import math
import struct
import sys
from pathlib import Path


def plain(value):
    """A decoded message as JSON has it."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        if math.isnan(value):
            return "NaN"
        return value if math.isfinite(value) else ("Infinity" if value > 0 else "-Infinity")
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, (list, tuple, bytes, bytearray, memoryview)):
        return [plain(v) for v in value]
    names = getattr(value, "__slots__", None) or getattr(value, "__dataclass_fields__", None) or vars(value)
    return {name: plain(getattr(value, name)) for name in names if not name.startswith("_")}


def by_mcap(path):
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=True):
            yield channel.topic, schema.name, message.log_time, plain(decoded)


def by_rosbags(path):
    from rosbags.highlevel import AnyReader

    with AnyReader([Path(path)]) as reader:
        for connection, time, data in reader.messages():
            decoded = plain(reader.deserialize(data, connection.msgtype))
            # Constants and dummies of rosbags are not fields.
            yield connection.topic, connection.msgtype, time, decoded


def common(ours, theirs):
    """`theirs` without what is not a field of the message."""
    if isinstance(ours, dict) and isinstance(theirs, dict):
        assert set(ours) <= set(theirs), (set(ours), set(theirs))
        return {name: common(ours[name], theirs[name]) for name in ours}
    if isinstance(ours, list) and isinstance(theirs, list) and len(ours) == len(theirs):
        return [common(a, b) for a, b in zip(ours, theirs)]
    if isinstance(ours, float) and abs(ours) < 3e38 and as_float32(ours) == theirs:
        return ours
    return theirs


def as_float32(value):
    """`grainlab bag cat` prints a float32 with as many digits as it needs; the readers give it as a double."""
    return struct.unpack("f", struct.pack("f", value))[0]


def key(entry):
    return entry["log_time"], entry["topic"]


def main(reader, path, lines):
    with open(lines, encoding="utf8") as file:
        ours = sorted(map(json.loads, file), key=key)
    names = ("topic", "type", "log_time", "data")
    found = ({"mcap": by_mcap, "rosbags": by_rosbags}[reader])(path)
    theirs = sorted((dict(zip(names, m)) for m in found), key=key)
    if len(ours) != len(theirs):
        sys.exit(f"{len(ours)} lines, {len(theirs)} messages by {reader}")
    for a, b in zip(ours, theirs):
        a = {name: a[name] for name in names}
        if a != dict(b, data=common(a["data"], b["data"])):
            sys.exit(f"grainlab: {a}\n{reader}: {b}")
    print(len(ours))


if __name__ == "__main__":
    main(*sys.argv[1:])
