#!/usr/bin/env python3
"""Invalid messages of an instrument to the inversion, and the results: one JSON object on standard output.

   bad_instrument.py        with the ROS_DOMAIN_ID of the inversion

good: sent and received before; nameless: the same without an axis; other: of an instrument that joins when these are answered;
bad: invalid ones, each with the answer; refused: the number of messages that the inversion reports as refused, after these and two that
no reader can decode; again: received after them.
"""
import json
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "nodes" / "launch"))
import instrument as lab  # noqa: E402 (the path above; sets CYCLONEDDS_URI)
from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import final  # noqa: E402
from cyclonedds.idl.types import uint32  # noqa: E402
from grainlab_msgs import LATCHED, message  # noqa: E402

TYPE = "grainlab_msgs::msg::dds_::WaveSpeeds_"


@dataclass
@final
class Torn(IdlStruct, typename=TYPE):
    """Ends in the middle of the message."""
    header: message("std_msgs/msg/Header") = None
    source_step: lab.WaveSpeeds.__annotations__["source_step"] = 7


@dataclass
@final
class Endless(IdlStruct, typename=TYPE):
    """Has a string with a stated length of 4 GB."""
    sec: uint32 = 0
    nanosec: uint32 = 0
    length: uint32 = 0xFFFFFFF0


def bad():
    nan, negative, twice = lab.measurement(), lab.measurement(), lab.measurement()
    nan.speeds[2].speed = float("nan")
    negative.density = -1498.0
    twice.axis = lab.Vector3(0.0, 0.0, 2.0)
    unknown, timeless = lab.measurement(), lab.measurement()
    unknown.speeds[0].method = 250
    timeless.header.stamp.nanosec = 2**32 - 1
    samples = [nan, negative, twice, unknown, timeless]
    for number, sample in enumerate(samples):
        sample.name = f"bad {number}"
        sample.header.stamp.sec = number
    return samples


def send_as(kind, sample):
    """From a separate participant: in one participant a topic has one type."""
    participant = lab.participant()
    writer = lab.writer(participant, "wave_speeds", kind, LATCHED)
    peer.until(lambda: writer.get_publication_matched_status().current_count, 20.0, f"nobody reads {kind.__name__}")
    writer.write(sample)
    return participant, writer


def refused():
    """The count in the node's latest health report."""
    for report in diagnostics.take(64):
        for status in getattr(report, "status", []):
            values = {pair.key: pair.value for pair in status.values}
            if "refused /wave_speeds" in values:
                latest[0] = int(values["refused /wave_speeds"])
    return latest[0]


peer = lab.Instrument()
qos = Qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, Policy.History.KeepLast(64))
DiagnosticArray = message("diagnostic_msgs/msg/DiagnosticArray")
diagnostics = lab.reader(peer.participant, "diagnostics", DiagnosticArray, qos)
latest = [0]

sent = lab.measurement()
received = asdict(peer.infer(sent))
result = {"good": {"sent": asdict(sent), "received": received}}
nameless = lab.measurement()
nameless.axis = lab.Vector3()
received = asdict(peer.infer(nameless))
result["nameless"] = {"sent": asdict(nameless), "received": received}
other = lab.measurement()
other.name = "other beads"
for speed in other.speeds:
    speed.speed *= 1.15
received = asdict(lab.Instrument().infer(other))
result["other"] = {"sent": asdict(other), "received": received}
result["bad"] = [{"name": sample.name, "received": asdict(peer.answer(sample))} for sample in bad()]
kept = [send_as(Torn, Torn(header=sent.header)), send_as(Endless, Endless())]
end = time.monotonic() + 20.0
while refused() < 7 and time.monotonic() < end:
    time.sleep(0.05)
result["refused"] = refused()
result["again"] = asdict(peer.infer(sent))
print(json.dumps(result))
