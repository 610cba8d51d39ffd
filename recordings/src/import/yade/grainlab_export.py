"""Everything that grainlab measures of a periodic packing in YADE: NAME.csv and NAME.json, contacts and forces included.

In a script or the console of YADE, at rest (forces are those before the last motion):
    from grainlab_export import export
    export('packing')
then `grainlab analyze packing.csv`.
"""

import json
import math


def export(name):
    from yade.wrapper import Omega, Sphere

    O = Omega()
    grains = {b.id: b for b in O.bodies if b and isinstance(b.shape, Sphere)}
    materials = {b.material.id: b.material for b in grains.values()}
    if not O.periodic or len(materials) != 1:
        raise ValueError("one material and a periodic cell are needed")
    material = next(iter(materials.values()))
    with open(name + ".csv", "w") as csv:

        def row(kind, ids, numbers):
            print(kind, *ids, *("%.17g" % v for v in numbers), sep=",", file=csv)

        for i, b in grains.items():
            s = b.state
            row("p", [i], [*s.pos, b.shape.radius, s.mass, *s.vel, *s.angVel])
        for c in O.interactions:
            if not (c.isReal and c.id1 in grains and c.id2 in grains):
                continue
            a, b = grains[c.id1], grains[c.id2]
            apart = a.state.pos - b.state.pos - O.cell.hSize * c.cellDist
            overlap = a.shape.radius + b.shape.radius - apart.norm()
            if overlap > 0:
                n = apart / apart.norm()
                # YADE's forces are those on the second grain.
                force = -(c.phys.normalForce + c.phys.shearForce)
                row("c", [c.id1, c.id2], [*n, overlap, force.dot(n), *(force - n * force.dot(n))])
    cell = [[O.cell.hSize[r, c] for c in range(3)] for r in range(3)]
    about = {
        "G": material.young / (2 * (1 + material.poisson)),
        "nu": material.poisson,
        "density": material.density,
        "mu_prep": math.tan(material.frictionAngle),
        "cell": cell,
        "step": O.iter,
        "time": O.time,
    }
    with open(name + ".json", "w") as sidecar:
        json.dump(about, sidecar, indent=1)
