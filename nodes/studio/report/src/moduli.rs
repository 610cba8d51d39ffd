//! Moduli of the last packing: relaxed, and by closed forms of its contact network.

use crate::run::Run;
use grainlab_core::Stiffness;
use grainlab_page::plot::{Axis, Bar, Bars, Figure, Line, Marker, Point, Series};
use grainlab_page::{Cell, Html, csv, figure, grid, paragraph, six_digits, table, three_digits};
use grainlab_results::brief::moduli;
use grainlab_results::read_back::InvertedPacking;

/// Pa to MPa.
const MPA: f64 = 1e-6;

/// Ratio of the largest pressure to the least from which moduli are drawn over it.
const WIDE: f64 = 1.2;

/// A stiffness as a reader knows it: name, colour, and its moduli in the order of [`NAMES`], MPa.
type Kind = (&'static str, usize, [f64; 6]);

const NAMES: [&str; 6] = ["G12", "G13", "Θ", "C11", "C33", "C13"];

impl Run {
    pub(crate) fn moduli(&self) -> Html {
        let Some(report) = self.last().map(|s| &s.packing.report) else {
            return paragraph("No packing was measured.");
        };
        let Some(stiffness) = report.stiffness() else {
            let why = report.elasticity.as_ref().err().map(ToString::to_string).unwrap_or_default();
            return paragraph(format!("No stiffness: {why}."));
        };
        let axis = &report.fabric.reference_axis;
        let all = |c: &Stiffness| {
            let t = c.transverse_isotropy_about(axis);
            [t.g12, t.g13, c.bulk_voigt(), t.c11, t.c33, t.c13].map(|v| v * MPA)
        };
        let kinds: [Kind; 3] = [
            ("relaxed", 0, all(&stiffness.tensor)),
            ("mean rotation", 2, all(&stiffness.bounds.uniform_rotation)),
            ("affine", 1, all(&stiffness.bounds.affine)),
        ];
        let bars = (0..NAMES.len()).flat_map(|n| {
            // That of a mean rotation is close to the affine one: the table has it.
            kinds.iter().filter(|k| k.0 != "mean rotation").map(move |(kind, colour, values)| Bar {
                name: NAMES[n].to_owned(),
                colour: *colour,
                value: values[n],
                text: format!("{} {kind}", three_digits(values[n], 1)),
            })
        });
        let plot = Bars { title: "Moduli, MPa".into(), bars: bars.collect() };
        let of = |n: usize| (NAMES[n], kinds.map(|k| k.2[n]));
        let data = csv(
            ["modulus", "relaxed_mpa", "mean_rotation_mpa", "affine_mpa"],
            (0..NAMES.len()).map(of).map(|(name, [relaxed, rotation, affine])| {
                [name.to_owned(), six_digits(relaxed), six_digits(rotation), six_digits(affine)]
            }),
        );
        let rows = (0..NAMES.len()).map(of).map(|(name, [relaxed, rotation, affine])| {
            let [r, m, a] = [relaxed, rotation, affine].map(|v| Cell::three_digits(v, 2));
            [Cell::text(name), r, m, a, Cell::fixed(relaxed / affine, 3)]
        });
        let caption = format!(
            "MPa, about the axis ({:.2}, {:.2}, {:.2}), by the {}",
            axis.x,
            axis.y,
            axis.z,
            stiffness.method.name().replace('_', " ")
        );
        let header = ["modulus", "relaxed", "mean rotation", "affine", "relaxed / affine"];
        let about = "G12 is the shear modulus across the axis, G13 along it, Θ the bulk modulus under isotropic strain.";
        grid(figure("moduli", plot.svg(), about, &data) + table(caption, header, rows) + self.over_pressure())
    }

    /// G12, G13 and Θ of the states over their pressure, if there are several; Hertzian packings are near a power of 1/3 of it.
    fn over_pressure(&self) -> Html {
        let of = |s: &InvertedPacking| {
            let report = &s.packing.report;
            let [g12, g13, theta] = moduli(report);
            Some((report.pressure() * 1e-3, [g12?, g13?, theta?]))
        };
        let states: Vec<_> = self.states.iter().filter_map(of).collect();
        let pressures = || states.iter().map(|s| s.0);
        if pressures().fold(0.0, f64::max) < WIDE * pressures().fold(f64::INFINITY, f64::min) {
            return Html::default();
        }
        let series = |n: usize| Series {
            name: NAMES[n].to_owned(),
            colour: Some(n),
            marker: Some(Marker::Circle),
            line: Some(Line::Faint),
            points: states.iter().map(|(p, of)| Point::at(*p, of[n])).collect(),
            ..Series::default()
        };
        let drawn = Figure {
            title: "Moduli over pressure, MPa".to_owned(),
            x: Axis::log("pressure, kPa"),
            y: Axis::log(""),
            series: (0..3).map(series).collect(),
            ..Figure::default()
        };
        let rows = states.iter().map(|(p, [a, b, c])| [*p, *a, *b, *c].map(six_digits));
        let data = csv(["pressure_kpa", "g12_mpa", "g13_mpa", "theta_mpa"], rows);
        figure(
            "moduli-over-pressure",
            drawn.element(),
            "One point for each state at the end of a phase, in their order.",
            &data,
        )
    }
}
