#!/usr/bin/env python3
"""Topics of types that grainlab does not have, published and read by CycloneDDS: messages as one JSON object, by topic.

   foreign_peer.py publish     waits for a reader of each topic, publishes, prints what was sent
   foreign_peer.py listen      prints what arrived: ends when all topics have as many messages as `publish` sends
   foreign_peer.py count TOPIC N    strings "0" to "N - 1" that a reliable reader, which keeps all, has until their writer leaves

The last topic of `publish` appears when the others are done.
"""
import json
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "msgs/python"))
import grainlab_msgs as lab  # noqa: E402 (the path above; sets CYCLONEDDS_URI)
from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import final  # noqa: E402
from cyclonedds.idl.types import array, float64, sequence, uint8, uint32  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402
from grainlab_msgs import message  # noqa: E402

MESSAGES, LIMIT = 30, 40.0
Header = message("std_msgs/msg/Header")


@dataclass
@final
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str = ""


@dataclass
@final
class One(IdlStruct, typename="demo_msgs::msg::dds_::One_"):
    value: uint8 = 0


@dataclass
@final
class Pair(IdlStruct, typename="demo_msgs::msg::dds_::Pair_"):
    header: Header = field(default_factory=Header)
    ones: sequence[One] = field(default_factory=list)
    xyz: array[float64, 3] = field(default_factory=lambda: [0.0] * 3)
    ok: bool = False


@dataclass
@final
class Mystery(IdlStruct, typename="demo_msgs::msg::dds_::Mystery_"):
    n: uint32 = 0
    text: str = ""


def qos(reliability, durability, depth):
    history = Policy.History.KeepLast(depth) if depth else Policy.History.KeepAll
    return Qos(reliability, durability, history,
               Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False))


RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
STREAM = qos(RELIABLE, Policy.Durability.Volatile, 1000)
SENSOR = qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, 100)
LATCHED = qos(RELIABLE, Policy.Durability.TransientLocal, 100)


def pair(n):
    header = Header(frame_id=f"frame {n}")
    header.stamp.sec, header.stamp.nanosec = n, 7 * n
    return Pair(header, [One(k) for k in range(n % 5)], [0.1 * n, -n / 3, 1e-300], n % 2 == 0)


TOPICS = {
    "/chatter": (String, STREAM, lambda n: String("né " * (n % 7) + str(n))),
    "/scan/pairs": (Pair, SENSOR, pair),
    "/mystery": (Mystery, LATCHED, lambda n: Mystery(n, "?" * n)),
    "/late": (String, STREAM, lambda n: String(f"late {n}")),
}


def until(ready, trouble):
    end = time.monotonic() + LIMIT
    while not ready():
        if time.monotonic() > end:
            sys.exit(trouble)
        time.sleep(0.01)


def publish():
    participant = DomainParticipant(lab.domain())
    sent, writers = {name: [] for name in TOPICS}, {}
    names = list(TOPICS)
    for group in (names[:-1], names[-1:]):
        for name in group:
            kind, policies, _ = TOPICS[name]
            writers[name] = DataWriter(participant, Topic(participant, f"rt{name}", kind, qos=policies), qos=policies)
        for name in group:
            until(lambda: writers[name].get_publication_matched_status().current_count, f"nobody reads {name}")
        # A best-effort reader may know of the writer a little later than the writer of it.
        time.sleep(1.0)
        for n in range(MESSAGES):
            for name in group:
                value = TOPICS[name][2](n)
                writers[name].write(value)
                sent[name].append(asdict(value))
            time.sleep(0.02)
    time.sleep(1.0)
    return sent


def listen():
    participant = DomainParticipant(lab.domain())
    readers = {name: DataReader(participant, Topic(participant, f"rt{name}", kind, qos=policies), qos=policies)
               for name, (kind, policies, _) in TOPICS.items()}
    heard = {name: [] for name in TOPICS}
    end = time.monotonic() + LIMIT
    while time.monotonic() < end and any(len(messages) < MESSAGES for messages in heard.values()):
        for name, source in readers.items():
            heard[name] += [asdict(m) for m in source.take(256) if m.__class__.__name__ != "InvalidSample"]
        time.sleep(0.002)
    return heard


def count(topic, expected):
    policies = qos(RELIABLE, Policy.Durability.Volatile, None)
    participant = DomainParticipant(lab.domain())
    source = DataReader(participant, Topic(participant, f"rt{topic}", String, qos=policies), qos=policies)
    arrived, matched = [], False
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        new = [m.data for m in source.take(1000) if m.__class__.__name__ != "InvalidSample"]
        arrived += new
        present = bool(source.get_subscription_matched_status().current_count)
        if matched and not present and not new:
            break
        matched |= present
        time.sleep(0.002)
    return {"arrived": len(arrived), "missing": len({str(n) for n in range(int(expected))} - set(arrived))}


if __name__ == "__main__":
    print(json.dumps({"publish": publish, "listen": listen, "count": count}[sys.argv[1]](*sys.argv[2:])))
