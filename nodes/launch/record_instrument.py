#!/usr/bin/env python3
"""An instrument that reads the records of an oscilloscope from a folder as they are written, and sends their wave speeds.

   pip install cyclonedds==11.0.1
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

AXIS = Vector3(0.0, 0.0, 1.0)


def is_number(text):
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def number(row, *names):
    """The first of these columns that is not empty, or 0."""
    return next((float(row[n]) for n in names if row.get(n)), 0.0)


def wave(row):
    """Direction and polarization of a record about the axis e3."""
    named = {"along": 0.0, "across": 90.0}
    text = row.get("angle_deg") or row.get("direction") or ""
    if text not in named and not is_number(text):
        raise ValueError(f"{row['file']}: angle_deg is {text!r}; degrees from the axis are needed")
    sine, cosine = (f(math.radians(named.get(text) if text in named else float(text))) for f in (math.sin, math.cos))
    in_plane = (cosine, 0.0, -sine)
    motions = {"p": (sine, 0.0, cosine), "sh": (0.0, 1.0, 0.0), "sv": in_plane, "s": in_plane}
    mode = row.get("mode", "").lower()
    if mode not in motions or (mode == "s" and abs(sine) > 1e-3):
        raise ValueError(f"{row['file']}: mode is {mode!r}; p, sv or sh is needed, or s along the axis")
    return Vector3(sine, 0.0, cosine), Vector3(*motions[mode])


class Records:
    """The records of a folder, each picked when it is written."""

    def __init__(self, folder):
        self.folder, self.seen, self.picked, self.sent, self.is_complete = Path(folder), {}, {}, {}, False

    def rows(self):
        table = self.folder / "records.csv"
        rows = csv.DictReader(table.read_text(encoding="utf-8-sig").splitlines()) if table.exists() else []
        return [row for row in rows if row.get("file") and None not in row.values()]  # a row that is being written waits

    def poll(self):
        """States whose records are all picked and that changed: name, rows and picks. A file is written when it is the same twice."""
        states = {}
        for row in self.rows():
            pressure = row.get("pressure_pa", "")
            states.setdefault((row.get("sample", ""), float(pressure) if is_number(pressure) else pressure), []).append(row)
        picked = {name: [self.pick(row) for row in rows] for name, rows in states.items()}
        self.is_complete = bool(picked) and all(map(all, picked.values()))
        for name, picks in picked.items():
            if all(picks) and self.sent.get(name) != (states[name], picks):
                self.sent[name] = (states[name], picks)
                yield name, list(zip(states[name], picks))

    def pick(self, row):
        """What `grainlab pick` finds of a record; None until the file is written."""
        path = (self.folder / row["file"]).resolve()
        if not path.exists():
            return None
        stamp = (path.stat().st_size, path.stat().st_mtime_ns)
        key = json.dumps(row)
        before, self.seen[key] = self.seen.get(key), stamp
        if before != stamp:
            return None
        if self.picked.get(key, (None,))[0] != stamp:
            with tempfile.NamedTemporaryFile("w", suffix=".csv", newline="") as table:
                writer = csv.DictWriter(table, row)
                writer.writeheader()
                writer.writerow({**row, "file": path})
                table.flush()
                command = [os.environ.get("GRAINLAB", "grainlab"), "pick", table.name, "--format", "json"]
                ended = subprocess.run(command, capture_output=True, text=True)
            refused = {"refused": ended.stderr.strip().replace(table.name, "records.csv"), "picks": [], "notes": []}
            self.picked[key] = (stamp, json.loads(ended.stdout)[0] if ended.stdout else refused)
        return self.picked[key][1]


def message(name, picked, options):
    """The speeds of a state, with the reasons of the records that have none."""
    first = picked[0][0]
    for column in ["density", "density_sigma", "grain_density", "phi", "pressure_sigma_pa"]:
        if len({row.get(column) for row, _ in picked}) > 1:
            raise ValueError(f"{column} differs between the records of one state")
    speeds, warnings = [], []
    for row, found in picked:
        warnings += [f"{row['file']}: {found['refused']}"] if found["refused"] else []
        for best in (p for p in found["picks"] if p["method"] == found["recommended"]):
            direction, polarization = wave(row)
            speeds.append(WaveSpeed(
                method=getattr(WaveSpeed, "METHOD_" + best["method"].upper()), direction=direction, polarization=polarization,
                speed=best["speed"], speed_stddev=best["speed_sigma"], frequency=found["frequency"]))
    density = number(first, "density") or number(first, "grain_density") * number(first, "phi")
    return WaveSpeeds(
        name=f"{name[0]} {first.get('pressure_pa', '')} Pa".strip(), density=density, density_stddev=number(first, "density_sigma"),
        pressure=number(first, "pressure_pa"), pressure_stddev=number(first, "pressure_sigma_pa"),
        solid_fraction=number(first, "phi"), axis=AXIS, grain_shear_modulus=options.grain_shear_modulus,
        grain_poisson_ratio=options.poisson, speeds=speeds, warnings=warnings)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--grain-shear-modulus", type=float, required=True, metavar="PA")
    parser.add_argument("--poisson", type=float, required=True, metavar="NU")
    parser.add_argument("--once", action="store_true")
    options = parser.parse_args()
    records, instrument, failed = Records(options.folder), Instrument(), False
    while True:
        for name, picked in records.poll():
            for row, found in picked:
                print("".join(f"{row['file']}: {note}\n" for note in found["notes"]), end="")
            try:
                sent = message(name, picked, options)
            except (KeyError, ValueError) as fault:
                print(f"records.csv: {name}: {fault}", file=sys.stderr)
                failed = True
                continue
            failed |= bool(sent.warnings)
            print("".join(f"{warning}\n" for warning in sent.warnings), end="", flush=True)
            if sent.speeds:
                found = instrument.infer(sent)
                statuses = [STATUS[e.status] for e in found.estimates]
                failed |= "contradictory" in statuses or all(status == "unknown" for status in statuses)
                show(sent, found)
        if options.once and records.is_complete:
            sys.exit(4 if failed else 0)
        time.sleep(0.5)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
