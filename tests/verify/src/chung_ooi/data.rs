//! The tables of `data/chung_ooi.toml`.

use crate::lammps_pairs::material;
use grainlab_core::Material;
use serde::Deserialize;

/// The name of the suite.
pub const NAME: &str = "chung-ooi";

pub(super) const PAPER: &str = "Chung & Ooi, Granular Matter 13, 643 (2011)";

/// Source of the tolerance of a digitised curve.
pub(super) const KRATOS: &str = "the bound of Kratos's own test for this curve";

/// Source of the tolerance of measured points and of finite elements, which Kratos does not judge.
pub(super) const AS_CURVES: &str = "the bound of Kratos's own test for the curves of the paper";

/// Abscissa and ordinate of a curve.
pub(super) type Curve = Vec<[f64; 2]>;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Data {
    pub(super) elastic: Vec<Elastic>,
    pub(super) restitution: Vec<Solid>,
    pub(super) oblique: Vec<Oblique>,
    pub(super) measured: Measured,
    pub(super) microscopic: Vec<Microscopic>,
    pub(super) finite_elements: FiniteElements,
    pub(super) spinning: Vec<Spinning>,
    pub(super) counter_spinning: CounterSpinning,
}

/// Material of a sphere.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Solid {
    #[serde(rename = "material")]
    pub(super) name: String,
    /// Young's modulus, Pa.
    pub(super) young: f64,
    pub(super) poisson: f64,
    /// Density of the material, kg/m³.
    pub(super) density: f64,
}

/// Tests 1 and 2.
#[derive(Deserialize)]
pub(super) struct Elastic {
    pub(super) test: u32,
    #[serde(flatten)]
    pub(super) solid: Solid,
    /// Overlap, µm, and force, kN.
    #[serde(default)]
    pub(super) path: Curve,
}

/// Curves of test 4.
#[derive(Deserialize)]
pub(super) struct Oblique {
    #[serde(flatten)]
    pub(super) solid: Solid,
    /// Degrees from the normal.
    pub(super) angles: Vec<f64>,
    pub(super) tangential_restitution: Vec<f64>,
    /// Spin after, rad/s.
    #[serde(default)]
    pub(super) spin: Vec<f64>,
    /// Degrees, of the surface.
    #[serde(default)]
    pub(super) rebound_angle: Vec<f64>,
}

/// The experiment compared with test 4.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Measured {
    pub(super) tangential_restitution: Curve,
    pub(super) spin: Curve,
}

/// Curves of test 5.
#[derive(Deserialize)]
pub(super) struct Microscopic {
    #[serde(flatten)]
    pub(super) solid: Solid,
    pub(super) surface: Curve,
    pub(super) spin: Curve,
}

/// The steel sphere of test 5 by finite elements.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiniteElements {
    pub(super) surface: Curve,
    pub(super) spin: Curve,
}

/// Tests 6 and 8.
#[derive(Deserialize)]
pub(super) struct Spinning {
    pub(super) test: u32,
    #[serde(flatten)]
    pub(super) solid: Solid,
    /// Radius of what it meets over its own.
    pub(super) ratio: f64,
    pub(super) beta: Curve,
}

/// Spins of test 7.
#[derive(Deserialize)]
pub(super) struct CounterSpinning {
    #[serde(flatten)]
    pub(super) solid: Solid,
    /// Spins before, rad/s.
    pub(super) spins: Vec<f64>,
}

/// Curves that Kratos digitised.
pub(super) fn digitised(test: u32) -> String {
    format!("{PAPER}, test {test}, digitised by Kratos (DEMApplication)")
}

impl Solid {
    pub(super) fn material(&self) -> Material {
        material(self.young, self.poisson, self.density)
    }

    /// The material with which two spheres have E* and G* of one sphere of this material upon a rigid body.
    pub(super) fn upon_rigid(&self) -> Material {
        material(2.0 * self.young, self.poisson, self.density)
    }
}
