"""ROS 2 message files as types of CycloneDDS, read on demand, so that they always agree with the files.

   WaveSpeeds = message("grainlab_msgs/msg/WaveSpeeds")

DDS knows the type pkg/msg/T as pkg::msg::dds_::T_ and the topic /x as rt/x; every type is plain CDR (final).
"""
import dataclasses
import functools
import re
import types
from pathlib import Path

from cyclonedds.core import Policy, Qos
from cyclonedds.idl import IdlStruct
from cyclonedds.idl import types as idl
from cyclonedds.idl.annotations import final
from cyclonedds.util import duration

ROOT = Path(__file__).resolve().parents[2] / "msgs"
FIELD = re.compile(r"([\w/]+)(\[(\d*)\])?\s+([a-z]\w*)(?:\s+[^#\s]+)?\s*(?:#.*)?$")
CONSTANT = re.compile(r"\w+\s+([A-Z]\w*)\s*=\s*(\d+)\s*(?:#.*)?$")
PRIMITIVES = {"string": str, "bool": bool, "byte": idl.uint8} | {
    name: getattr(idl, name)
    for name in "int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64".split()
}

# QoS of every topic of the contract but those of the lockstep: late readers receive the latest sample.
LATCHED = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.Durability.TransientLocal,
    Policy.History.KeepLast(64),
    Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
)


@functools.cache
def message(name):
    """The type of `package/msg/Name`; fields that are not given are 0, empty or false. Constants are attributes."""
    package, stem = name.split("/msg/")
    folder = ROOT / "msg" if package == "grainlab_msgs" else ROOT / "std" / package / "msg"
    body, annotations = {}, {}
    for line in (folder / f"{stem}.msg").read_text().splitlines():
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
