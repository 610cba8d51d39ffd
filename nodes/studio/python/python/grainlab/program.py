"""The program ``grainlab``: the command line of this package, and commands that run as processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import warnings
from typing import Any

from . import _grainlab

#: Words that start the program: by the Python that runs, without a file on the PATH.
WORDS = [sys.executable, "-m", "grainlab"]
#: Variable of a command that ends with the Python that called it.
CHILD = "GRAINLAB_CHILD"


def main() -> None:
    """Runs the command line of this process, and exits with its code."""
    # Python only notes an interrupt, and sees the note between two of its own instructions.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_grainlab.run(["grainlab", *sys.argv[1:]], WORDS, os.environ.pop(CHILD, "") == "1"))


def flags(options: dict[str, Any]) -> list[str]:
    """Keywords as flags of a command line: ``member_time=5`` is ``--member-time=5``, True a flag alone; None and False are left out."""
    words = []
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is True:
            words.append(flag)
        elif value is not None and value is not False:
            several = isinstance(value, (list, tuple))
            words.append(f"{flag}={','.join(map(str, value)) if several else value}")
    return words


def call(*words: Any, input: str | None = None, wrong: type = ValueError, answers: tuple[int, ...] = (0, 3, 4)) -> str:
    """Standard output of a command that ends with one of these exit codes; lines of a code but 0 are a warning, and others an exception."""
    pipe = subprocess.PIPE
    command = [*WORDS, *map(os.fspath, words)]
    # A group of its own: an interrupt comes from here, once, so that a run can save its state.
    settings = {"text": True, "start_new_session": True, "env": {**os.environ, CHILD: "1"}}
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, **settings) as process:
        try:
            out, said = process.communicate(input)
        except BaseException:
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
    lines = [line.removeprefix("grainlab: ") for line in said.splitlines()]
    text = "\n".join(lines).removeprefix("error: ").strip()
    if process.returncode not in answers or (process.returncode and not out):
        raise {2: wrong, 4: _grainlab.PhysicsError, 130: KeyboardInterrupt}.get(process.returncode, _grainlab.GrainlabError)(text)
    if process.returncode:
        warnings.warn(f"exit code {process.returncode} of {words[0]}: {text}", stacklevel=3)
    return out


def command(*words: str | os.PathLike[str], input: str | None = None) -> str:
    """Runs any command of the program, as typed in a shell, and returns its standard output.

    The words are those of the command line, with SI units where it has units; ``input`` is the standard input. All commands are
    listed by ``grainlab --help``, and described by ``grainlab COMMAND --help``. Raises ValueError (exit code 2), PhysicsError (4) or
    GrainlabError, with the text of the command; data loss (3) is a warning.

    >>> print(grainlab.command("bag", "info", "recordings/runs/demo-1-1"))
    """
    return call(*words, input=input, answers=(0, 3))
