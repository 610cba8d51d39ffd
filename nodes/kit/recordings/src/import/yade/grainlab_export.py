"""Everything that grainlab measures of a periodic packing in YADE: NAME.csv and NAME.json, contacts and forces included.

In a script or the console of YADE, at rest (forces are those before the last motion):
    from grainlab_export import export
    export('packing')
then `grainlab analyze packing.csv`.

The contact law is written for contacts of Ip2_FrictMat_FrictMat_FrictPhys with one k_n (YADE's default law between grains of one
size), and of Ip2_FrictMat_FrictMat_MindlinPhys. For others a line says what to do.
"""

import json
import math


def contact_law(contacts, name):
    """Name and parameters of the law as grainlab has it, and else None and the reason."""
    kinds = {type(phys).__name__ for phys in contacts}
    if kinds == {"MindlinPhys"}:
        return ("hertz_mindlin", []), None
    if kinds != {"FrictPhys"}:
        return None, "grainlab does not know the law of %s" % " and ".join(sorted(kinds) or ["no contacts"])
    mean = [sum(k) / len(contacts) for k in zip(*((phys.kn, phys.ks) for phys in contacts))]
    law = "linear:%.6g,%.6g" % (mean[0], mean[1] / mean[0])
    if not mean[1] > 0:
        return None, "k_s is 0 (FrictMat.poisson = 0), and grainlab's linear law needs one above 0"
    spread = max(abs(k / m - 1) for phys in contacts for k, m in zip((phys.kn, phys.ks), mean))
    if spread > 1e-6:
        return None, (
            "k_n differs by up to %.1f %% from its mean, because YADE makes it proportional to the radii, and grainlab's linear "
            "law has one k_n; `grainlab analyze %s.csv --contact-law %s` takes the mean" % (100 * spread, name, law)
        )
    return ("linear", [mean[0], mean[1] / mean[0]]), None


def export(name):
    from yade.wrapper import Omega, Sphere

    O = Omega()
    grains = {b.id: b for b in O.bodies if b and isinstance(b.shape, Sphere)}
    materials = {b.material.id: b.material for b in grains.values()}
    if not O.periodic or len(materials) != 1:
        raise ValueError("one material and a periodic cell are needed")
    material = next(iter(materials.values()))
    contacts = []
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
                contacts.append(c.phys)
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
    law, reason = contact_law(contacts, name)
    if law:
        about["contact_law"], about["contact_law_parameters"] = law
    else:
        print("grainlab_export: the contact law is not written: " + reason)
    with open(name + ".json", "w") as sidecar:
        json.dump(about, sidecar, indent=1)
