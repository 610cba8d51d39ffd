"""Packings for other libraries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    from ._grainlab import Packing


def upper_triangular(cell: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rotation Q, shape (3, 3), and the upper triangular cell R = Q cell with positive diagonal.

    freud, LAMMPS and others take cells of this form only. Rotate vectors by ``vectors @ Q.T``.
    """
    import numpy as np

    q, r = np.linalg.qr(cell)
    signs = np.sign(np.diag(r))
    return (q * signs).T, np.triu(signs[:, None] * r)


def to_freud(packing: Packing) -> tuple[Any, np.ndarray]:
    """``(box, points)`` for freud: the box, and the centres in it, float32, shape (n, 3), m, wrapped about 0.

    The packing is rotated where its cell is not upper triangular. Needs the package ``freud-analysis``, and raises ImportError without it.

    >>> box, points = grainlab.to_freud(packing)
    """
    import freud

    rotation, cell = upper_triangular(packing.cell)
    box = freud.box.Box.from_matrix(cell)
    return box, box.wrap(packing.positions @ rotation.T)


def to_ovito(packing: Packing) -> Any:
    """A ``DataCollection`` for OVITO: particles with radius, velocity, spin; contacts as bonds with forces.

    Lengths are in m, forces in N; OVITO holds radii in single precision. Needs the package ``ovito``, and raises ImportError without it.

    >>> data = grainlab.to_ovito(packing)
    """
    import numpy as np
    from ovito.data import DataCollection

    data = DataCollection()
    cell = np.zeros((3, 4))
    cell[:, :3] = packing.cell
    data.create_cell(cell, pbc=(True, True, True))
    particles = data.create_particles(count=len(packing))
    particles.create_property("Position", data=packing.positions)
    particles.create_property("Radius", data=packing.radii)
    particles.create_property("Velocity", data=packing.velocities)
    particles.create_property("Angular Velocity", data=packing.angular_velocities)
    particles.create_property("Particle Identifier", data=packing.ids)
    pairs = np.stack([packing.contact_first, packing.contact_second], axis=1)
    bonds = particles.create_bonds(count=len(pairs))
    bonds.create_property("Topology", data=pairs)
    bonds.create_property("Periodic Image", data=packing.contact_images)
    bonds.create_property("Force", data=packing.contact_normal_forces)
    return data


def to_arviz(draws: dict[str, Any]) -> Any:
    """Draws of :func:`invert`, or of a file of ``grainlab invert --draws draws.json``, for ArviZ: an ``InferenceData`` by ArviZ 0.x, a
    ``DataTree`` by ArviZ 1. Moduli in Pa, their ln densities in MPa.

    Needs the package ``arviz``, or ``arviz-base`` of ArviZ 1, and raises ImportError without it.

    >>> found = grainlab.invert(g12=104.2e6, g13=112.4e6, theta=136e6, pressure=50e3, draws=1000)
    >>> arviz.summary(grainlab.to_arviz(found["draws"]), var_names=["z", "eps"])
    """
    try:
        from arviz import from_dict
    except ImportError:
        from arviz_base import from_dict
    import inspect

    import numpy as np

    of_draws = {name: group for name, group in draws.items() if name not in ("coords", "dims", "attrs")}
    groups = {name: {key: np.asarray(values) for key, values in group.items()} for name, group in of_draws.items()}
    of_names = {"coords": draws["coords"], "dims": draws["dims"]}
    if "posterior" in inspect.signature(from_dict).parameters:
        return from_dict(**groups, **of_names)
    return from_dict(groups, **of_names)
