"""Priors, and draws from the posterior."""

import sys

import numpy as np
import pytest

import grainlab

STATE = dict(
    g12=74.224e6, g13=81.816e6, theta=136.988e6, pressure=50e3, stress_ratio=0, size_spread=0, shear_modulus=35.3e9,
    poisson_ratio=0.212,
)


def test_draws_have_the_moments_of_the_estimate_and_a_seed_repeats_them():
    found = grainlab.invert(**STATE, error=0.01, draws=500, seed=3)
    draws = found["draws"]
    for key in ["k", "z", "eps", "eps_stiffness"]:
        values = draws["posterior"][key]
        assert values.shape == (4, 500)
        assert abs(values.mean() - found[key]) < 0.3 * found[f"{key}_sigma"]
    assert draws["coords"]["modulus"] == ["G12", "G13", "Theta"]
    assert draws["log_likelihood"]["moduli"].shape == draws["posterior_predictive"]["moduli"].shape == (4, 500, 3)
    again = grainlab.invert(**STATE, error=0.01, draws=500, seed=3)["draws"]
    assert np.array_equal(again["posterior"]["z"], draws["posterior"]["z"])


def test_draws_that_scatter_otherwise_than_the_estimate_are_a_warning():
    one = dict(g12=104.2e6, pressure=50e3, probe="sticking", error=0.01)
    found = grainlab.invert(**one, draws=500)
    scatter, stated = found["draws"]["posterior"]["z"].std(), found["z_sigma"]
    assert not 1 / 1.15 < scatter / stated < 1.15
    (said,) = [text for text in found["warnings"] if text.startswith("the draws of z ")]
    assert f"scatter by {scatter:.4f}, and the estimate states {stated:.4f}: the posterior is not normal" in said
    assert not any("draws" in text for text in grainlab.invert(**one)["warnings"])


def test_a_narrow_prior_is_the_estimate_and_wrong_ones_raise():
    prior = '[z]\ndistribution = "normal"\nmean = 4.8\nstddev = 1e-6\n'
    assert abs(grainlab.invert(**STATE, error=0.01, prior=prior)["z"] - 4.8) < 1e-5
    for text, match in [
        ("[z]\n", "distribution"),
        ('[z]\ndistribution = "uniform"\nlow = 8\nhigh = 9\n', "domain"),
        ('[k_hat]\ndistribution = "uniform"\nlow = 4\nhigh = 5\n', "no model infers"),
    ]:
        with pytest.raises(ValueError, match=match):
            grainlab.invert(**STATE, prior=text)


def test_draws_are_read_by_the_arviz_that_is_there():
    found = grainlab.invert(**STATE, draws=50)
    data = pytest.importorskip("arviz") and grainlab.to_arviz(found["draws"])
    assert data["posterior"]["z"].shape == (4, 50)
    assert data["posterior_predictive"]["moduli"].dims == ("chain", "draw", "modulus")
    assert list(data["observed_data"]["modulus"].values) == ["G12", "G13", "Theta"]


def test_draws_are_read_by_the_base_of_arviz_1(monkeypatch):
    pytest.importorskip("arviz_base")
    monkeypatch.setitem(sys.modules, "arviz", None)
    data = grainlab.to_arviz(grainlab.invert(**STATE, draws=50)["draws"])
    assert data["posterior"]["eps"].shape == (4, 50) and data["log_likelihood"]["moduli"].dims[2] == "modulus"
