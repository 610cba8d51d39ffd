"""ROS 2 messages as types of CycloneDDS, without ROS: grainlab's, and std, geometry, sensor, nav and diagnostic messages.

   WaveSpeeds = message("grainlab_msgs/msg/WaveSpeeds")
   speeds = writer(participant(), "wave_speeds", WaveSpeeds, LATCHED)

The types are made of the message files on demand, so that they always agree with them. DDS knows the type pkg/msg/T as
pkg::msg::dds_::T_ and the topic /x as rt/x; every type is plain CDR (final). ROS_DOMAIN_ID is the domain. CYCLONEDDS_URI, if set before
the import, chooses the network; else it is this host alone.
"""
import dataclasses
import functools
import os
import re
import types
from pathlib import Path

os.environ.setdefault("CYCLONEDDS_URI", '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" '
                      'multicast="true"/></Interfaces></General></Domain></CycloneDDS>')
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl import types as idl
from cyclonedds.idl.annotations import final
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

# The folder with msg, std and interfaces: this one if it is installed, else that of the source.
ROOT = next(f for f in (Path(__file__).resolve().parent, Path(__file__).resolve().parents[2]) if (f / "msg").is_dir())
FIELD = re.compile(r"([\w/]+)(\[(\d*)\])?\s+([a-z]\w*)(?:\s+[^#\s]+)?\s*(?:#.*)?$")
CONSTANT = re.compile(r"\w+\s+([A-Z]\w*)\s*=\s*(\d+)\s*(?:#.*)?$")
PRIMITIVES = {"string": str, "bool": bool, "byte": idl.uint8} | {
    name: getattr(idl, name)
    for name in "int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64".split()
}

CDR = Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False)
RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
# QoS of every topic of the laboratory but those of the lockstep: late readers receive the latest sample.
LATCHED = Qos(RELIABLE, Policy.Durability.TransientLocal, Policy.History.KeepLast(64), CDR)
# QoS of the lockstep, stress and strain_rate.
STREAM = Qos(RELIABLE, Policy.Durability.Volatile, Policy.History.KeepLast(1000), CDR)


def domain():
    return int(os.environ.get("ROS_DOMAIN_ID") or "0")


def participant():
    return DomainParticipant(domain())


def reader(participant, topic, kind, qos, **options):
    """A reader of a topic by its ROS name."""
    return DataReader(participant, Topic(participant, "rt/" + topic.lstrip("/"), kind, qos=qos), qos=qos, **options)


def writer(participant, topic, kind, qos):
    """A writer of a topic by its ROS name."""
    return DataWriter(participant, Topic(participant, "rt/" + topic.lstrip("/"), kind, qos=qos), qos=qos)


@functools.cache
def message(name):
    """The type of `package/msg/Name`; fields that are not given are 0, empty or false. Constants are attributes."""
    package, _, stem = name.replace("/msg/", "/").partition("/")
    folders = [ROOT] if package == "grainlab_msgs" else [ROOT / "std" / package, ROOT / "interfaces" / package]
    file = next((f for folder in folders if (f := folder / "msg" / f"{stem}.msg").exists()), None)
    if file is None:
        raise LookupError(f"{name}: no such message in {ROOT}")
    body, annotations = {}, {}
    for line in file.read_text(encoding="utf-8").splitlines():
        if constant := CONSTANT.match(line):
            body[constant[1]] = int(constant[2])
        elif line.split("#")[0].strip():
            base, brackets, length, field = FIELD.match(line).groups()
            annotations[field], zero = kind(base, package, brackets, length)
            body[field] = dataclasses.field(default_factory=zero)
    body["__annotations__"] = annotations
    typename = {"typename": f"{package}::msg::dds_::{stem}_"}
    struct = types.new_class(stem, (IdlStruct,), typename, lambda namespace: namespace.update(body))
    return dataclasses.dataclass(final(struct))


def kind(base, package, brackets, length):
    """The type of a field, and a constructor of its zero value."""
    if base in PRIMITIVES:
        element = PRIMITIVES[base]
        zero = element if element in (str, bool) else float if base.startswith("float") else int
    else:
        element = zero = message(base.replace("/", "/msg/") if "/" in base else f"{package}/msg/{base}")
    if length:
        return idl.array[element, int(length)], lambda: [zero()] * int(length)
    return (idl.sequence[element], list) if brackets else (element, zero)
