"""Compares the CSV files of `grainlab bag convert` with the messages that rosbags reads.

compare_csv.py PATH FOLDER    every topic of the recording

Times, columns and all values have to be equal. Prints the number of messages; exit 1 at the first difference.
"""

import csv
import json
import re
import sys
from pathlib import Path

from compare_cat import as_float32, by_rosbags, common

NOT_FINITE = {"NaN": "NaN", "Infinity": "inf", "-Infinity": "-inf"}


def fields(message):
    """Names of the fields of a message of rosbags: not its constants, nor messages without a field."""
    dummy = "structure_needs_at_least_one_member"
    parts = {name: part for name, part in message.items() if not name.isupper() and name != dummy}
    return {name for name, part in parts.items() if not isinstance(part, dict) or fields(part)}


def find(value, column):
    """The value of a column in a message; None behind the end of an array."""
    for part in re.findall(r"[^.\[\]]+", column):
        if isinstance(value, list):
            value = value[int(part)] if int(part) < len(value) else None
        elif value is not None:
            value = value[part]
    return value


def is_same(cell, value):
    if value is None:
        return cell == ""
    if isinstance(value, list):
        ours = json.loads(cell)
        return ours == common(ours, value)
    if isinstance(value, bool):
        return cell == str(value).lower()
    if isinstance(value, float):
        # A float32 has as many digits as it needs.
        return value == float(cell) or abs(value) < 3e38 and value == as_float32(float(cell))
    return cell == NOT_FINITE.get(value, str(value))


def main(path, folder):
    csv.field_size_limit(sys.maxsize)
    topics = {}
    for topic, _, time, data in by_rosbags(path):
        topics.setdefault(topic, []).append((time, data))
    for topic, messages in topics.items():
        with open(Path(folder) / (topic.strip("/").replace("/", "_") + ".csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == len(messages), (topic, len(rows), len(messages))
        for row, (time, data) in zip(rows, messages):
            assert row.pop("log_time") == str(time), (topic, time)
            row.pop("publish_time")
            assert {re.split(r"[.\[]", name)[0] for name in row} == fields(data), (topic, list(row))
            for name, cell in row.items():
                assert is_same(cell, find(data, name)), (topic, name, cell, find(data, name))
    print(sum(map(len, topics.values())))


if __name__ == "__main__":
    main(*sys.argv[1:])
