"""Compares the Parquet files of `grainlab bag convert` with the messages that rosbags reads.

compare_parquet.py PATH FOLDER    every topic of the recording, read by pandas, Polars and DuckDB with one call each

Times, columns and all values have to be equal. Prints the number of messages; exit 1 at the first difference.
"""

import datetime
import sys
from pathlib import Path

import duckdb
import pandas
import polars
from compare_cat import by_rosbags, plain


def value(v):
    """A value of a table as `plain` gives that of a message."""
    if hasattr(v, "tolist") and not isinstance(v, (datetime.datetime, pandas.Timestamp)):
        v = v.tolist()
    if isinstance(v, dict):
        return {name: value(part) for name, part in v.items()}
    if isinstance(v, (list, tuple)):
        return [value(part) for part in v]
    return plain(v)


def fields(v):
    """A message of rosbags without its constants, and without messages that have no field."""
    if isinstance(v, list):
        return [fields(part) for part in v]
    if not isinstance(v, dict):
        return v
    parts = {name: fields(part) for name, part in v.items() if not name.isupper()}
    parts.pop("structure_needs_at_least_one_member", None)
    return {name: part for name, part in parts.items() if part != {}}


def by_pandas(file):
    frame = pandas.read_parquet(file)
    for name in ("log_time", "publish_time"):
        frame[name] = frame[name].astype("int64")
    return frame.to_dict("records")


def by_polars(file):
    times = polars.col("log_time", "publish_time").dt.timestamp("ns")
    return polars.read_parquet(file).with_columns(times).to_dicts()


def by_duckdb(file):
    times = "epoch_ns(log_time) as log_time, epoch_ns(publish_time) as publish_time"
    found = duckdb.sql(f"select * replace ({times}) from '{file}'")
    return [dict(zip(found.columns, row)) for row in found.fetchall()]


def main(path, folder):
    topics = {}
    for topic, _, time, data in by_rosbags(path):
        topics.setdefault(topic, []).append((time, data))
    for topic, messages in topics.items():
        file = Path(folder) / (topic.strip("/").replace("/", "_") + ".parquet")
        for read in (by_pandas, by_polars, by_duckdb):
            rows = [value(row) for row in read(file)]
            assert len(rows) == len(messages), (topic, read.__name__, len(rows), len(messages))
            for row, (time, data) in zip(rows, messages):
                assert row.pop("log_time") == time, (topic, read.__name__, time)
                row.pop("publish_time")
                # The texts are the same, too: 1 is not True, and not 1.0.
                assert repr(row) == repr(fields(data)), f"{topic}, {read.__name__}: {row}\nrosbags: {data}"
    print(sum(map(len, topics.values())))


if __name__ == "__main__":
    main(*sys.argv[1:])
