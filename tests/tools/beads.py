"""Files of an oscilloscope from the virtual records of one sample, with noise, offset, crosstalk and a reversed receiver.

   beads.py TRACES.csv FOLDER        # TRACES: by the example wave_records, of folders whose names end with their pressure, kPa
"""
import csv
import math
import random
import sys
from pathlib import Path

csv.field_size_limit(10**7)
NOISE, CROSSTALK, OFFSET = 0.03, 0.2, 0.012
WAVES = [("p", 0), ("s", 0), ("sv", 90), ("p", 90)]


def burst(time, frequency):
    u = time * frequency / 2 - 0.5
    return math.cos(math.pi * u) ** 2 * math.sin(4 * math.pi * u) if abs(u) < 0.5 else 0.0


def main():
    traces, folder = list(csv.DictReader(open(sys.argv[1]))), Path(sys.argv[2])
    random.seed(1)
    table = ["file,sample,pressure_pa,phi,grain_density,mode,angle_deg,distance,distance_sigma,delay,delay_sigma,diameter"]
    for state in dict.fromkeys(t["packing"] for t in traces):
        of_state = [t for t in traces if t["packing"] == state]
        pressure = state.split("-")[-1]
        # Ten records of each wave: five distances at two frequencies. The last is the longest path of the longest wave.
        for (mode, angle), trace in zip(WAVES, of_state[9::10]):
            frequency, rate, start = (float(trace[k]) for k in ("frequency", "sample_rate", "start"))
            lines = ["Model,DSO-X,", "Source,CH1,CH2", "second,Volt,Volt"]
            for k, sample in enumerate(trace["samples"].split()):
                sent = 10 * burst(start + k / rate, frequency)
                arrived = 0.05 * (float(sample) / 1e4 + random.gauss(0, NOISE)) * (1 if mode == "p" else -1)
                received = arrived + 0.05 * CROSSTALK * sent / 10 + OFFSET
                lines.append(f"{start + k / rate:.4e},{sent:.4f},{received:.5f}")
            name = f"{mode}{angle}-{pressure}kPa.csv"
            (folder / name).write_text("\n".join(lines) + "\n")
            table.append(f"{name},beads,{pressure}e3,0.637,2500,{mode},{angle},{float(trace['distance']):.5f},5e-5,0,1e-7,2e-4")
    (folder / "records.csv").write_text("\n".join(table) + "\n")


main()
