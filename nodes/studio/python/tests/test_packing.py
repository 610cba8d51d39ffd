import gc
import multiprocessing
import pickle

import grainlab
import numpy as np
import pytest


def test_arrays_share_the_memory_of_the_packing_and_cannot_be_changed(packing):
    for name in ("ids", "radii", "positions", "velocities", "contact_normals", "contact_normal_forces", "contact_images"):
        first, second = getattr(packing, name), getattr(packing, name)
        assert first.base is packing and np.shares_memory(first, second), name
        assert first.ctypes.data == second.ctypes.data
        with pytest.raises(ValueError, match="read-only"):
            first[0] = 0


def test_an_array_outlives_the_name_of_its_packing(packing):
    def positions():
        other = grainlab.Packing(packing.cell, packing.positions, packing.radii)
        return other.positions, other.positions.copy()

    kept, copy = positions()
    gc.collect()
    _ = [np.random.rand(1000) for _ in range(100)]
    assert np.array_equal(kept, copy)


def test_contacts_agree_with_positions_and_radii(packing):
    i, j = packing.contact_first, packing.contact_second
    branch = packing.positions[j] - packing.positions[i] + packing.contact_images @ packing.cell.T
    assert np.allclose(branch, packing.contact_branches, atol=1e-18)
    length = np.linalg.norm(branch, axis=1)
    assert np.allclose(branch / length[:, None], packing.contact_normals, atol=1e-12)
    overlap = packing.radii[i] + packing.radii[j] - length
    assert np.allclose(overlap, packing.contact_overlaps, rtol=1e-6, atol=1e-18)
    volume = (4 / 3 * np.pi * packing.radii**3).sum() / np.linalg.det(packing.cell)
    assert np.isclose(volume, packing.solid_fraction, rtol=1e-12)


def test_wrapped_positions_are_in_the_cell_and_differ_by_lattice_vectors(packing):
    fractional = np.linalg.solve(packing.cell, packing.wrapped_positions.T)
    assert fractional.min() > -1e-12 and fractional.max() < 1 + 1e-12
    steps = np.linalg.solve(packing.cell, (packing.positions - packing.wrapped_positions).T)
    assert np.allclose(steps, np.round(steps), atol=1e-9)


def test_a_packing_from_arrays_has_the_same_contacts(packing):
    again = grainlab.Packing(packing.cell, packing.positions, packing.radii, friction=packing.friction)
    assert np.array_equal(again.contact_first, packing.contact_first)
    assert np.array_equal(again.contact_images, packing.contact_images)
    assert np.allclose(again.contact_overlaps, packing.contact_overlaps, rtol=1e-6, atol=1e-18)


def test_a_packing_without_contacts_has_empty_arrays():
    alone = grainlab.Packing(np.eye(3), np.zeros((1, 3)), np.array([0.1]))
    assert alone.contact_normals.shape == (0, 3) and alone.contact_first.shape == (0,)
    assert alone.contact_branches.shape == (0, 3) and list(alone.rattlers) == [True]
    nothing = alone.contact_normal_forces
    assert nothing.sum() == 0


@pytest.mark.parametrize(
    ("cell", "positions", "radii", "words"),
    [
        (np.eye(2), np.zeros((1, 3)), [0.1], "cell has shape"),
        (-np.eye(3), np.zeros((1, 3)), [0.1], "no volume"),
        (np.eye(3), np.zeros((1, 2)), [0.1], "positions has shape"),
        (np.eye(3), np.full((1, 3), np.nan), [0.1], "not finite"),
        (np.eye(3), np.ma.array(np.ones((1, 3)), mask=True), [0.1], "not finite"),
        (np.eye(3), [[0, 0, 0], [1]], [0.1], "^positions: "),
        ("x", np.zeros((1, 3)), [0.1], "^cell: "),
        (np.eye(3), np.zeros((1, 3)), ["wide"], "^radii: "),
        (np.eye(3), np.zeros((2, 3)), [0.1], "2"),
        (np.eye(3), np.zeros((2, 3)), [0.1, 0.1], "coincide|same"),
        (np.eye(3), np.zeros((1, 3)), [-0.1], "radius"),
        (np.eye(3), np.full((1, 3), 1e300), [0.1], "."),
        (np.eye(3) * 1e-300, np.zeros((1, 3)), [1e300], "."),
    ],
)
def test_wrong_arrays_raise_and_never_abort(cell, positions, radii, words):
    with pytest.raises(ValueError, match=words):
        grainlab.Packing(cell, positions, np.array(radii))


def test_a_pickle_loses_nothing(packing, golden):
    for one in (packing, golden):
        again = pickle.loads(pickle.dumps(one))
        assert pickle.dumps(again) == pickle.dumps(one)
        for name in ("time", "phase", "source", "notes", "friction", "step", "end_of_phase"):
            assert getattr(again, name) == getattr(one, name), name
        for name in ("positions", "velocities", "contact_overlaps", "contact_tangential_forces", "cell"):
            assert getattr(again, name).tobytes() == getattr(one, name).tobytes(), name


def test_processes_return_packings(packing):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (again,) = pool.map(pickle.loads, [pickle.dumps(packing)])
    assert again.positions.tobytes() == packing.positions.tobytes()


def measured(packing):
    state = {"g12": [104.2e6] * 100, "g13": 112.4e6, "theta": 136e6, "pressure": 50e3}
    found = (grainlab.analyze([packing] * 2)["z"], grainlab.probe([packing] * 2)["g13_pa"], grainlab.invert(**state)["z"])
    return [column.tolist() for column in found], len(packing._png("force", "60x60"))


def test_a_forked_child_measures_many_packings_as_its_parent_did(packing):
    here = measured(packing)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(measured, [packing, packing]).get(timeout=120) == [here, here]


def test_the_stress_is_that_of_the_contact_forces(packing):
    forces = packing.contact_normal_forces[:, None] * packing.contact_normals - packing.contact_tangential_forces
    stress = forces.T @ packing.contact_branches / np.linalg.det(packing.cell)
    assert np.allclose(packing.stress, (stress + stress.T) / 2, rtol=1e-12, atol=1e-9)
    assert packing.phase == 10 and packing.end_of_phase and np.allclose(np.trace(packing.stress) / 3, 5e4, rtol=1e-3)


def test_pictures_and_files_have_the_packing(packing, tmp_path):
    assert grainlab.view(packing, tmp_path / "p.png", color="force").read_bytes()[:4] == b"\x89PNG"
    assert "<iframe" in grainlab.view([packing])._repr_html_()
    for name in ("csv", "lammps", "lammps-data", "xyz", "vtk"):
        assert grainlab.export([packing], tmp_path / name, format=name), name
    (again,) = grainlab.load(tmp_path / "csv/packing_1.csv")
    assert again.contact_tangential_forces.tobytes() == packing.contact_tangential_forces.tobytes()
    with pytest.raises(grainlab.FileError, match="exists"):
        grainlab.export([packing], tmp_path / "csv", format="csv")
    with pytest.raises(ValueError, match="lammps-data"):
        grainlab.export([packing], tmp_path, format="stl")


def test_lists_and_numbers_of_other_types_are_read_and_one_radius_is_that_of_all():
    of_doubles = grainlab.Packing(np.eye(3), np.array([[0.0, 0, 0], [0, 0, 0.5]]), np.array([0.25, 0.25]))
    others = ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], np.eye(3, dtype=np.float32), np.eye(3, dtype=int))
    for cell, radii in zip(others, ([0.25, 0.25], np.float32(0.25), 0.25), strict=True):
        assert pickle.dumps(grainlab.Packing(cell, [[0, 0, 0], [0, 0, 0.5]], radii)) == pickle.dumps(of_doubles)


def test_fortran_order_and_strides_are_read_as_they_are(packing):
    flipped = np.asfortranarray(packing.positions)
    wide = np.zeros((len(packing), 6))
    wide[:, ::2] = packing.positions
    for positions in (flipped, wide[:, ::2]):
        assert np.array_equal(grainlab.Packing(packing.cell, positions, packing.radii).positions, packing.positions)
