"""Tables in and out of the inversion."""

import json

import grainlab
import numpy as np
import pytest

STATE = {"g12": 104.2e6, "g13": 112.4e6, "theta": 136e6, "pressure": 50e3}
TABLE = {"g12_pa": [104.2e6, 110e6], "g13_pa": [112.4e6, 115e6], "theta_pa": [136e6, 140e6], "pressure_pa": 50e3}


def test_a_row_of_an_array_has_the_numbers_of_the_state_alone():
    scale = np.linspace(0.95, 1.05, 7)
    given = {**STATE, "g12": STATE["g12"] * scale, "phi": 0.63}
    found = grainlab.invert(**given)
    assert found["z"].shape == (7,) and set(found["status"]) <= {"ok", "extrapolated", "contradictory"}
    for n, value in enumerate(given["g12"]):
        alone = grainlab.invert(**{**given, "g12": value})
        assert (alone["z"], alone["z_sigma"], alone["z_interval"]) == (found["z"][n], found["z_sigma"][n], (found["z_low"][n], found["z_high"][n]))


def test_a_state_without_errors_has_the_numbers_of_the_command_line():
    found = grainlab.invert(**STATE)
    words = [f"--{name}={value}" for name, value in STATE.items()]
    (answer,) = json.loads(grainlab.command("invert", *words, "--model=relaxed", "--format=json"))["results"]
    assert (found["z"], found["z_sigma"], found["warnings"]) == (answer["z"], answer["sigma"]["z"], answer["warnings"])
    assert any("the errors of the moduli are not known" in text for text in found["warnings"])


def test_a_row_without_an_answer_is_nan_with_its_reason():
    found = grainlab.invert(**{**STATE, "pressure": [50e3, np.nan, -1, np.inf, 50e3], "g12": [104.2e6, 1e8, 1e8, 1e8, 0]})
    assert list(found["status"]) == ["ok"] + 4 * ["unknown"] and np.isnan(found["z"][1:]).all()
    assert all(found["reason"]) and "pressure_pa is empty" in found["reason"][1]


def test_whole_numbers_of_a_table_stay_whole():
    from grainlab.tables import parsed

    found = parsed("seed,step,k,contacts,mixed\n9007199254740993,12,4.5,3,1\n-2,13,5,,x\n")
    assert found["seed"].tolist() == [9007199254740993, -2] and found["step"].dtype.kind == "i"
    assert found["k"].dtype.kind == "f" and np.isnan(found["contacts"][1]) and list(found["mixed"]) == ["1", "x"]


def test_what_a_mask_hides_is_not_known():
    hidden, unknown = np.ma.array([104.2e6, 105e6], mask=[0, 1]), [104.2e6, np.nan]
    for given in (lambda g12: {**STATE, "g12": g12}, lambda g12: {"table": {**TABLE, "g12_pa": g12}}):
        assert np.array_equal(grainlab.invert(**given(hidden))["z"], grainlab.invert(**given(unknown))["z"], equal_nan=True)
    assert grainlab.invert(**STATE, phi=np.ma.masked)["z"] == grainlab.invert(**STATE)["z"]


def test_series_with_different_indexes_are_refused():
    pandas = pytest.importorskip("pandas")
    one, other = pandas.Series([1e8, 1.1e8], index=[0, 1]), pandas.Series([1.1e8, 1.2e8], index=[1, 0])
    for given, names in (
        ({**STATE, "g12": one, "g13": other}, "g12 and g13"),
        ({"table": {**TABLE, "g12_pa": one, "g13_pa": other}}, "g12_pa and g13_pa"),
        ({"table": pandas.DataFrame(TABLE, index=["a", "b"]), "phi": one}, "table and phi"),
    ):
        with pytest.raises(ValueError, match=f"{names} have different indexes"):
            grainlab.invert(**given)
    assert grainlab.invert(**{**STATE, "g12": one, "g13": one})["z"].shape == (2,)


def test_a_packing_names_its_sample_once_with_a_whole_step(packing):
    found = grainlab.invert(table=grainlab.analyze([packing]))
    assert list(found["sample"]) == [f"simulation of demo step {packing.step}"]


def test_errors_of_single_moduli_count():
    sticking = {**STATE, "probe": "sticking"}
    exact = grainlab.invert(**sticking)["z_sigma"]
    assert grainlab.invert(**sticking, g12_sigma=2e7, g13_sigma=2e7, theta_sigma=3e7)["z_sigma"] > 1.5 * exact
    with pytest.raises(ValueError, match="g12_sigma_pa is a standard deviation of a quantity that is not there"):
        grainlab.invert(g13=1e8, pressure=5e4, g12_sigma=1e6)


def test_a_data_frame_gives_one_with_its_index():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(TABLE, index=["a", "b"]).astype({"g12_pa": "object"})
    found = grainlab.invert(table=frame)
    assert list(found.index) == ["a", "b"] and (found.z == grainlab.invert(table=TABLE)["z"]).all()
    frame["g13_pa"] = pandas.array([112.4e6, None], dtype="Float64")
    assert grainlab.invert(table=frame).z.notna().all()


def test_a_table_is_columns_rows_or_a_file(tmp_path):
    rows = [{name: values if name == "pressure_pa" else values[n] for name, values in TABLE.items()} for n in (0, 1)]
    path = tmp_path / "t.csv"
    path.write_text(grainlab.tables.csv_text(grainlab.tables.columns(TABLE)))
    for table in (rows, path, str(path)):
        assert np.array_equal(grainlab.invert(table=table)["z"], grainlab.invert(table=TABLE)["z"])
    assert grainlab.invert(table={name: [] for name in TABLE})["z"].shape == (0,)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({**STATE, "g12": [1e8, 1e8], "g13": [1e8, 1e8, 1e8]}, "different lengths: g12_pa 2, g13_pa 3"),
        ({**STATE, "g12": [[1e8, 1e8]]}, r"shape \(1, 2\)"),
        ({**STATE, "g12": [[1e8], [1e8, 2]]}, "g12"),
        ({**STATE, "g12": 1e8 + 1j}, "one real number"),
        ({**STATE, "g12": "much"}, "much"),
        ({**STATE, "g12": float("nan"), "g13": None, "theta": None}, "."),
        ({"table": {**TABLE, "g12_sgima_pa": 1.0}}, "almost"),
        ({"table": {**TABLE, "sample": ["a\nb", "c"]}}, "one line"),
        ({"table": TABLE, "pressure": 1e5}, "column of the table"),
        ({"table": [1, 2]}, "row"),
        ({"table": 3}, "int"),
        ({"table": TABLE, "draws": 10}, "one state"),
        ({**STATE, "draws": 10, "seed": -1}, "seed is -1"),
        ({**STATE, "draws": 2.5}, "draws is 2.5"),
        ({**STATE, "error": 3}, "0 to 1"),
        ({**STATE, "calibration": "mine"}, "no calibration"),
    ],
)
def test_wrong_tables_are_refused_with_the_reason(given, words):
    with pytest.raises((ValueError, grainlab.PhysicsError), match=words):
        grainlab.invert(**given)


def test_numbers_as_integers_and_texts_are_numbers():
    as_text = {**STATE, "g12": np.array(["104.2e6"], dtype=object), "pressure": 50000}
    assert grainlab.invert(**as_text)["z"][0] == grainlab.invert(**STATE)["z"]
    named = grainlab.invert(**{**STATE, "g12": [1e8, 1e8]}, sample=["#1", "a,b"])
    assert list(named["sample"]) == ["#1", "a,b"]


def test_speeds_over_pressure_give_samples_and_a_plan_their_errors():
    speeds = [dict(pressure_pa=p, mode=m, speed=v) for p, m, v in ((1e5, "p", 420), (1e5, "s", 255), (1e6, "p", 740), (1e6, "s", 455))]
    (sample,) = grainlab.invert(speeds=speeds, density=1640, shear_modulus=44e9, poisson_ratio=0.08)
    assert sample["status"] == "ok" and len(sample["lines"]) == 4
    with pytest.raises(ValueError, match="density"):
        grainlab.invert(speeds=speeds, shear_modulus=44e9, poisson_ratio=0.08)
    with pytest.raises(ValueError, match="contact hertz takes one pressure: drop the column pressure_pa and give pressure, in Pa"):
        grainlab.invert(speeds=speeds, contact="hertz", density=1640, shear_modulus=44e9, poisson_ratio=0.08)
    plan = {"error": 0.01, "pressures": [1e5, 4e5], "speeds": [{"mode": "p", "angles": [0, 90]}, {"mode": "s"}]}
    assert grainlab.plan(plan, shear_modulus=29e9, poisson_ratio=0.2)["quantities"][0]["sigma"] > 0
