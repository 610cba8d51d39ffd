"""A child process with its output, a time limit, and an end of its whole group."""

import os
import signal
import subprocess
from pathlib import Path


class RunFailed(Exception):
    """A code that could not be run or printed no result, with its last output."""


def loopback_only(threads: int) -> dict[str, str]:
    """The environment of a child: no display, one OpenMP thread unless `threads` is larger, MPI through shared memory.

    UCX_TLS keeps MPICH's ranks, and the OMPI_ variables keep Open MPI's, from opening network sockets;
    with ess_singleton_isolated a process without mpirun starts no daemon.
    """
    environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
    environment |= {
        "OMP_NUM_THREADS": str(threads),
        "UCX_TLS": "self,sm",
        "HYDRA_LAUNCHER": "fork",
        "HYDRA_IFACE": "lo",
        "OMPI_MCA_btl": "self,vader",
        "OMPI_MCA_pml": "ob1",
        "OMPI_MCA_oob_tcp_if_include": "lo",
        "OMPI_MCA_plm": "isolated",
        "OMPI_MCA_ess_singleton_isolated": "1",
        # Otherwise the hardware detection of Open MPI queries ten X servers for their GPUs.
        "HWLOC_COMPONENTS": "-gl,linux,stop",
    }
    if os.geteuid() == 0:
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return environment


def run(command: list, directory: Path, environment: dict[str, str], timeout: float) -> str:
    """Runs `command` in `directory` to its end and returns its standard output; RunFailed if it fails or is late.

    The child leads a process group; the group is ended and reaped in any case, also on interrupts.
    """
    command = [str(word) for word in command]
    try:
        child = subprocess.Popen(
            command,
            cwd=directory,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            start_new_session=True,
        )
    except OSError as error:
        raise RunFailed(f"{command[0]} cannot be started: {error}") from error
    try:
        out, err = child.communicate(timeout=timeout)
    except subprocess.TimeoutExpired as error:
        raise RunFailed(f"{command[0]} was ended after {timeout:.0f} s (--timeout)") from error
    finally:
        _end(child)
    if child.returncode != 0:
        raise RunFailed(f"{command[0]} left with status {child.returncode}:\n{last_words(out + err)}")
    return out


def last_words(text: str, count: int = 12) -> str:
    """The last lines of a text, indented."""
    lines = [line for line in text.splitlines() if line.strip()]
    return "\n".join(f"    | {line}" for line in lines[-count:]) or "    | (no output)"


def _end(child: subprocess.Popen) -> None:
    """Ends the group of `child`: by SIGTERM, so that mpiexec ends its ranks, then by SIGKILL. Then reaps the child."""
    if child.poll() is None:
        _signal(child, signal.SIGTERM)
        try:
            child.communicate(timeout=5.0)
        except subprocess.TimeoutExpired:
            pass
    # Remaining processes of the group.
    _signal(child, signal.SIGKILL)
    child.wait()


def _signal(child: subprocess.Popen, number: int) -> None:
    try:
        os.killpg(child.pid, number)
    except ProcessLookupError:
        pass
