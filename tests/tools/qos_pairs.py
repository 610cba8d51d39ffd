#!/usr/bin/env python3
"""Twelve topics with a writer and a reader of CycloneDDS each, of policies that match or do not: prints which reader matched as JSON, then
waits for a signal."""
import json
import os
import signal
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "msgs/python"))
from grainlab_msgs import domain, message  # noqa: E402 (sets the network)
from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

reliable, best_effort = Policy.Reliability.Reliable(duration(seconds=1)), Policy.Reliability.BestEffort
latched, volatile = Policy.Durability.TransientLocal, Policy.Durability.Volatile
deadline = lambda seconds: Policy.Deadline(duration(seconds=seconds))
lease = lambda seconds: Policy.Liveliness.Automatic(duration(seconds=seconds))
PAIRS = [  # policies of the writer, of the reader; none: those of the specification
    ([], []),
    ([], [reliable]),
    ([], [best_effort]),
    ([best_effort], [reliable]),
    ([best_effort], []),
    ([reliable], [reliable, latched]),
    ([reliable, latched], [reliable, latched]),
    ([reliable, latched], [best_effort, volatile]),
    ([deadline(1)], [deadline(2)]),
    ([deadline(2)], [deadline(1)]),
    ([], [deadline(1)]),
    ([lease(5)], [lease(1)]),
]

first, second = DomainParticipant(domain()), DomainParticipant(domain())
String = message("std_msgs/msg/Header")
made = []
for n, (offered, requested) in enumerate(PAIRS):
    topic = lambda participant: Topic(participant, f"rt/pair_{n}", String)
    made.append((DataWriter(first, topic(first), qos=Qos(*offered)), DataReader(second, topic(second), qos=Qos(*requested))))
time.sleep(float(os.environ.get("SECONDS_TO_MATCH", "3")))
print(json.dumps({f"/pair_{n}": bool(reader.get_subscription_matched_status().current_count) for n, (_, reader) in enumerate(made)}), flush=True)
signal.pause()
