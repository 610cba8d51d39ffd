#!/usr/bin/env python3
"""compare_engines.py FIRST.csv SECOND.csv: packings of two engines, from `grainlab analyze RUN... --format csv`, state by state.

Prints the difference of the means over their standard error for each quantity and state, and the smallest p of all (Welch's t test) after
Holm's correction. Exit code 1 if it is below .05, or a difference is beyond 4 standard errors."""
import sys

import numpy as np
import pandas as pd
from scipy import stats

QUANTITIES = ["z", "eps", "phi", "g_total", "g12_pa", "g13_pa", "theta_pa"]
first, second = (pd.read_csv(path) for path in sys.argv[1:])
first, second = (table[QUANTITIES + ["pressure_pa"]].assign(state=table["pressure_pa"].round(-3)) for table in (first, second))
rows = []
for state in sorted(first["state"].unique()):
    for quantity in QUANTITIES:
        a, b = (table.loc[table["state"] == state, quantity].to_numpy(float) for table in (first, second))
        test = stats.ttest_ind(a, b, equal_var=False)
        rows.append([state, quantity, a.mean(), b.mean(), -test.statistic, test.pvalue, len(a), len(b)])
p = np.array([row[5] for row in rows])
order = np.argsort(p)
holm = np.maximum.accumulate(p[order] * np.arange(len(p), 0, -1)).clip(max=1.0)
adjusted = np.empty_like(p)
adjusted[order] = holm
print(f"{'p/kPa':>6} {'quantity':16} {'first':>11} {'second':>11} {'diff/se':>8} {'p':>6} {'Holm':>6}")
for (state, quantity, a, b, t, own, *counts), corrected in zip(rows, adjusted):
    print(f"{state / 1e3:6.0f} {quantity:16} {a:11.5g} {b:11.5g} {t:8.2f} {own:6.3f} {corrected:6.3f}")
worst = max(abs(row[4]) for row in rows)
print(f"{len(rows)} comparisons of {counts[0]} and {counts[1]} packings: smallest p {adjusted.min():.3f}, largest difference {worst:.1f} standard errors")
sys.exit(int(adjusted.min() < 0.05 or worst > 4.0))
