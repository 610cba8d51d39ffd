"""A packing of 80 grains from YADE, exported in every format that grainlab reads, and one of 40 equal grains with YADE's default
contact law; run by the interpreter of YADE:

    cd tests/golden/yade && /usr/bin/python3 make.py
"""

import json
import os
import sys

sys.path.insert(0, "../../../nodes/kit/recordings/src/import/yade")
sys.dont_write_bytecode = True
sys.argv = ["/usr/bin/yade", "-n", "-j", "1"]
# The launcher loads YADE's libraries and, as it is not `__main__` here, starts neither servers nor a prompt.
with open(sys.argv[0]) as launcher:
    exec(compile(launcher.read(), sys.argv[0], "exec"), {"__name__": "yade_launcher"})

from yade import *  # noqa: E402,F403
from yade import export, pack, utils  # noqa: E402
from yade.minieigenHP import Matrix3  # noqa: E402

import grainlab_export  # noqa: E402

O.periodic = True
O.cell.hSize = Matrix3(1.2e-3, 1e-4, 0, 0, 1.2e-3, 0, 0, 0, 1.2e-3)
glass = FrictMat(young=69.6e9, poisson=0.2, frictionAngle=0.1, density=2500)
O.materials.append(glass)
cloud = pack.SpherePack()
cloud.makeCloud(hSize=O.cell.hSize, rMean=1e-4, rRelFuzz=0.1, num=80, seed=1, periodic=True)
cloud.toSimulation(material=glass)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=1e-5),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3)],
        [Law2_ScGeom_MindlinPhys_Mindlin()],
    ),
    NewtonIntegrator(damping=0.2),
]
O.dt = 4e-8
O.cell.velGrad = Matrix3.Identity * -100
O.run(95000, True)
servo = PeriTriaxController(
    goal=(-1e6, -1e6, -1e6), stressMask=7, dynCell=False, globUpdate=1, maxStrainRate=(50, 50, 50), maxUnbalanced=0
)
O.engines = O.engines[:3] + [servo] + O.engines[3:]
O.run(150000, True)
O.engines = O.engines[:3] + [NewtonIntegrator(damping=0.4)]
O.cell.velGrad = Matrix3.Zero
O.dt = 1e-8
while utils.unbalancedForce() > 1e-9:
    O.run(20000, True)
cell = "cell " + str(O.cell.hSize)
grainlab_export.export("packing")
export.textExt("id_x_y_z_r_matId.txt", "id_x_y_z_r_matId", comment=cell)
export.textExt(
    "x_y_z_r_attrs.txt",
    "x_y_z_r_attrs",
    comment="# " + cell + "\nvx vy vz mass",
    attrs=["b.state.vel", "b.state.mass"],
)
export.text("x_y_z_r.txt")
stress = utils.getStress()
with open("stress.json", "w") as file:
    # Positive in tension, the convention of YADE.
    json.dump([[stress[r, c] for c in range(3)] for r in range(3)], file)
print("unbalanced force ratio", utils.unbalancedForce(), flush=True)

O.reset()
O.periodic = True
O.cell.hSize = Matrix3.Identity * 0.8
default = FrictMat(young=1e8, poisson=0.3, frictionAngle=0.35, density=2600)
O.materials.append(default)
cloud = pack.SpherePack()
cloud.makeCloud(hSize=O.cell.hSize, rMean=0.07, num=40, seed=1, periodic=True)
cloud.toSimulation(material=default)
servo = PeriTriaxController(
    goal=(-1e4, -1e4, -1e4), stressMask=7, dynCell=True, mass=0.2, globUpdate=5, maxStrainRate=(0.5, 0.5, 0.5), maxUnbalanced=0
)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    ),
    servo,
    NewtonIntegrator(damping=0.2),
]
O.dt = 0.5 * utils.PWaveTimeStep()
O.run(40000, True)
O.engines = O.engines[:3] + [NewtonIntegrator(damping=0.4)]
O.cell.velGrad = Matrix3.Zero
O.run(60000, True)
grainlab_export.export("default_law")
print("unbalanced force ratio", utils.unbalancedForce(), utils.getStress()[0, 0], flush=True)
# Without YADE's shutdown, which may crash without a prompt.
os._exit(0)
