#!/usr/bin/env python3
"""A servo of your own: answers every stress of the simulator with six strain rates, by CycloneDDS.

   pip install ../../msgs               # the message types for CycloneDDS: no ROS, nothing else of this project
   grainlab new node my_servo --servo   # this program with a launch file and a test

The same stress gets the same answer, so that a servo that is started again in the middle of a run changes nothing.
"""
import os
import sys
import threading
import traceback
from pathlib import Path

# The message types of a folder above, if they are not installed.
sys.path += [str(folder / "msgs/python") for folder in Path(__file__).resolve().parents]
from grainlab_msgs import STREAM, message, participant, reader, writer  # noqa: E402 (the path above)
from cyclonedds.core import Listener  # noqa: E402

Stress, StrainRate = message("grainlab_msgs/msg/Stress"), message("grainlab_msgs/msg/StrainRate")
COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")
# Simulated time, in control intervals, in which the error would vanish at the present stiffness. Of a shorter one the loop may diverge.
RESPONSE = 20.0


def answer(stress):
    """Strain rates, 1/s, extension positive: (stress - setpoint) / (stiffness response time), at most rate_limit."""
    rates = []
    for i, name in enumerate(COMPONENTS):
        value = 0.0  # MODE_HELD
        if stress.mode[i] == Stress.MODE_STRAIN_RATE:
            value = stress.setpoint[i]
        elif stress.mode[i] == Stress.MODE_STRESS:
            error = getattr(stress.stress, name) - stress.setpoint[i]
            # Without contacts there is no stiffness: as fast as the limit allows.
            stiffness = getattr(stress.tangent[0], name) if stress.tangent else 0.0
            viscosity = (1.0 if i < 3 else 2.0) * stiffness * RESPONSE * stress.control_interval
            value = error / viscosity if viscosity else error * float("inf") if error else 0.0
        rates.append(max(-stress.rate_limit, min(stress.rate_limit, value)))
    saturated = [abs(rate) == stress.rate_limit for rate in rates]
    return StrainRate(header=stress.header, sequence=stress.sequence, rate=rates, saturated=saturated)


class Waker(Listener):
    """Wakes the servo when a stress arrives, without a pause that would hold the simulator up."""

    def __init__(self):
        super().__init__()
        self.arrived = threading.Event()

    def on_data_available(self, reader):
        self.arrived.set()


def main():
    waker, host = Waker(), participant()
    answers = writer(host, "strain_rate", StrainRate, STREAM)
    stresses = reader(host, "stress", Stress, STREAM, listener=waker)
    while True:
        waker.arrived.wait()
        waker.arrived.clear()
        while samples := stresses.take(64):
            for stress in samples:
                if isinstance(stress, Stress):  # else a writer left
                    answers.write(answer(stress))


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
    except BaseException:
        # The thread of the listener would keep the program: it ends at once, so that the run ends, too.
        traceback.print_exc()
        os._exit(1)
