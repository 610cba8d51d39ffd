#!/usr/bin/env python3
"""Shear modulus of rough packings over pressure, as .github/images/rough.svg, from tests/golden/ensembles/contacts.csv.

   python3 tests/tools/rough_figure.py
"""
import csv
import math
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
COLOURS = ["#0068b4", "#d95f02", "#1b9e77", "#7570b3", "#444444"]
X, Y, WIDTH, HEIGHT = (1e4, 2e7), (1e7, 2e9), 560, 380


def shear(row):
    c11, c33, c13, g12, g13 = (float(row[k]) for k in ("ti_c11_pa", "ti_c33_pa", "ti_c13_pa", "g12_pa", "g13_pa"))
    bulk = c33 + 2 * c13 + 2 * (2 * c11 - 2 * g12 + c13)
    return (3 * (c33 + 2 * g13 + 2 * (c11 + g12 + g13)) - bulk) / 30


def place(pressure, modulus):
    share = lambda value, ends: math.log(value / ends[0]) / math.log(ends[1] / ends[0])
    return 70 + share(pressure, X) * WIDTH, 20 + (1 - share(modulus, Y)) * HEIGHT


points = {}
for row in csv.DictReader(open(TOP / "tests/golden/ensembles/contacts.csv")):
    if int(row["member"]) > 100 and row["preparation"] == "lubricated":
        of = points.setdefault(float(row["roughness"]), {})
        of.setdefault(round(math.log(float(row["pressure_pa"]))), []).append((float(row["pressure_pa"]), shear(row)))
text = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 460" font-family="sans-serif" font-size="13">',
        '<rect width="760" height="460" fill="#ffffff"/>',
        f'<rect x="70" y="20" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888888"/>']
for pressure, name in ((1e4, "10 kPa"), (1e5, "100 kPa"), (1e6, "1 MPa"), (1e7, "10 MPa")):
    text.append(f'<text x="{place(pressure, Y[0])[0]:.0f}" y="420" text-anchor="middle">{name}</text>')
for modulus, name in ((1e7, "10"), (1e8, "100"), (1e9, "1000")):
    text.append(f'<text x="62" y="{place(X[0], modulus)[1] + 5:.0f}" text-anchor="end">{name}</text>')
text.append('<text x="350" y="446" text-anchor="middle">confining pressure</text>')
text.append('<text transform="rotate(-90 20 210)" x="20" y="210" text-anchor="middle">shear modulus, MPa</text>')
for exponent, start, name in ((1 / 2, 1.2e7, "p^½"), (1 / 3, 1.35e8, "p^⅓")):
    ends = [place(p, start * (p / 1e4) ** exponent) for p in (1e4, 1e6 if exponent > 0.4 else 2e7)]
    text.append(f'<polyline fill="none" stroke="#888888" stroke-dasharray="5 4" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in ends)}"/>')
    text.append(f'<text x="{ends[1][0] - 30:.0f}" y="{ends[1][1] - 8:.0f}" fill="#555555">{name}</text>')
for colour, (roughness, of) in zip(COLOURS, sorted(points.items())):
    mean = [[sum(v[i] for v in all_) / len(all_) for i in (0, 1)] for _, all_ in sorted(of.items())]
    at = [place(p, g) for p, g in mean]
    text.append(f'<polyline fill="none" stroke="{colour}" stroke-width="2" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in at)}"/>')
    text.append("".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>' for x, y in at))
    text.append(f'<text x="640" y="{100 + 22 * len(text) // 4:.0f}" fill="{colour}">{roughness * 1e9:.0f} nm</text>')
(TOP / ".github/images/rough.svg").write_text("\n".join(text + ["</svg>"]) + "\n")
