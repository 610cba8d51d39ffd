"""The stepping loop of YADE on a dense frictional packing at rest, three periodic sides.

usage: loop_yade.py JSON    run by the interpreter that YADE was built for, not by the `yade` command, because that one
                            opens a Python console and an XML-RPC server on every network interface.

JSON holds: launcher (path of the `yade` command), packing (data file), replicas, threads, warmup, steps, servo, and the
setting of the comparison (SI units). Prints one line: `yade: ` and the measurement as JSON.
"""

import json
import math
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
sys.dont_write_bytecode = True

from peers.packing import Packing  # noqa: E402
from peers.setting import Setting  # noqa: E402

job = json.loads(sys.argv[1])
setting = Setting(**job["setting"])

# The launcher loads YADE's libraries and, as it is not `__main__` here, starts neither servers nor a prompt.
sys.argv = [job["launcher"], "-n", "-j", str(job["threads"])]
with open(job["launcher"]) as launcher:
    exec(compile(launcher.read(), job["launcher"], "exec"), {"__name__": "yade_launcher"})

import yade  # noqa: E402
from yade import *  # noqa: E402,F403
from yade import utils  # noqa: E402

packing = Packing.read(Path(job["packing"]))
O.periodic = True
O.cell.setBox(*(job["replicas"] * side for side in packing.sides))
material = O.materials.append(
    FrictMat(
        young=setting.young,
        poisson=setting.poisson,
        frictionAngle=math.atan(setting.friction),
        density=packing.density,
    )
)
O.bodies.append(
    [utils.sphere(x, packing.radius, material=material) for x in packing.replicated(job["replicas"])]
)
O.engines = [
    ForceResetter(),
    # Each bounding box grows by verletDist, so that pairs are listed up to twice that distance: the skin of the other codes.
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=0.5 * setting.skin),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_MindlinPhys(en=setting.restitution, es=setting.restitution)],
        [Law2_ScGeom_MindlinPhys_Mindlin()],
    ),
]
if job["servo"]:
    O.engines += [
        PeriTriaxController(
            goal=(-setting.pressure,) * 3,
            stressMask=7,
            dynCell=False,
            # The stress at every step, as in the other servos (YADE's default is every fifth step).
            globUpdate=1,
            maxStrainRate=(1, 1, 1),
            # Never "converged": it must not stop the loop.
            maxUnbalanced=0,
        )
    ]
O.engines += [NewtonIntegrator(damping=0.0)]
O.dt = setting.time_step


def state():
    """Pressure, Pa, and contacts per grain times two."""
    contacts = sum(1 for i in O.interactions if i.isReal)
    return {"pressure": -utils.getStress().trace() / 3, "coordination": 2 * contacts / len(O.bodies)}


# Forces come first in a step, so after one step they are still those of the positions as read.
O.run(1, True)
start = state()
O.run(job["warmup"], True)
wall, cpu = time.perf_counter(), time.process_time()
O.run(job["steps"], True)
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
result = {
    "version": yade.config.version,
    "grains": len(O.bodies),
    "steps": job["steps"],
    "wall_s": wall,
    "cpu_s": cpu,
    "start": start,
    "end": state(),
}
print("yade: " + json.dumps(result), flush=True)
# Without YADE's shutdown, which may crash without a prompt.
os._exit(0)
