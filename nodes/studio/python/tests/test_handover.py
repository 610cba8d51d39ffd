import grainlab
import numpy as np
import pytest
from grainlab.handover import upper_triangular


def test_a_rotated_cell_keeps_lengths_and_angles():
    rng = np.random.default_rng(1)
    cell = np.eye(3) + 0.3 * rng.standard_normal((3, 3))
    assert np.linalg.det(cell) > 0
    rotation, upper = upper_triangular(cell)
    assert np.allclose(rotation @ cell, upper) and np.allclose(np.tril(upper, -1), 0)
    assert np.diag(upper).min() > 0 and np.isclose(np.linalg.det(rotation), 1)


def test_freud_finds_the_contacts(packing):
    freud = pytest.importorskip("freud")
    box, points = grainlab.to_freud(packing)
    assert np.isclose(box.volume, np.linalg.det(packing.cell), rtol=1e-5)
    # Units of a diameter: freud computes in single precision.
    scale = 2 * packing.radii.mean()
    box, points = freud.box.Box.from_matrix(box.to_matrix() / scale), points / scale
    neighbours = freud.locality.AABBQuery(box, points).query(points, {"r_max": 1.05, "exclude_ii": True}).toNeighborList()
    near = {(min(i, j), max(i, j)) for i, j in neighbours[:]}
    contacts = set(zip(packing.contact_first.tolist(), packing.contact_second.tolist(), strict=True))
    assert contacts <= near


def test_ovito_has_radii_and_bonds(packing):
    pytest.importorskip("ovito")
    data = grainlab.to_ovito(packing)
    assert data.particles.count == len(packing)
    # OVITO holds radii in single precision.
    assert np.array_equal(data.particles["Radius"][...], packing.radii.astype(data.particles["Radius"].dtype))
    assert np.array_equal(data.particles.positions[...], packing.positions)
    assert data.particles.bonds.count == len(packing.contact_first)
