#!/usr/bin/env python3
"""A third-party acoustic instrument: sends one set of wave speeds, prints the microstructure received.

   pip install cyclonedds==11.0.1       # no ROS, and only the message files of this project
   ROS_DOMAIN_ID=77 instrument.py       # while `grainlab run emt_inversion` runs in the same domain

With --json what was sent and what came back are printed whole. CYCLONEDDS_URI, if set, chooses the network; else it is this host alone.
"""
import json
import os
import sys
import time
from dataclasses import asdict

os.environ.setdefault("CYCLONEDDS_URI", '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" '
                      'multicast="true"/></Interfaces></General></Domain></CycloneDDS>')
from cyclonedds.domain import DomainParticipant  # noqa: E402 (reads the variable)
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from ros_messages import LATCHED, message  # noqa: E402

WaveSpeeds, WaveSpeed = message("grainlab_msgs/msg/WaveSpeeds"), message("grainlab_msgs/msg/WaveSpeed")
Microstructure, Vector3 = message("grainlab_msgs/msg/Microstructure"), message("geometry_msgs/msg/Vector3")

# Glass beads under 50 kPa, axis vertical: direction, polarization, and speed in m/s, with an error of 0.3 %.
UP, ACROSS, ASIDE, SLANTED = [Vector3(*v) for v in ((0., 0., 1.), (1., 0., 0.), (0., 1., 0.), (0.6, 0., 0.8))]
HEARD = [(UP, UP, 437.2), (ACROSS, ACROSS, 425.0), (UP, ACROSS, 269.1), (ACROSS, UP, 270.3),
         (ACROSS, ASIDE, 264.9), (SLANTED, SLANTED, 433.0)]


def measurement():
    speeds = [WaveSpeed(method=WaveSpeed.METHOD_CROSS_CORRELATION, direction=n, polarization=p, speed=v,
                        speed_stddev=0.003 * v, frequency=10e3, strain_amplitude=1e-7) for n, p, v in HEARD]
    return WaveSpeeds(density=1498.0, density_stddev=5.0, pressure=50e3, solid_fraction=0.634, axis=UP,
                      grain_shear_modulus=29e9, grain_poisson_ratio=0.2, speeds=speeds)


def domain():
    return int(os.environ.get("ROS_DOMAIN_ID", "0"))


class Instrument:
    """A writer of wave speeds and a reader of the estimates, once both have discovered the inversion."""

    def __init__(self, seconds=20.0):
        self.participant = DomainParticipant(domain())
        topic = lambda name, kind: Topic(self.participant, "rt/" + name, kind, qos=LATCHED)
        self.reader = DataReader(self.participant, topic("microstructure", Microstructure), qos=LATCHED)
        self.writer = DataWriter(self.participant, topic("wave_speeds", WaveSpeeds), qos=LATCHED)
        self.until(lambda: self.writer.get_matched_subscriptions(), seconds, "nobody reads wave_speeds")
        self.until(lambda: self.reader.get_matched_publications(), seconds, "nobody writes microstructure")

    def until(self, ready, seconds, trouble):
        end = time.monotonic() + seconds
        while not (found := ready()):
            if time.monotonic() > end:
                sys.exit(f"{trouble}: is `grainlab run emt_inversion` running in this ROS_DOMAIN_ID?")
            time.sleep(0.01)
        return found

    def infer(self, speeds, seconds=20.0):
        self.writer.write(speeds)
        answer = lambda: [m for m in self.reader.take(16) if isinstance(m, Microstructure)]
        return self.until(answer, seconds, "no microstructure came back")[0]


def main():
    sent = measurement()
    found = Instrument().infer(sent)
    if "--json" in sys.argv:
        return print(json.dumps({"sent": asdict(sent), "received": asdict(found)}))
    print(f"{'inferred by':<17} {'k':>15} {'z':>15} {'eps':>17}  status")
    status = ["ok", "extrapolated", "contradictory", "unknown"]
    for e in found.estimates:
        sigma = lambda i: e.covariance[i]**0.5 if e.covariance else float("nan")
        values = [(e.k, 0), (e.z, 12), (e.eps, 18)]
        cells = [f"{v[0]:.4f} +- {sigma(i):.4f}" if v else "-" for v, i in values]
        print(f"{e.model:<17} {cells[0]:>15} {cells[1]:>15} {cells[2]:>17}  {status[e.status]}")
        print("".join(f"    {warning}\n" for warning in e.warnings), end="")


if __name__ == "__main__":
    main()
