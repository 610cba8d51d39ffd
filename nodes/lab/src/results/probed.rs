//! A packing with its wave speeds, with the stable keys of `grainlab probe`.

use super::acoustic::{self, AcousticView};
use super::state::State;
use super::state_text;
use crate::commands::packings::printer::Printed;
use grainlab_console::{Table, exact};
use serde::Serialize;

/// What was measured on one packing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Probed {
    #[serde(flatten)]
    pub(crate) state: State,
    /// Null where nothing carries a wave.
    pub(crate) acoustic: Option<AcousticView>,
}

/// Columns of CSV. The moduli are those of the speeds, under the names that `grainlab invert --table` reads. The error of
/// Theta is not among them: Theta follows from the other moduli and is no measurement of its own.
const COLUMNS: [&str; 34] = [
    "source",
    "step",
    "method",
    "speeds",
    "grains",
    "phi",
    "pressure_pa",
    "density",
    "density_sigma",
    "density_bulk",
    "g12_pa",
    "g12_sigma_pa",
    "g13_pa",
    "g13_sigma_pa",
    "theta_pa",
    "ti_c11_pa",
    "c11_sigma_pa",
    "ti_c33_pa",
    "c33_sigma_pa",
    "ti_c13_pa",
    "c13_sigma_pa",
    "chi_square",
    "degrees_of_freedom",
    "scatter",
    "grain_shear_modulus_pa",
    "poisson",
    "k",
    "z",
    "eps",
    "eps_stiffness",
    "rattlers",
    "axis_x",
    "axis_y",
    "axis_z",
];

impl Printed for Probed {
    fn text(&self) -> String {
        let s = &self.state;
        let mut text = format!("{}, step {}\n{}", s.source, s.step, state_text::text(s));
        if let Some(a) = &self.acoustic {
            text += &acoustic::text(a, s);
        }
        text
    }

    fn table(results: &[Self]) -> Table {
        let mut t = Table::new(COLUMNS);
        results.iter().for_each(|r| t.row(r.cells()));
        t
    }
}

impl Probed {
    fn cells(&self) -> [String; COLUMNS.len()] {
        let (s, a) = (&self.state, self.acoustic.as_ref());
        let (m, sigma) = (a.map(|a| a.moduli).unwrap_or_default(), a.map(|a| a.sigma).unwrap_or_default());
        let count = |n: usize| n.to_string();
        let axis = a.map(|a| a.moduli_axis);
        // A table has no way to say that Theta follows from moduli of which one is missing.
        let whole = [m.g13_pa, m.g12_pa, m.c11_pa, m.c33_pa, m.c13_pa].iter().all(Option::is_some);
        [
            s.source.clone(),
            s.step.to_string(),
            a.and_then(|a| a.method).unwrap_or_default().to_owned(),
            a.map_or_else(String::new, |a| count(a.speeds.len())),
            s.grains.to_string(),
            exact(Some(s.phi)),
            exact(Some(s.pressure_pa)),
            exact(a.map(|a| a.density)),
            exact(a.and_then(|a| a.density_stddev)),
            exact(a.map(|a| a.density_bulk)),
            exact(m.g12_pa),
            exact(sigma.g12_pa),
            exact(m.g13_pa),
            exact(sigma.g13_pa),
            exact(m.theta_pa.filter(|_| whole)),
            exact(m.c11_pa),
            exact(sigma.c11_pa),
            exact(m.c33_pa),
            exact(sigma.c33_pa),
            exact(m.c13_pa),
            exact(sigma.c13_pa),
            exact(a.and_then(|a| a.chi_square)),
            a.and_then(|a| a.degrees_of_freedom).map_or_else(String::new, count),
            exact(a.and_then(|a| a.scatter)),
            exact(Some(s.grain_shear_modulus_pa)),
            exact(Some(s.poisson)),
            exact(Some(s.k)),
            exact(Some(s.z)),
            exact(Some(s.eps)),
            exact(s.eps_stiffness),
            s.rattlers.to_string(),
            exact(axis.map(|v| v[0])),
            exact(axis.map(|v| v[1])),
            exact(axis.map(|v| v[2])),
        ]
    }
}
