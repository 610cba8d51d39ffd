//! Properties of a packing that a file may lack.

use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Mat3, Material};

use super::error::{ImportError, Setting};

/// Values given by the user: each one replaces what the file or its sidecar says, which is noted where it says something else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// The cell: edge vectors as columns, m.
    pub cell: Option<Mat3>,
    /// Shear modulus of the grain, Pa.
    pub shear_modulus: Option<f64>,
    /// Poisson ratio of the grain.
    pub poisson_ratio: Option<f64>,
    /// Density of the grain, kg/m³.
    pub density: Option<f64>,
    /// Friction coefficient; may be infinite.
    pub friction: Option<f64>,
    /// Contact law, which replaces the contact law of the file.
    pub law: Option<ContactLaw>,
    /// Contact law of a file that states none; Hertz–Mindlin if this is not given either.
    pub default_law: Option<ContactLaw>,
    /// Radius of every grain, m.
    pub radius: Option<f64>,
    /// Topic of a recording; `packing` if not given.
    pub topic: Option<String>,
    /// Text of a LAMMPS `dump local` with the contact forces of a data file or a dump, at the same steps.
    pub contact_forces: Option<String>,
    /// Columns of that text, if not the default ones: ids of the two grains, normal force on the first, tangential
    /// force on the first (`patom1 patom2 fx fy fz p1 p2 p3`); or the first five, with the whole force. Empty for the
    /// default ones.
    pub contact_columns: Vec<String>,
    /// Frames of a LAMMPS dump that are read. Contact forces are needed at the steps of these alone.
    pub frames: Frames,
}

/// Frames of a dump.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frames {
    /// All frames.
    #[default]
    All,
    /// The last frame.
    Last,
    /// The frames of this step.
    Step(u64),
}

impl ImportOptions {
    /// Grains of this material and friction, of a file that does not say so.
    pub fn of_grains(material: &Material, friction: f64) -> Self {
        Self {
            shear_modulus: Some(material.shear_modulus),
            poisson_ratio: Some(material.poisson_ratio),
            density: Some(material.density),
            friction: Some(friction),
            ..Self::default()
        }
    }

    /// The command-line flags of the data given: all of them, except the topic, are for files that lack these data.
    pub fn flags_given(&self) -> Vec<&'static str> {
        [
            ("--cell", self.cell.is_some()),
            ("--shear-modulus", self.shear_modulus.is_some()),
            ("--poisson", self.poisson_ratio.is_some()),
            ("--density", self.density.is_some()),
            ("--friction", self.friction.is_some()),
            ("--contact-law", self.law.is_some()),
            ("--radius", self.radius.is_some()),
            ("--contact-forces", self.contact_forces.is_some()),
        ]
        .into_iter()
        .filter_map(|(flag, given)| given.then_some(flag))
        .collect()
    }
}

/// The properties in a file, to be completed by the options.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    pub(super) cell: Option<Mat3>,
    pub(super) shear_modulus: Option<f64>,
    pub(super) poisson_ratio: Option<f64>,
    pub(super) density: Option<f64>,
    pub(super) law: Option<ContactLaw>,
    pub(super) friction: Option<f64>,
}

/// Relative difference of densities that is due to the digits of masses.
const ROUNDING: f64 = 1e-5;

/// All properties of a packing except its grains.
#[derive(Clone, Debug)]
pub(super) struct Properties {
    pub(super) cell: Cell,
    pub(super) material: Material,
    pub(super) law: ContactLaw,
    /// True if the file or the options state the contact law; false if it is assumed.
    pub(super) law_is_stated: bool,
    pub(super) friction: f64,
    /// Notes on values that the user replaced, or that the file does not state.
    pub(super) notes: Vec<String>,
}

/// A note of a value in the file that another one replaces.
pub(super) fn replaced<T: PartialEq + std::fmt::Display>(
    what: &str,
    unit: &str,
    given: Option<T>,
    known: Option<T>,
) -> Option<String> {
    let (given, known) = (given?, known?);
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    (given != known)
        .then(|| format!("{what} of the file, {known}{unit}, is replaced by the one given, {given}{unit}"))
}

impl Known {
    /// All settings, or the list of those that are missing.
    pub(super) fn complete(&self, options: &ImportOptions) -> Result<Properties, ImportError> {
        let mut missing = Vec::new();
        let mut need = |given: Option<f64>, known: Option<f64>, setting| {
            given.or(known).unwrap_or_else(|| {
                missing.push(setting);
                f64::NAN
            })
        };
        let shear_modulus = need(options.shear_modulus, self.shear_modulus, Setting::ShearModulus);
        let poisson_ratio = need(options.poisson_ratio, self.poisson_ratio, Setting::PoissonRatio);
        let density = need(options.density, self.density, Setting::Density);
        let friction = need(options.friction, self.friction, Setting::Friction);
        let matrix = options.cell.or(self.cell);
        if matrix.is_none() {
            missing.push(Setting::Cell);
        }
        let Some(matrix) = matrix.filter(|_| missing.is_empty()) else {
            missing.sort();
            return Err(ImportError::Missing(missing));
        };
        let cell = Cell::new(matrix).ok_or_else(|| {
            let rows = matrix.transpose();
            let form = "row-major, columns are the edge vectors, m";
            ImportError::Given(format!("the cell {:?} ({form}) has no positive volume", rows.as_slice()))
        })?;
        let material = Material { shear_modulus, poisson_ratio, density };
        let is_other = |given: &f64| self.density.is_none_or(|known| (given / known - 1.0).abs() > ROUNDING);
        let cells = |m: Mat3| format!("{:?}", m.transpose().as_slice());
        let notes = [
            replaced("the shear modulus", "Pa", options.shear_modulus, self.shear_modulus),
            replaced("the Poisson ratio", "", options.poisson_ratio, self.poisson_ratio),
            replaced("the density", "kg/m3", options.density.filter(is_other), self.density),
            replaced("the friction", "", options.friction, self.friction),
            replaced("the contact law", "", options.law, self.law),
            replaced("the cell", "m", options.cell.map(cells), self.cell.map(cells)),
        ];
        let notes = notes.into_iter().flatten().collect();
        let law = options.law.or(self.law).or(options.default_law);
        let (law, law_is_stated) = (law.unwrap_or_default(), law.is_some());
        Ok(Properties { cell, material, law, law_is_stated, friction, notes })
    }
}
