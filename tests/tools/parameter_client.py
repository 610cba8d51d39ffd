#!/usr/bin/env python3
"""A client of the parameter services on CycloneDDS, with requests as rmw_cyclonedds sends them: results as JSON.

   parameter_client.py NODE list
   parameter_client.py NODE get NAME...
   parameter_client.py NODE describe NAME...
   parameter_client.py NODE set NAME VALUE          VALUE as JSON

Each request begins with half of the client's GUID and a number, which the answer repeats. Exit 1 if none comes within 10 s.
"""
import json
import sys
import time
import types
from dataclasses import asdict, dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "msgs/python"))
import grainlab_msgs as lab  # noqa: E402 (the path above; sets CYCLONEDDS_URI)
from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import final  # noqa: E402
from cyclonedds.idl.types import float64, int64, sequence, uint8, uint64  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

CLIENT = 0x1122334455667788
QOS = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.Volatile, Policy.History.KeepLast(64),
          Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False))


@dataclass
@final
class Value(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: uint8 = 0
    bool_value: bool = False
    integer_value: int64 = 0
    double_value: float64 = 0.0
    string_value: str = ""
    byte_array_value: sequence[uint8] = field(default_factory=list)
    bool_array_value: sequence[bool] = field(default_factory=list)
    integer_array_value: sequence[int64] = field(default_factory=list)
    double_array_value: sequence[float64] = field(default_factory=list)
    string_array_value: sequence[str] = field(default_factory=list)

    KINDS = ("not_set bool_value integer_value double_value string_value byte_array_value bool_array_value "
             "integer_array_value double_array_value string_array_value").split()

    def plain(self):
        return getattr(self, self.KINDS[self.type], None)

    @classmethod
    def of(cls, value):
        number = {bool: 1, int: 2, float: 3, str: 4}[type(value)]
        return cls(type=number, **{cls.KINDS[number]: value})


@dataclass
@final
class Parameter(IdlStruct, typename="rcl_interfaces::msg::dds_::Parameter_"):
    name: str = ""
    value: Value = field(default_factory=Value)


@dataclass
@final
class FloatingPointRange(IdlStruct, typename="rcl_interfaces::msg::dds_::FloatingPointRange_"):
    from_value: float64 = 0.0
    to_value: float64 = 0.0
    step: float64 = 0.0


@dataclass
@final
class IntegerRange(IdlStruct, typename="rcl_interfaces::msg::dds_::IntegerRange_"):
    from_value: int64 = 0
    to_value: int64 = 0
    step: uint64 = 0


@dataclass
@final
class Descriptor(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterDescriptor_"):
    name: str = ""
    type: uint8 = 0
    description: str = ""
    additional_constraints: str = ""
    read_only: bool = False
    dynamic_typing: bool = False
    floating_point_range: sequence[FloatingPointRange] = field(default_factory=list)
    integer_range: sequence[IntegerRange] = field(default_factory=list)


@dataclass
@final
class SetResult(IdlStruct, typename="rcl_interfaces::msg::dds_::SetParametersResult_"):
    successful: bool = False
    reason: str = ""


def service(name, request, reply):
    """The two messages of a service, each behind the header of rmw_cyclonedds."""
    header = {"guid": uint64, "sequence": int64}

    def half(kind, fields):
        typename = {"typename": f"rcl_interfaces::srv::dds_::{name}_{kind}_"}
        body = {"__annotations__": header | fields}
        struct = types.new_class(kind, (IdlStruct,), typename, lambda namespace: namespace.update(body))
        return dataclass(final(struct))

    return half("Request", request), half("Response", reply)


SERVICES = {
    "list": ("list_parameters", *service("ListParameters", {"prefixes": sequence[str], "depth": uint64},
                                         {"names": sequence[str], "prefixes": sequence[str]})),
    "get": ("get_parameters", *service("GetParameters", {"names": sequence[str]}, {"values": sequence[Value]})),
    "describe": ("describe_parameters", *service("DescribeParameters", {"names": sequence[str]},
                                                 {"descriptors": sequence[Descriptor]})),
    "set": ("set_parameters", *service("SetParameters", {"parameters": sequence[Parameter]},
                                       {"results": sequence[SetResult]})),
}


def call(node, which, *arguments):
    name, request, reply = SERVICES[which]
    participant = DomainParticipant(lab.domain())
    topic = lambda prefix, kind, suffix: Topic(participant, f"{prefix}{node}/{name}{suffix}", kind, qos=QOS)
    writer = DataWriter(participant, topic("rq", request, "Request"), qos=QOS)
    reader = DataReader(participant, topic("rr", reply, "Reply"), qos=QOS)
    end = time.monotonic() + 10.0
    number = 0
    while time.monotonic() < end:
        if writer.get_publication_matched_status().current_count and reader.get_subscription_matched_status().current_count:
            # A server may match the reader of the answer later than the writer of the request: ask again.
            number += 1
            writer.write(request(CLIENT, number, *arguments))
        pause = time.monotonic() + 0.5
        while time.monotonic() < pause:
            for answer in reader.take(16):
                if getattr(answer, "guid", None) == CLIENT:
                    return answer
            time.sleep(0.005)
    sys.exit(f"{node} did not answer {name}")


def main(node, which, *names):
    if which == "list":
        return call(node, "list", [], 0).names
    if which == "get":
        return {n: v.plain() for n, v in zip(names, call(node, "get", list(names)).values)}
    if which == "describe":
        return [asdict(d) for d in call(node, "describe", list(names)).descriptors]
    name, text = names
    return asdict(call(node, "set", [Parameter(name, Value.of(json.loads(text)))]).results[0])


if __name__ == "__main__":
    print(json.dumps(main(*sys.argv[1:])))
