//! The path of a run through stresses and strains.

use grainlab_page::plot::{Axis, Figure, Line, Point, Series};
use grainlab_page::{Html, csv, figure, grid, six_digits};

/// Most points of the path; beyond, every second one is left out.
const MOST: usize = 4096;

/// The phase, and pressure, Pa, deviator, Pa, and logarithmic strain zz, at exchanges that are equally many apart.
#[derive(Debug, Default)]
pub(crate) struct StressPath {
    points: Vec<(u32, [f64; 3])>,
    seen: usize,
    /// Exponent of 2: of how many exchanges one is kept.
    thinned: u32,
}

impl StressPath {
    pub(crate) fn push(&mut self, phase: u32, of: [f64; 3]) {
        if self.seen.is_multiple_of(1 << self.thinned) {
            self.points.push((phase, of));
        }
        self.seen += 1;
        if self.points.len() > MOST {
            self.points = self.points.drain(..).step_by(2).collect();
            self.thinned += 1;
        }
    }

    /// Deviator over pressure, and over strain, from a phase on: the first one after the reference state.
    pub(crate) fn figures(&self, from: u32) -> Html {
        let kept: Vec<[f64; 3]> = self.points.iter().filter(|(n, _)| *n >= from).map(|(_, v)| *v).collect();
        if kept.len() < 2 {
            return Html::default();
        }
        let labels = ["pressure p, kPa", "axial strain, % (positive in extension)"];
        let titles = ["Deviator q over pressure, kPa", "Deviator q over strain, kPa"];
        let drawn: Vec<_> = kept.iter().map(|[p, q, zz]| [p * 1e-3, zz * 100.0, q * 1e-3]).collect();
        let over = |n: usize| Figure {
            title: titles[n].to_owned(),
            x: Axis::linear(labels[n]),
            series: vec![Series {
                colour: Some(0),
                line: Some(Line::Straight),
                points: drawn.iter().map(|v| Point::at(v[n], v[2])).collect(),
                ..Series::default()
            }],
            ..Figure::default()
        };
        let rows = kept.iter().map(|v| v.map(six_digits));
        let data = csv(["pressure_pa", "deviator_pa", "strain_zz"], rows);
        let about = "From the reference state on, if a phase sets one, in the order of the exchanges.";
        grid(
            figure("stress-path", over(0).element(), about, &data)
                + figure("stress-strain", over(1).element(), about, &data),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_of_any_length_is_kept_in_equal_steps_from_its_start() {
        let mut path = StressPath::default();
        (0..100_000).for_each(|n| path.push(1, [f64::from(n), 0.0, 0.0]));
        let steps = path.points.windows(2).map(|w| w[1].1[0] - w[0].1[0]);
        assert!(path.points.len() > MOST / 2 && path.points.len() <= MOST);
        assert!(path.points[0].1[0] == 0.0 && steps.into_iter().all(|s| s == 32.0));
    }
}
