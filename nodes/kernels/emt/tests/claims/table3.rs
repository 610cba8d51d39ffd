//! The sixteen states of the paper's Table III, with the moduli that its k, k̂ and ε imply.

use grainlab_core::results::Microstructure;
use grainlab_emt::{Observation, StrainRatio};

/// One state of the table.
pub(crate) struct Row {
    /// Sample and pressure, for messages.
    pub(crate) label: String,
    /// γ/Δ of Table II.
    pub(crate) g: f64,
    /// k, k̂ and ε of Table III.
    pub(crate) printed: [f64; 3],
    /// Confining pressure, Pa.
    pub(crate) g12: f64,
    pressure: f64,
    g13: f64,
    theta: f64,
    theta_printed: f64,
}

impl Row {
    /// The moduli that imply this row under Eq. 16 corrected.
    pub(crate) fn observation(&self) -> Observation {
        self.with_theta(self.theta)
    }

    /// The moduli that imply this row under Eq. 16 as it is printed.
    pub(crate) fn observation_as_printed(&self) -> Observation {
        self.with_theta(self.theta_printed)
    }

    /// The values of Table III.
    pub(crate) fn structure(&self) -> Microstructure {
        let [k, k_hat, eps] = self.printed;
        Microstructure::paper(k, k_hat, eps)
    }

    fn with_theta(&self, theta: f64) -> Observation {
        Observation::from_g12_g13_theta(self.g12, self.g13, theta, self.pressure, StrainRatio::given(self.g))
    }
}

/// All of them, in the order of the table.
pub(crate) fn rows() -> Vec<Row> {
    include_str!("../../../../../tests/golden/table3.csv").lines().skip(1).map(row).collect()
}

fn row(line: &str) -> Row {
    let (sample, numbers) = line.split_once(',').unwrap();
    let v: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
    let [p_kpa, g, g12, g13, theta, theta_printed, k, k_hat, eps] = v[..] else { panic!("{line}") };
    Row {
        label: format!("{sample} at {p_kpa} kPa"),
        g,
        printed: [k, k_hat, eps],
        pressure: 1.0e3 * p_kpa,
        g12,
        g13,
        theta,
        theta_printed,
    }
}
