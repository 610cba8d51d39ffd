"""Starts the launch file as a user does, and reads what is printed. GRAINLAB names the program, if it is not on the PATH."""
import json
import os
import subprocess
from pathlib import Path


def launched(*arguments):
    program, file = os.environ.get("GRAINLAB", "grainlab"), Path(__file__).with_name("NAME.launch.yaml")
    done = subprocess.run([program, "launch", file, *arguments], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done


def test_NAME():
    TEST
