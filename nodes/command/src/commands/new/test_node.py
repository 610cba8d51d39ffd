"""Starts the launch file as a user does, and reads what is printed. GRAINLAB names the program, if it is not on the PATH."""
import json
import os
import subprocess
import sys
from pathlib import Path

# The nodes are run by the Python of this test.
PATH = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])


def launched(*arguments):
    program, file = os.environ.get("GRAINLAB", "grainlab"), Path(__file__).with_name("NAME.launch.yaml")
    done = subprocess.run([program, "launch", file, *arguments], capture_output=True, text=True, timeout=300,
                          env=os.environ | {"PATH": PATH})
    assert done.returncode == 0, done.stdout + done.stderr
    return done


def test_NAME():
    TEST
