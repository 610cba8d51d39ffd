#!/usr/bin/env python3
"""A participant on CycloneDDS that has only the message files in common with grainlab: results as one JSON object.

   cyclone_peer.py listen SECONDS TOPIC=TYPE...    nodes of the domain, and the first messages of each topic
   cyclone_peer.py servo EXCHANGES                 answers stresses as a servo; counts of what arrived
"""
import json
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "msgs/python"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "nodes/launch"))
import grainlab_msgs as lab  # noqa: E402 (the path above; sets CYCLONEDDS_URI)
from servo import Stress, StrainRate, Waker, answer  # noqa: E402
from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import final  # noqa: E402
from cyclonedds.idl.types import array, sequence, uint8  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402
from grainlab_msgs import LATCHED, STREAM, message  # noqa: E402

SAMPLED = Qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, Policy.History.KeepLast(1000),
              Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False))
# Messages of a topic to print: enough to compare, few enough to read.
SHOWN = 20


@dataclass
@final
class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: array[uint8, 16]


@dataclass
@final
class Entities(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: str = ""
    node_name: str = ""
    reader_gid_seq: sequence[Gid] = field(default_factory=list)
    writer_gid_seq: sequence[Gid] = field(default_factory=list)


@dataclass
@final
class Participant(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: Gid = None
    node_entities_info_seq: sequence[Entities] = field(default_factory=list)


def reader(participant, name, kind, qos):
    return DataReader(participant, Topic(participant, name, kind, qos=qos), qos=qos)


def listen(seconds, *topics):
    participant = DomainParticipant(lab.domain())
    graph = reader(participant, "ros_discovery_info", Participant, LATCHED)
    readers = {}
    for name, kind in (topic.split("=") for topic in topics):
        # A latched topic is read as such, so that the last message arrives whenever this starts.
        latched = not any(name.endswith(stream) for stream in ("stress", "strain_rate", "clock", "diagnostics"))
        qos = SAMPLED if name.endswith("_sampled") else LATCHED if latched else STREAM
        readers[name] = reader(participant, f"rt{name}", message(kind), qos)
    nodes, heard = set(), {name: [] for name in readers}
    end = time.monotonic() + float(seconds)
    while time.monotonic() < end:
        for info in graph.take(64):
            for node in getattr(info, "node_entities_info_seq", []):
                nodes.add(f"{node.node_namespace.rstrip('/')}/{node.node_name}")
        for name, source in readers.items():
            valid = [m for m in source.take(256) if m.__class__.__name__ != "InvalidSample"]
            heard[name] += [asdict(m) for m in valid][:max(0, SHOWN - len(heard[name]))]
        time.sleep(0.002)
    return {"nodes": sorted(nodes), "topics": heard}


def servo(exchanges):
    wanted = int(exchanges)
    participant = DomainParticipant(lab.domain())
    waker = Waker()
    stresses = lab.reader(participant, "stress", Stress, STREAM, listener=waker)
    writer = lab.writer(participant, "strain_rate", StrainRate, STREAM)
    clock = reader(participant, "rt/clock", message("rosgraph_msgs/msg/Clock"), STREAM)
    answered, repeated, missed, expected, clocks = 0, 0, 0, None, 0
    quiet = time.monotonic() + 60.0
    while answered < wanted and time.monotonic() < quiet:
        waker.arrived.wait(0.5)
        waker.arrived.clear()
        clocks += len(clock.take(100))
        for stress in stresses.take(64):
            if not hasattr(stress, "sequence"):
                continue
            quiet = time.monotonic() + 60.0
            if expected is not None and stress.sequence < expected:
                repeated += 1
            else:
                missed += 0 if expected is None else stress.sequence - expected
                expected = stress.sequence + 1
                answered += 1
            writer.write(answer(stress))
    return {"answered": answered, "repeated": repeated, "missed": missed, "clocks": clocks}


if __name__ == "__main__":
    # Sequences of bytes are `bytes` here.
    print(json.dumps({"listen": listen, "servo": servo}[sys.argv[1]](*sys.argv[2:]), default=list))
