#!/usr/bin/env python3
"""Writes messages.json: for every message type its schema text, its type hash and two messages (filled and empty) as
values and as CDR bytes of both byte orders, all made by independent software. Run it after a change of a message file:

    pip install rosbags==0.11.9 mcap-ros2-support==0.6.0
    python make_golden.py
"""
import json
import random
import re
from pathlib import Path

from mcap_ros2._dynamic import serialize_dynamic
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.base import Nodetype

HERE = Path(__file__).resolve().parent
CRATE = HERE.parent.parent
FILES = {f"grainlab_msgs/{f.stem}": f for f in CRATE.glob("msg/*.msg")}
FILES |= {f"{f.parent.parent.name}/{f.stem}": f for f in CRATE.glob("std/*/msg/*.msg")}
PRIMITIVES = set("bool byte float32 float64 int8 uint8 int16 uint16 int32 uint32 int64 uint64 string".split())
JAZZY = get_typestore(Stores.ROS2_JAZZY)
random.seed(20120321)


def schema(name, seen):
    """As rosbag2: dependencies alphabetically, depth first, each once."""
    text = FILES[name].read_text()
    found = set(re.findall(r"^[ \t]*([A-Za-z0-9_/]+)(?:\[\d*\])?[ \t]+\w", text, re.M)) - PRIMITIVES
    for dep in sorted(d if "/" in d else f"{name.split('/')[0]}/{d}" for d in found):
        if dep not in seen:
            seen.add(dep)
            text += "\n" + "=" * 80 + f"\nMSG: {dep}\n" + schema(dep, seen)
    return text


def number(kind):
    if kind == "bool":
        return random.random() < 0.5
    if kind == "string":
        return random.choice(["", "cell", "ratio-as-printed", "φ = .640"])
    if kind == "float64":
        return random.uniform(-1, 1) * 10.0 ** random.randint(-12, 12)
    if kind == "float32":
        return random.randint(-4096, 4096) / 1024
    if kind == "byte":
        return random.randint(0, 127)  # the libraries disagree about its sign
    bits = int(re.sub(r"\D", "", kind))
    return random.randint(0, 2**bits - 1) if kind[0] == "u" else random.randint(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def value(store, desc, filled):
    """A value as plain Python."""
    kind, detail = desc
    if kind == Nodetype.BASE:
        return number(detail[0]) if filled else {"string": "", "bool": False}.get(detail[0], 0)
    if kind == Nodetype.NAME:
        return {n: value(store, d, filled) for n, d in store.fielddefs[detail][1]}
    length = detail[1] if kind == Nodetype.ARRAY else (random.randint(1, 5) if filled else 0)
    return [value(store, detail[0], filled) for _ in range(length)]


def build(store, typename, plain):
    """Objects of rosbags with equal content."""
    import numpy

    def one(desc, v):
        kind, detail = desc
        if kind == Nodetype.NAME:
            return build(store, detail, v)
        if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            inner = detail[0]
            if inner[0] == Nodetype.BASE and inner[1][0] != "string":
                return numpy.array(v, dtype={"byte": "int8"}.get(inner[1][0], inner[1][0]))
            return [one(inner, x) for x in v]
        return v

    fields = {n: one(d, plain[n]) for n, d in store.fielddefs[typename][1]}
    return store.types[typename](**fields)


out = []
for name in sorted(FILES):
    typename = name.replace("/", "/msg/")
    text = schema(name, set())
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text, typename))
    digest = store.hash_rihs01(typename)
    if typename in JAZZY.fielddefs:
        assert digest == JAZZY.hash_rihs01(typename), f"{typename} is not ROS 2's"
    entry = {"type": typename, "hash": digest, "definition": text, "messages": []}
    for filled in (True, False):
        plain = value(store, (Nodetype.NAME, typename), filled)
        little, big = (bytes(store.serialize_cdr(build(store, typename, plain), typename, little_endian=e)) for e in (True, False))
        second = bytes(serialize_dynamic(typename, text)[typename](plain))
        assert second[:2] == little[:2] and second[4:].rstrip(b"\0") == little[4:].rstrip(b"\0"), f"{typename}: libraries differ"
        entry["messages"].append({"value": plain, "cdr": little.hex(), "cdr_big_endian": big.hex()})
    out.append(entry)
lines = ",\n".join(json.dumps(entry, ensure_ascii=False) for entry in out)
(HERE / "messages.json").write_text(f"[\n{lines}\n]\n")
