#!/usr/bin/env python3
"""Tests of the comparison. They need no other code: python3 -m unittest discover tests/bench"""

import json
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True

from compare_peers import PACKING  # noqa: E402
from peers.checks import checks  # noqa: E402
from peers.comparison import replicas_of  # noqa: E402
from peers import dirt  # noqa: E402
from peers.lammps import last_loop, state  # noqa: E402
from peers.liggghts import cpu_seconds  # noqa: E402
from peers.measurement import Case, Job, Measurement  # noqa: E402
from peers.packing import Packing, PackingError, State  # noqa: E402
from peers.process import RunFailed, run  # noqa: E402
from peers.report import Group  # noqa: E402
from peers.setting import Setting  # noqa: E402


def measured(wall_s: float, **more) -> Measurement:
    return Measurement(**({"grains": 2000, "steps": 1000, "wall_s": wall_s, "cpu_s": wall_s} | more))


class InTemporaryFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class ThePacking(InTemporaryFolder):
    def test_has_the_contacts_and_the_pressure_that_its_maker_reported(self):
        found = Packing.read(PACKING).state(Setting())
        self.assertEqual(found.coordination, 2 * 5109 / 2000)
        # The value of LAMMPS, ten digits.
        self.assertAlmostEqual(found.pressure / 99984.47584, 1.0, delta=1e-9)

    def test_keeps_its_state_when_replicated_and_rewritten(self):
        small = Packing((0, 0, 0), (6.0, 6.0, 6.0), 1.0, 1.0, [(0.1, 1.0, 1.0), (4.2, 1.0, 1.0)])
        large = Packing((0, 0, 0), (12.0, 12.0, 12.0), 1.0, 1.0, list(small.replicated(2)))
        self.assertEqual(small.state(Setting()).coordination, 1.0)
        self.assertEqual(large.state(Setting()).coordination, 1.0)
        self.assertAlmostEqual(large.state(Setting()).pressure / small.state(Setting()).pressure, 1.0, delta=1e-12)
        path = self.folder / "x.data"
        small.write_liggghts(path, 2)
        again = Packing.read(path)
        self.assertEqual((again.sides, again.radius, again.positions), (large.sides, large.radius, large.positions))

    def test_is_refused_with_file_line_and_reason(self):
        sound = Packing.text(PACKING)
        faults = {
            "0 0 0 xy xz yz": ("1e-5 0 0 xy xz yz", ":9: the box is tilted"),
            "2000 atoms": ("2001 atoms", "2000 atoms found, 2001 announced"),
            "1220 1 0.0002 2500": ("1220 1 0.0003 2500", "several diameters"),
            "364 1 0.0002 2500": ("364 1 0.0002 dense", ":14: could not convert"),
            "xlo xhi": ("x y", "no xlo xhi"),
        }
        for text, (fault, message) in faults.items():
            path = self.folder / "faulty.data"
            path.write_text(sound.replace(text, fault, 1))
            with self.assertRaisesRegex(PackingError, message):
                Packing.read(path)

    def test_comes_in_cubes_of_copies_only(self):
        self.assertEqual(replicas_of([2000, 128000], 2000), {2000: 1, 128000: 4})
        with self.assertRaisesRegex(PackingError, "4000 is not 2000 times a cube"):
            replicas_of([4000], 2000)


class WhatCodesPrint(InTemporaryFolder):
    LOOP = "Loop time of 0.7 on {} procs for {} steps with 2000 atoms\n"

    def test_the_last_loop_is_the_timed_one(self):
        loop = last_loop(self.LOOP.format(1, 400) + "…" + self.LOOP.format(2, 4000))
        self.assertEqual(loop, {"wall_s": 0.7, "processors": 2, "steps": 4000, "grains": 2000})

    def test_a_state_is_not_read_from_an_echoed_command(self):
        echoed = 'print "state end pressure ${p} coordination ${z}"\nstate end pressure ${p} coordination ${z}\n'
        with self.assertRaisesRegex(RunFailed, "state end"):
            state(echoed, "end")
        self.assertEqual(state(echoed + "state end pressure 1e5 coordination 5.1\n", "end"), State(1e5, 5.1))

    def test_cpu_time_is_the_difference_of_two_clock_lines(self):
        clock = self.folder / "cpu_clock"
        line = "7 (a b) S 1 2 3 4 5 6 7 8 9 10 {} {} 0 0\n"
        clock.write_text(line.format(100, 10) + line.format(200, 30))
        self.assertEqual(cpu_seconds(clock), 120 / os.sysconf("SC_CLK_TCK"))
        clock.write_text(line.format(100, 10))
        with self.assertRaisesRegex(RunFailed, "before and after"):
            cpu_seconds(clock)


    def test_the_loop_of_dirt_says_one_line_with_two_states(self):
        line = 'dirt: {"grains": 2, "steps": 5, "wall_s": 1, "cpu_s": 2, "rebuilds": 0, "start": {"pressure": 1e5, '
        line += '"coordination": 5.1}, "end": {"pressure": 9e4, "coordination": 5.2}}\n'
        found = dirt.measurement("banner\n" + line)
        self.assertEqual((found.grains, found.cpu_s, found.rebuilds), (2, 2, 0))
        self.assertEqual((found.start, found.end), (State(1e5, 5.1), State(9e4, 5.2)))
        with self.assertRaisesRegex(RunFailed, "no result"):
            dirt.measurement("banner\n")


class Dirt(InTemporaryFolder):
    def job(self) -> Job:
        packing = Packing((0, 0, 0), (6.0, 5.0, 4.0), 0.5, 2.0, [(0.1, 1.0, 1.0), (4.2, 1.0, 1.0)])
        return Job(packing, self.folder / "x", 2, 1, 100, self.folder, 1.0, Setting())

    def test_gets_every_copy_of_every_grain_and_the_setting_of_all_codes(self):
        rows = dirt.table(self.job()).splitlines()
        self.assertEqual((rows[0], len(rows)), ("x,y,z,radius", 1 + 16))
        self.assertIn("6.1,1.0,1.0,0.5", rows)
        text = dirt.configuration(self.job())
        for line in ("y_high = 10.0", 'boundary_z = "periodic"', "steps = 111", "friction = 0.1", "dt = 3e-08"):
            self.assertIn(line + "\n", text)

    def test_members_of_soil_core_are_made_public_and_another_version_is_refused(self):
        known = "    pub(crate) natoms: u64,\n    pub(crate) nlocal: u32,\n    pub(crate) nghost: u32,\n"
        known += "    natoms: u64, nlocal: u32,\n    pub(crate) fn try_register<T>(\n"
        public = dirt.opened(known)
        self.assertEqual(public.count("    pub n"), 3)
        self.assertIn("    pub fn try_register<T>", public)
        with self.assertRaisesRegex(RunFailed, "not the known 0.1.4"):
            dirt.opened(known.replace("nghost", "ghosts"))


class AChild(InTemporaryFolder):
    def test_that_is_late_is_ended_with_all_it_started(self):
        with self.assertRaisesRegex(RunFailed, "after 1 s"):
            run(["sh", "-c", "sleep 61 & echo $! > pid; wait"], self.folder, dict(os.environ), 1.0)
        grandchild = int((self.folder / "pid").read_text())
        for _ in range(100):
            stat = Path(f"/proc/{grandchild}/stat")
            if not stat.exists() or stat.read_text().rsplit(")", 1)[1].split()[0] == "Z":
                return
            time.sleep(0.05)
        self.fail("the grandchild still runs")

    def test_that_fails_is_quoted(self):
        with self.assertRaisesRegex(RunFailed, "(?s)status 3.*no such style"):
            run(["sh", "-c", "echo no such style >&2; exit 3"], self.folder, dict(os.environ), 10.0)

    def test_that_is_not_there_is_named(self):
        with self.assertRaisesRegex(RunFailed, "/no/such/code cannot be started"):
            run(["/no/such/code"], self.folder, dict(os.environ), 10.0)


class TheReport(unittest.TestCase):
    def test_takes_ratios_within_a_repetition_and_then_their_median(self):
        ours = Case("ours", True, 1.0, measured, ours=True)
        peer, other = Case("peer", True, 1.0, measured), Case("other", False, 1.0, measured)
        group = Group(2000, 1, [ours, peer, other])
        # The machine slows down threefold: the ratio of the medians would be 3, the median of the ratios is 2.
        group.runs["ours"] = [measured(t) for t in (1.0, 1.0, 3.0)]
        group.runs["peer"] = [measured(t) for t in (2.0, 3.0, 6.0)]
        group.runs["other"] = [measured(1.0)] * 3
        found = group.ratios(peer, "wall")
        self.assertEqual((found.median, found.minimum, found.maximum), (2.0, 2.0, 3.0))
        self.assertIsNone(group.ratios(other, "wall"), "with servo is not compared with without")
        group.runs["peer"][0] = None
        self.assertEqual(group.ratios(peer, "cpu").median, 2.5)

    def test_is_made_where_every_run_of_a_code_failed(self):
        group = Group(2000, 1, [Case("peer", True, 1.0, measured)], {"peer": [None]})
        self.assertIn("failed", group.table())
        self.assertEqual(group.rows()[0]["runs"], [None])


class Checks(unittest.TestCase):
    REFERENCE = State(1e5, 5.109)

    def failing(self, **more) -> list[str]:
        return [c.what for c in checks("peer", measured(1.0, **more), 2000, self.REFERENCE) if not c.holds]

    def test_pass_for_the_same_packing(self):
        self.assertEqual(self.failing(start=State(1e5, 5.109), end=State(0.98e5, 5.12), rebuilds=0), [])

    def test_fail_for_one_contact_fewer_or_another_modulus_or_extra_work_or_nothing_finite(self):
        self.assertEqual(len(self.failing(start=State(1e5, 5.108))), 1)
        self.assertEqual(len(self.failing(start=State(1.0001e5, 5.109))), 1)
        self.assertEqual(len(self.failing(rebuilds=1)), 1)
        self.assertEqual(len(self.failing(grains=16000)), 1)
        self.assertEqual(len(self.failing(end=State(float("nan"), 4.0))), 2)


class TheCommand(InTemporaryFolder):
    """The whole script with stubs for the codes: tests its output, not its measurements."""

    OURS = """#!{python}
import json, sys
if "--help" not in sys.argv and "--version" not in sys.argv:
    said = dict(zip(sys.argv, sys.argv[1:]))
    row = dict(grains=int(said["--grains"]), threads=int(said["--threads"]), coordination={coordination},
               particle_steps_per_second=2e7, cpu_particle_steps_per_second=None)
    print(json.dumps(dict(machine="", rows=[row])))
"""

    def command(self, *more: str, coordination: str = "5.11") -> subprocess.CompletedProcess:
        ours = self.folder / "grainlab"
        ours.write_text(self.OURS.format(python=sys.executable, coordination=coordination))
        ours.chmod(0o755)
        command = [sys.executable, HERE / "compare_peers.py", "--sizes", "2000", "--threads", "1", *more]
        # Neither another code on PATH nor a build in the checkout.
        environment = os.environ | {"PATH": str(self.folder)}
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)

    def test_names_what_is_not_installed_and_goes_on_without(self):
        done = self.command("--grainlab", str(self.folder / "grainlab"), "--format", "json")
        self.assertEqual(done.returncode, 0, done.stderr)
        for peer in ("LAMMPS", "LIGGGHTS", "YADE", "DIRT"):
            self.assertRegex(done.stderr, f"NOT RUN: {peer}: .*To have it: ")
        result = json.loads(done.stdout)
        self.assertEqual(result["rows"][0]["wall_particle_steps_per_second"]["median"], 2e7)
        self.assertIsNone(result["rows"][0]["cpu_particle_steps_per_second"])

    def test_fails_if_a_code_steps_another_packing(self):
        done = self.command("--grainlab", str(self.folder / "grainlab"), coordination="4.5")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "CHECK FAILED: grainlab.*4.5, expected 5.109")

    def test_fails_if_a_code_says_no_result(self):
        done = self.command("--grainlab", str(self.folder / "grainlab"), coordination="no_number")
        self.assertEqual(done.returncode, 1)
        self.assertIn("NameError", done.stderr)

    def test_fails_if_nothing_was_measured(self):
        done = self.command("--without-grainlab")
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing was measured", done.stderr)

    def test_refuses_bad_options(self):
        for option in (("--sizes", "2001"), ("--reps", "0"), ("--packing", "/no/such/file"), ("--threads", "two")):
            self.assertEqual(self.command("--without-grainlab", *option).returncode, 2, option)


if __name__ == "__main__":
    unittest.main()
