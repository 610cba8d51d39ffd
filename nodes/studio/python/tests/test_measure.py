import threading
import time

import grainlab
import numpy as np
import pytest


def test_the_stiffness_is_that_of_analyze_symmetric_and_below_the_affine_one(golden):
    c, report = grainlab.stiffness(golden), grainlab.analyze(golden)
    assert np.allclose(c, report["stiffness_pa"], rtol=1e-12)
    assert np.allclose(c, c.T, rtol=1e-8)
    affine = grainlab.stiffness(golden, affine=True)
    assert np.linalg.eigvalsh(affine - c).min() > 0


def test_a_packing_without_friction_has_the_moduli_of_normal_springs_to_the_last_digit(smooth):
    assert smooth.friction == 0
    carried, normal = (grainlab.analyze(smooth, springs=springs) for springs in ("carried", "normal"))
    assert [carried[key] for key in ("g12_pa", "theta_pa")] == [normal[key] for key in ("g12_pa", "theta_pa")]
    assert (grainlab.stiffness(smooth) == carried["stiffness_pa"]).all()
    assert carried["g12_pa"] < 0.8 * grainlab.analyze(smooth, springs="both")["g12_pa"]


def test_every_key_of_analyze_has_symbol_unit_and_meaning(golden):
    assert set(grainlab.analyze(golden)) == set(grainlab.quantities())
    assert grainlab.quantities()["phi"][:2] == ("φ", "1")


def test_the_fabric_is_that_of_the_contact_normals(golden):
    n = golden.contact_normals
    tensor = n.T @ n / len(n)
    xx, yy, zz, yz, xz, xy = grainlab.analyze(golden)["fabric"]
    assert np.allclose([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[1, 2], tensor[0, 2], tensor[0, 1]],
                       [xx, yy, zz, yz, xz, xy], atol=1e-12)


def test_the_inversion_of_measured_moduli_finds_the_coordination(golden):
    r = grainlab.analyze(golden)
    found = grainlab.invert(g12=r["g12_pa"], g13=r["g13_pa"], theta=r["theta_pa"], pressure=r["pressure_pa"], phi=r["phi"])
    low, high = found["z_interval"]
    assert low < r["z"] < high and abs(found["z"] - r["z"]) < 0.1
    assert found["model"] == "relaxed" and found["z_sigma"] > 0
    assert found["status"] in ("ok", "extrapolated", "contradictory")


def test_stated_errors_of_the_state_widen_the_answer(golden):
    r = grainlab.analyze(golden)
    given = dict(g12=r["g12_pa"], g13=r["g13_pa"], theta=r["theta_pa"], pressure=r["pressure_pa"], stress_ratio=0.0, size_spread=0.0, probe="sticking", error=0.01)
    exact = grainlab.invert(**given)["k_sigma"]
    assert grainlab.invert(**given, pressure_sigma=0.1 * r["pressure_pa"])["k_sigma"] > 1.05 * exact
    assert grainlab.invert(**given, shear_modulus_sigma=3e9)["k_sigma"] > 1.05 * exact
    unknown = grainlab.invert(**{**given, "probe": "unknown"})
    assert unknown["k_sigma"] > 3 * exact and any("contacts may have slid" in text for text in unknown["warnings"])
    with pytest.raises(ValueError, match="give sticking if no contact slid"):
        grainlab.invert(**{**given, "probe": "stuck"})
    with pytest.raises(ValueError, match="standard deviation of a quantity that is not there"):
        grainlab.invert(pressure=1e5, g12=1e8, stress_ratio_sigma=0.1)


def test_wrong_input_raises(golden):
    with pytest.raises(ValueError, match="carried, both, normal"):
        grainlab.stiffness(golden, springs="magic")
    for axis in ((0, 0, 0), "x", (0, 1), (0, 0, float("nan"))):
        with pytest.raises(ValueError, match="axis"):
            grainlab.analyze(golden, axis=axis)
    for call in (lambda **given: grainlab.analyze([golden], **given), lambda **given: grainlab.stiffness(golden, **given)):
        for tolerance in (1, float("nan")):
            with pytest.raises(ValueError, match="tolerance"):
                call(tolerance=tolerance)
        with pytest.raises(TypeError, match="tolerance"):
            call(tolerance="fine")
    with pytest.raises(ValueError, match="no model"):
        grainlab.invert(pressure=1e5, g12=1e8, g13=1e8, theta=1e8, model="none")
    with pytest.raises(ValueError, match="pressure"):
        grainlab.invert(pressure=-1e5, g12=1e8, g13=1e8, theta=1e8)
    with pytest.raises(ValueError, match="no column of a modulus"):
        grainlab.invert(pressure=1e5)
    with pytest.raises(grainlab.PhysicsError):
        grainlab.invert(pressure=1e5, g12=1e8, g13=1e8, theta=1e6, phi=0.64)
    with pytest.raises(TypeError, match="presure"):
        grainlab.invert(presure=1e5, g12=1e8)
    alone = grainlab.Packing(np.eye(3), np.zeros((1, 3)), np.array([0.1]))
    with pytest.raises(grainlab.PhysicsError):
        grainlab.stiffness(alone)
    assert grainlab.analyze(alone)["stiffness_pa"] is None


def test_packings_are_measured_as_columns_and_one_without_an_answer_is_named(golden, smooth):
    alone = grainlab.Packing(np.eye(3), np.zeros((1, 3)), np.array([0.1]))
    found = grainlab.analyze([golden, alone, smooth])
    assert list(found["status"]) == ["ok", "unknown", "ok"] and "touches" in found["reason"][1]
    assert np.isnan(found["g12_pa"][1]) and found["g12_pa"][0] == grainlab.analyze(golden)["g12_pa"]
    assert grainlab.analyze([])["z"].shape == (0,)
    with pytest.raises(TypeError, match="packings are needed, or the path of a file, not int"):
        grainlab.analyze([1])


def test_the_speeds_of_waves_give_the_moduli_of_the_network(golden):
    found = grainlab.probe(golden)["acoustic"]
    assert abs(found["g13_pa"] / grainlab.analyze(golden)["g13_pa"] - 1) < 0.01
    columns = grainlab.probe([golden], speed_noise=0.003, seed=2)
    assert columns["g13_pa"] != found["g13_pa"] and list(columns["status"]) == ["ok"]
    with pytest.raises(ValueError, match="no parameter foo"):
        grainlab.probe(golden, foo=1)


def test_other_threads_run_during_a_computation(golden):
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.perf_counter()
    for _ in range(10):
        grainlab.stiffness(golden)
    ended = time.perf_counter()
    done.set()
    thread.join()
    # With the lock held, a tick would fall between two computations only: at most eleven.
    assert sum(began < t < ended for t in ticks) > 20


def test_a_packing_that_is_not_at_rest_is_measured_with_a_warning(golden):
    velocities = np.zeros(golden.positions.shape)
    velocities[0, 0] = 10.0
    moving = grainlab.Packing(golden.cell, golden.positions, golden.radii, velocities=velocities)
    with pytest.warns(UserWarning, match="not at rest"):
        grainlab.analyze(moving)


def test_what_contradicts_or_is_not_jammed_is_a_warning(golden):
    contradictory = dict(g12=104.2e6, g13=112.4e6, theta=136e6, pressure=50e3, stress_ratio=0, size_spread=0, poisson_ratio=0.5)
    with pytest.warns(UserWarning, match="the estimate is contradictory: the moduli contradict each other or the model: chi-square"):
        assert grainlab.invert(**contradictory)["status"] == "contradictory"
    with pytest.warns(UserWarning, match="contact"):
        assert grainlab.analyze(grainlab.Packing(golden.cell, golden.positions, 0.5 * golden.radii))["theta_pa"] is None
