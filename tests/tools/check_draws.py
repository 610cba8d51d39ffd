"""Reads draws of `grainlab invert --draws` with ArviZ, corner and pandas, and compares them with the estimate.

usage: check_draws.py DRAWS.json DRAWS.csv ESTIMATE.json    the draws twice, and the output of --format json
"""

import json
import sys
import warnings

import matplotlib

matplotlib.use("Agg")
warnings.simplefilter("ignore")

import arviz
import corner
import numpy as np
import pandas

draws = arviz.from_json(sys.argv[1])
table = pandas.read_csv(sys.argv[2])
estimate = json.load(open(sys.argv[3], encoding="utf8"))["results"][0]

names = ["z", "eps", "eps_stiffness", "k"]
summary = arviz.summary(draws, var_names=names, round_to="none")
count = draws.posterior.sizes["chain"] * draws.posterior.sizes["draw"]
for name in names:
    row, sigma = summary.loc[name], estimate["sigma"][name]
    # The estimate is a linear propagation; draws have the shape of the posterior.
    assert abs(row["mean"] - estimate[name]) < 0.25 * sigma, (name, row["mean"], estimate[name])
    assert 0.8 < row["sd"] / sigma < 1.15, (name, row["sd"], sigma)
    # Independent draws.
    assert row["r_hat"] < 1.01 and row["ess_bulk"] > 0.8 * count, (name, row)
    print(f"{name}: {row['mean']:.4f} +- {row['sd']:.4f}, estimate {estimate[name]:.4f} +- {sigma:.4f}")

left_out = arviz.loo(draws, pointwise=True)
moduli = [str(m) for m in draws.observed_data.modulus.values]
assert left_out.n_data_points == len(moduli) and np.isfinite(left_out.elpd_loo), left_out
# Leaving a modulus out cannot make the others predict it better than all of them do.
assert left_out.p_loo > 0 and left_out.pareto_k.max() < 0.7, left_out
pit = arviz.loo_pit(idata=draws, y="moduli")
assert ((pit > 0) & (pit < 1)).all(), pit

predicted = draws.posterior_predictive.moduli
assert predicted.dims == ("chain", "draw", "modulus")
figure = corner.corner(draws, var_names=names)
assert len(figure.axes) == len(names) ** 2

assert len(table) == count
for name in names:
    assert np.array_equal(table[name], draws.posterior[name].values.ravel()), name
for i, modulus in enumerate(moduli):
    column = f"predicted_{modulus.lower()}_pa"
    assert np.array_equal(table[column], predicted.values[..., i].ravel()), column
log_posterior = table["log_likelihood"] + table["log_prior"]
assert np.allclose(log_posterior, draws.sample_stats["lp"].values.ravel(), rtol=0, atol=1e-12)
print(f"elpd_loo {left_out.elpd_loo:.3f}, p_loo {left_out.p_loo:.3f}, {count} draws")
