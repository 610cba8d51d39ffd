#!/usr/bin/env python3
"""A third-party acoustic instrument: sends one set of wave speeds, prints the microstructure received.

   pip install ../../msgs               # the message types for CycloneDDS: no ROS, nothing else of this project
   ROS_DOMAIN_ID=77 python3 instrument.py       # while `grainlab run emt_inversion` runs in the same domain

The answer is the one with the name and the stamp of what was sent: a late reader first receives the answer to somebody else's data.
With --json what was sent and what came back are printed whole. Ends with 4 if the speeds are refused, or no model has an estimate.
"""
import json
import sys
import time
from dataclasses import asdict
from pathlib import Path

# The message types of a folder above, if they are not installed.
sys.path += [str(folder / "msgs/python") for folder in Path(__file__).resolve().parents]
from grainlab_msgs import LATCHED, message, participant, reader, writer  # noqa: E402 (the path above)

WaveSpeeds, WaveSpeed = message("grainlab_msgs/msg/WaveSpeeds"), message("grainlab_msgs/msg/WaveSpeed")
Microstructure, Vector3 = message("grainlab_msgs/msg/Microstructure"), message("geometry_msgs/msg/Vector3")
STATUS = ["ok", "extrapolated", "contradictory", "unknown"]

# Glass beads under 50 kPa, axis vertical: direction, polarization, and speed in m/s, with an error of 0.3 %.
UP, ACROSS, ASIDE, SLANTED = [Vector3(*v) for v in ((0., 0., 1.), (1., 0., 0.), (0., 1., 0.), (0.6, 0., 0.8))]
HEARD = [(UP, UP, 437.2), (ACROSS, ACROSS, 425.0), (UP, ACROSS, 269.1), (ACROSS, UP, 270.3),
         (ACROSS, ASIDE, 264.9), (SLANTED, SLANTED, 433.0)]


def measurement():
    speeds = [WaveSpeed(method=WaveSpeed.METHOD_CROSS_CORRELATION, direction=n, polarization=p, speed=v,
                        speed_stddev=0.003 * v, frequency=10e3, strain_amplitude=1e-7) for n, p, v in HEARD]
    return WaveSpeeds(name="glass beads 1", density=1498.0, density_stddev=5.0, pressure=50e3, pressure_stddev=500.0,
                      solid_fraction=0.634, axis=UP, grain_shear_modulus=29e9, grain_shear_modulus_stddev=5e8,
                      grain_poisson_ratio=0.2, speeds=speeds)


class Instrument:
    """A writer of wave speeds and a reader of the estimates, once both have discovered the inversion."""

    def __init__(self, seconds=60.0):
        self.participant = participant()
        self.reader = reader(self.participant, "microstructure", Microstructure, LATCHED)
        self.writer = writer(self.participant, "wave_speeds", WaveSpeeds, LATCHED)
        # Counts, because CycloneDDS's list of readers fails (IndexError) if a reader comes while the list is made.
        running = "is `grainlab run emt_inversion` running in this ROS_DOMAIN_ID?"
        readers = lambda: self.writer.get_publication_matched_status().current_count
        writers = lambda: self.reader.get_subscription_matched_status().current_count
        self.until(readers, seconds, f"nobody reads wave_speeds: {running}")
        self.until(writers, seconds, f"nobody writes microstructure: {running}")

    def until(self, ready, seconds, trouble):
        end = time.monotonic() + seconds
        while not (found := ready()):
            if time.monotonic() > end:
                sys.exit(trouble)
            time.sleep(0.01)
        return found

    def infer(self, speeds, seconds=60.0):
        """Sends the speeds with the time of this moment, and returns the answer to them."""
        nanoseconds = time.time_ns()
        speeds.header.stamp.sec, speeds.header.stamp.nanosec = divmod(nanoseconds, 10**9)
        return self.answer(speeds, seconds)

    def answer(self, speeds, seconds=60.0):
        """Sends the speeds as they are, and returns the answer with their stamp and name."""
        self.reader.take(64)  # answers to what others have sent
        self.writer.write(speeds)
        is_it = lambda m: isinstance(m, Microstructure) and (m.source, m.name, m.header.stamp) == (
            "wave_speeds", speeds.name, speeds.header.stamp)
        matching = lambda: [m for m in self.reader.take(64) if is_it(m)]
        return self.until(matching, seconds, f"no answer to {speeds.name!r} came back within {seconds:.0f} s")[0]


def show(sent, found):
    """Prints the estimates of each model."""
    print(f"{sent.name}\n{'inferred by':<17} {'k':>15} {'z':>15} {'eps':>17}  status")
    for e in found.estimates:
        sigma = lambda i: e.covariance[i]**0.5 if e.covariance else float("nan")
        values = [(e.k, 0), (e.z, 12), (e.eps, 18)]
        cells = [f"{v[0]:.4f} +- {sigma(i):.4f}" if v else "-" for v, i in values]
        print(f"{e.model:<17} {cells[0]:>15} {cells[1]:>15} {cells[2]:>17}  {STATUS[e.status]}")
        print("".join(f"    {warning}\n" for warning in e.warnings), end="")
    sys.stdout.flush()


def main():
    sent = measurement()
    found = Instrument().infer(sent)
    if "--json" in sys.argv:
        return print(json.dumps({"sent": asdict(sent), "received": asdict(found)}))
    unknown = [e for e in found.estimates if STATUS[e.status] == "unknown"]
    if len(unknown) == len(found.estimates):
        reasons = dict.fromkeys(w for e in unknown for w in e.warnings)
        print(f"{sent.name}: no estimate: " + "\n".join(reasons), file=sys.stderr)
        sys.exit(4)
    show(sent, found)


if __name__ == "__main__":
    main()
