"""Ctrl-C during a computation, each in an interpreter of its own."""

import pathlib
import subprocess
import sys
import textwrap

import pytest

SMOOTH = pathlib.Path(__file__).resolve().parents[4] / "tests/golden/packings/smooth_500.csv.gz"

SCRIPT = """
import os, signal, threading, time
import grainlab

(packing,) = grainlab.load({path!r})
sent = []

def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

threading.Timer(0.5, interrupt).start()
try:
    grainlab.{call}
except KeyboardInterrupt:
    print(time.monotonic() - sent[0])
    # The rest of the computation is not waited for.
    os._exit(0)
"""

# Each takes many seconds if nothing ends it. The first array of a process is made in each of them.
CALLS = [
    "probe([packing] * 400)",
    "analyze([packing] * 4000)",
    "invert(g12=[104.2e6] * 400_000, g13=112.4e6, theta=136e6, pressure=50e3)",
    "invert(g12=104.2e6, g13=112.4e6, theta=136e6, pressure=50e3, draws=500_000)",
]


@pytest.mark.parametrize("call", CALLS)
def test_ctrl_c_ends_a_computation_at_once(call):
    script = textwrap.dedent(SCRIPT.format(path=str(SMOOTH), call=call))
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert found.returncode == 0 and found.stdout, found.stderr
    # Signals are looked for every 0.05 s. The longest of 28 took 0.064 s, on two cores with eight other busy processes.
    assert float(found.stdout) < 0.2
