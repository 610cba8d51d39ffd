"""Listens on an interface until SIGTERM. Prints what passed: frames of the WireGuard port, frames with RTPS in clear
text, and the kinds of all other IP packets, those by which the kernel finds neighbours and groups excepted."""

import json
import signal
import socket
import sys

WIREGUARD = 51820
UDP = 17
# IGMP, which the bridge itself sends, too; ICMPv6 and hop-by-hop options.
KERNEL = {(4, 2), (6, 58), (6, 0)}


def kind(frame):
    """Protocol and UDP ports of a frame; None without IP."""
    version = {b"\x08\x00": 4, b"\x86\xdd": 6}.get(frame[12:14])
    if version is None:
        return None
    header = 4 * (frame[14] & 15) if version == 4 else 40
    protocol = frame[14 + (9 if version == 4 else 6)]
    ports = frame[14 + header : 18 + header]
    return version, protocol, int.from_bytes(ports[:2], "big"), int.from_bytes(ports[2:], "big")


def main():
    listener = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(3))
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 26)
    listener.bind((sys.argv[1], 0))
    heard = {"wireguard": 0, "clear": 0, "others": []}

    def end(*_):
        print(json.dumps(heard), flush=True)
        sys.exit()

    signal.signal(signal.SIGTERM, end)
    print("listening", file=sys.stderr, flush=True)
    while True:
        frame = listener.recv(65536)
        heard["clear"] += b"RTPS" in frame
        found = kind(frame)
        if found is None or found[:2] in KERNEL:
            continue
        if found[1] == UDP and WIREGUARD in found[2:]:
            heard["wireguard"] += 1
        elif list(found) not in heard["others"] and len(heard["others"]) < 20:
            heard["others"].append(list(found))


main()
