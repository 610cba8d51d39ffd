#!/usr/bin/env python3
"""An instrument that reads the records of an oscilloscope from a folder as they are written, and sends their wave speeds.

   pip install ../../msgs
   record_instrument.py FOLDER --grain-shear-modulus 29e9 --poisson 0.2    # while `grainlab run emt_inversion` runs

FOLDER has records.csv, the table of `grainlab pick --help`, with sample, pressure_pa, density, mode and angle_deg of each record. Rows and
files may come later. The speeds of a state (one sample at one pressure) are sent when all its records are written, and again when one
changes; a record without an arrival is named in the warnings. Runs until Ctrl-C; with --once until every state is sent, and ends with 4 if
a record was refused, or the answer of a state is contradictory or unknown. GRAINLAB names the binary (default: grainlab on the PATH).
"""
import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from instrument import STATUS, Instrument, Vector3, WaveSpeed, WaveSpeeds, show


def number(row, *names):
    """The first of these columns that is not empty, or 0."""
    return next((float(row[n]) for n in names if row.get(n)), 0.0)


ALIASES = {"p_pa": ("pressure_pa", 1.0), "p_kpa": ("pressure_pa", 1e3), "pressure_kpa": ("pressure_pa", 1e3),
           "density_g_cm3": ("density", 1e3)}


def in_si(row):
    """The row with pressure_pa and density, of columns that `grainlab pick` reads in other units; it refuses two of one quantity."""
    meant = [ALIASES.get(column, (column, 1.0)) for column in row]
    names, read = [name for name, _ in meant], {}
    for (column, cell), (name, factor) in zip(row.items(), meant):
        try:
            cell = cell if factor == 1.0 else str(factor * float(cell))
        except ValueError:
            pass  # empty, or refused by `grainlab pick`
        read[name if names.count(name) == 1 else column] = cell
    return read


class Records:
    """The records of a folder, by states: one sample at one pressure."""

    def __init__(self, folder):
        self.folder, self.seen, self.sent = Path(folder), {}, {}

    def states(self):
        """Rows of each state, with the sizes and times of their files, None of one that is not there yet."""
        table = self.folder / "records.csv"
        rows = csv.DictReader(table.read_text(encoding="utf-8-sig").splitlines()) if table.exists() else []
        states = {}
        for row in rows:
            if row.get("file") and None not in row.values():  # a row that is being written waits
                row = in_si(row)
                path = (self.folder / row["file"]).resolve()
                stamp = (path.stat().st_size, path.stat().st_mtime_ns) if path.exists() else None
                try:
                    pressure = number(row, "pressure_pa")
                except ValueError as fault:
                    pressure = str(fault)  # `grainlab pick` refuses the row
                states.setdefault((row.get("sample", ""), pressure), []).append(({**row, "file": str(path)}, stamp))
        return states

    def poll(self):
        """States that changed and are complete, each as its rows. A file is written when it is the same twice."""
        states = self.states()
        before, self.seen = self.seen, states
        for state, rows in states.items():
            if all(stamp for _, stamp in rows) and before.get(state) == rows != self.sent.get(state):
                self.sent[state] = rows
                yield [row for row, _ in rows]

    def is_done(self):
        return bool(self.seen) and all(self.sent.get(state) == rows for state, rows in self.seen.items())


def picked(rows):
    """Pick of `grainlab pick` for each row."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv", newline="") as table:
        writer = csv.DictWriter(table, rows[0])
        writer.writeheader()
        writer.writerows(rows)
        table.flush()
        command = [os.environ.get("GRAINLAB", "grainlab"), "pick", table.name, "--format", "json"]
        ended = subprocess.run(command, capture_output=True, text=True)
        if not ended.stdout:
            raise ValueError(ended.stderr.strip().replace(table.name, "records.csv"))
        return json.loads(ended.stdout)


def message(rows, options):
    """The speeds of a state, with the reasons of the records that have none and the notes on the others."""
    first, name = rows[0], lambda row: Path(row["file"]).name
    for column in ["density", "density_sigma", "grain_density", "phi", "pressure_sigma_pa"]:
        if len({row.get(column) for row in rows}) > 1:
            raise ValueError(f"{column} differs between the records of one state")
    speeds, refused, notes = [], [], []
    for row, found in zip(rows, picked(rows)):
        notes += [f"{name(row)}: {note}" for note in found["notes"]]
        refused += [f"{name(row)}: {found['refused']}"] if found["refused"] else []
        for best in (p for p in found["picks"] if p["method"] == found["recommended"]):
            if not found["direction"]:
                raise ValueError(f"{name(row)}: mode and angle_deg are needed, the angle in degrees from the axis")
            speeds.append(WaveSpeed(
                method=getattr(WaveSpeed, "METHOD_" + best["method"].upper()), direction=Vector3(*found["direction"]),
                polarization=Vector3(*found["polarization"]), speed=best["speed"],
                speed_stddev=math.hypot(best["speed_sigma"], best["speed_shared_sigma"]),
                frequency=found["frequency"]))
    density = number(first, "density") or number(first, "grain_density") * number(first, "phi")
    return notes, WaveSpeeds(
        name=f"{first.get('sample', '')} {first.get('pressure_pa', '')} Pa".strip(), density=density,
        density_stddev=number(first, "density_sigma"), pressure=number(first, "pressure_pa"),
        pressure_stddev=number(first, "pressure_sigma_pa"), solid_fraction=number(first, "phi"), axis=Vector3(0.0, 0.0, 1.0),
        grain_shear_modulus=options.grain_shear_modulus, grain_poisson_ratio=options.poisson, speeds=speeds, warnings=refused)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--grain-shear-modulus", type=float, required=True, metavar="PA")
    parser.add_argument("--poisson", type=float, required=True, metavar="NU")
    parser.add_argument("--once", action="store_true")
    options = parser.parse_args()
    records, instrument, failed = Records(options.folder), Instrument(), False
    while True:
        for rows in records.poll():
            try:
                notes, sent = message(rows, options)
            except ValueError as fault:
                print(f"records.csv: {rows[0].get('sample', '')} {rows[0].get('pressure_pa', '')} Pa: {fault}", file=sys.stderr)
                failed = True
                continue
            failed |= bool(sent.warnings)
            print("".join(f"{line}\n" for line in notes + sent.warnings), end="", flush=True)
            if sent.speeds:
                found = instrument.infer(sent)
                statuses = [STATUS[e.status] for e in found.estimates]
                failed |= "contradictory" in statuses or all(status == "unknown" for status in statuses)
                show(sent, found)
        if options.once and records.is_done():
            sys.exit(4 if failed else 0)
        time.sleep(0.5)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
