//! Time against error as SVG: a colour a method, hollow what is only stated.

use super::args::Method;
use super::report::Report;
use crate::plot::{AXES, Axis, COLOURS, axes, begin, circle, text};
use clap::ValueEnum;

/// The plot; each point says in its title what it is.
pub(super) fn svg(report: &Report) -> String {
    let drawn: Vec<_> = report.rows.iter().filter_map(|r| Some((r, r.error.rms?, r.error.stated?))).collect();
    let x = Axis::horizontal(drawn.iter().map(|(r, ..)| r.seconds));
    let y = Axis::vertical(drawn.iter().flat_map(|(_, rms, stated)| [*rms, *stated]));
    let mut svg = begin(
        "Wave speeds of a packing: CPU time against error",
        "error of rho v^2 against the frozen network: found, root mean square (full), and stated (hollow)",
    );
    axes(&mut svg, (&x, "CPU time of all speeds, s"), (&y, "relative error of rho v^2"));
    for (row, rms, stated) in &drawn {
        let colour = COLOURS[row.method as usize];
        let value = row.value.map_or(String::new(), |v| format!(" {v:e}"));
        let title = |what: &str, error: f64| {
            format!(
                "{}{value}, {} speeds: {:.2} s, {what} {error:.1e}",
                row.method.name(),
                row.speeds,
                row.seconds
            )
        };
        circle(&mut svg, [x.at(row.seconds), y.at(*stated)], (colour, "white"), &title("stated", *stated));
        circle(&mut svg, [x.at(row.seconds), y.at(*rms)], (colour, colour), &title("found", *rms));
    }
    let mut at = AXES[2] + 10.0;
    for method in Method::value_variants().iter().filter(|m| drawn.iter().any(|(r, ..)| r.method == **m)) {
        let colour = COLOURS[*method as usize];
        circle(&mut svg, [AXES[1] + 36.0, at - 4.0], (colour, colour), "");
        text(&mut svg, AXES[1] + 50.0, at, "start", "", method.name());
        at += 20.0;
    }
    svg + "</svg>\n"
}
