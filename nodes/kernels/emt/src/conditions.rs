//! The state in which the moduli were measured.

use crate::error::EmtError;
use grainlab_core::Material;
use grainlab_core::contact::ContactLaw;
use grainlab_core::notes::Note;
use grainlab_core::results::StrainRatios;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The source of a γ/Δ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StrainRatioSource {
    /// The total strain since the reference state, which is mostly plastic. That of the paper's Table II.
    Total,
    /// The elastic strain of an isotropic stress increment.
    Elastic,
    /// A fit to the overlaps of the contacts.
    Contact,
    /// Given by the user.
    #[serde(skip)]
    Given,
    /// Not known, and set to zero.
    #[default]
    Zero,
}

impl StrainRatioSource {
    /// Name in messages, parameters and results.
    pub const fn name(self) -> &'static str {
        match self {
            StrainRatioSource::Total => "total",
            StrainRatioSource::Elastic => "elastic",
            StrainRatioSource::Contact => "contact",
            StrainRatioSource::Given => "given",
            StrainRatioSource::Zero => "zero",
        }
    }

    fn of(self, measured: &StrainRatios) -> Option<f64> {
        match self {
            StrainRatioSource::Total => measured.total,
            StrainRatioSource::Elastic => measured.elastic,
            StrainRatioSource::Contact => measured.contact,
            StrainRatioSource::Given | StrainRatioSource::Zero => None,
        }
    }
}

/// The strain ratio g = γ/Δ given to a model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainRatio {
    /// Value of g, dimensionless.
    pub value: f64,
    /// Standard deviation, dimensionless; 0 takes the value as exact.
    pub stddev: f64,
    /// Source of the value.
    pub source: StrainRatioSource,
}

impl StrainRatio {
    /// Not known: zero.
    pub const ZERO: StrainRatio = StrainRatio { value: 0.0, stddev: 0.0, source: StrainRatioSource::Zero };

    /// A value given, taken as exact.
    pub const fn given(value: f64) -> Self {
        Self { value, stddev: 0.0, source: StrainRatioSource::Given }
    }

    /// True if the ratio of this source was measured.
    pub fn is_known(measured: &StrainRatios, source: StrainRatioSource) -> bool {
        source.of(measured).is_some()
    }

    /// The ratio for the paper's models: the total one if it is known, else that of the contacts, else zero.
    pub fn preferred(measured: &StrainRatios) -> Self {
        Self::of(measured, StrainRatioSource::Total)
    }

    /// The ratio of this source; if it is not known, that of the contacts, else zero.
    pub fn of(measured: &StrainRatios, source: StrainRatioSource) -> Self {
        if matches!(source, StrainRatioSource::Given | StrainRatioSource::Zero) {
            return Self::ZERO;
        }
        let with = |source: StrainRatioSource| {
            Some(StrainRatio { value: source.of(measured)?, stddev: 0.0, source })
        };
        with(source).or_else(|| with(StrainRatioSource::Contact)).unwrap_or(Self::ZERO)
    }
}

impl fmt::Display for StrainRatio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let source = match self.source {
            StrainRatioSource::Total => "total strain since the reference state",
            StrainRatioSource::Elastic => "elastic increment",
            StrainRatioSource::Contact => "contact overlaps",
            StrainRatioSource::Given => "given",
            StrainRatioSource::Zero => "not known, taken as 0",
        };
        write!(f, "gamma/Delta = {:.4} ({source})", self.value)
    }
}

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Value of the number.
    pub value: f64,
    /// Standard deviation in the unit of the number; 0 takes the number as exact.
    pub stddev: f64,
}

impl Measured {
    /// Standard deviation of the square of a spread of the sizes.
    pub fn variance_stddev(&self) -> f64 {
        2.0 * self.value * self.stddev
    }

    /// A number taken as exact.
    pub const fn exact(value: f64) -> Self {
        Self { value, stddev: 0.0 }
    }
}

/// q/p that is not known: a normal distribution of mean 0 and standard deviation 0.15, cut at ±0.3. Its moments.
pub const UNKNOWN_STRESS_RATIO: Measured = Measured { value: 0.0, stddev: 0.131_94 };

/// A spread of the sizes that is not known: uniform from 0 to 0.3. The laws take its square s², whose mean is
/// 0.03 and standard deviation 0.0268: here as a spread and its standard deviation that give the same.
pub const UNKNOWN_SIZE_SPREAD: Measured = Measured { value: 0.173_2, stddev: 0.077_46 };

/// The largest spread of the sizes of which one that is not known may be.
pub(crate) const LARGEST_SPREAD: f64 = 0.3;

pub(crate) const STATE_INPUTS: usize = 7;

/// The inputs of a model besides the moduli.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Confining pressure, Pa, positive in compression.
    pub pressure: Measured,
    /// γ/Δ of the state.
    pub gamma: StrainRatio,
    /// Solid fraction φ; `None` if not known.
    pub solid_fraction: Option<Measured>,
    /// (σ_33 − (σ_11 + σ_22)/2)/p, in [−3/2, 3] where no stress is tensile; `None` takes [`UNKNOWN_STRESS_RATIO`].
    pub stress_ratio: Option<Measured>,
    /// Standard deviation of the radii of the grains over their mean; `None` takes [`UNKNOWN_SIZE_SPREAD`].
    pub size_spread: Option<f64>,
    /// Material of the grains; `None` takes that of the calibration.
    pub material: Option<Material>,
    /// Standard deviation of the shear modulus of the grains, Pa; 0 takes it as exact.
    pub shear_modulus_stddev: f64,
    /// Standard deviation of the Poisson ratio of the grains; 0 takes it as exact.
    pub poisson_ratio_stddev: f64,
    /// Contact law of the grains; `None` takes Hertz–Mindlin contacts.
    pub contact_law: Option<ContactLaw>,
    /// True if the moduli are those of contacts without tangential springs: no model has an estimate for them.
    pub smooth: bool,
}

impl Conditions {
    /// At this pressure, Pa, with nothing else known.
    pub fn at(pressure: f64) -> Self {
        Self { pressure: Measured::exact(pressure), ..Self::default() }
    }

    /// Standard deviations of the inputs of the state, in the order of the last of [`grainlab_core::results::INFERENCE_INPUTS`]: relative ones of the
    /// pressure, the solid fraction and the shear modulus of the grains. `material` is that of the calibration.
    pub(crate) fn stddevs(&self, material: &Material) -> [f64; STATE_INPUTS] {
        let grains = self.material.as_ref().unwrap_or(material);
        [
            self.pressure.stddev / self.pressure.value,
            self.gamma.stddev,
            self.solid_fraction.map_or(0.0, |phi| phi.stddev / phi.value),
            self.stress_ratio.unwrap_or(UNKNOWN_STRESS_RATIO).stddev,
            if self.size_spread.is_some() { 0.0 } else { UNKNOWN_SIZE_SPREAD.stddev },
            self.shear_modulus_stddev / grains.shear_modulus,
            self.poisson_ratio_stddev,
        ]
    }

    /// Conditions with one input of the state changed, by a relative amount where [`Conditions::stddevs`] has a relative
    /// deviation. `None` if the input is not known.
    pub(crate) fn moved(&self, input: usize, by: f64, material: &Material) -> Option<Self> {
        let mut moved = *self;
        match input {
            0 => moved.pressure.value *= 1.0 + by,
            1 => moved.gamma.value += by,
            2 => moved.solid_fraction.as_mut()?.value *= 1.0 + by,
            3 => moved.stress_ratio.get_or_insert(UNKNOWN_STRESS_RATIO).value += by,
            4 => *moved.size_spread.get_or_insert(UNKNOWN_SIZE_SPREAD.value) += by,
            5 => moved.material.get_or_insert(*material).shear_modulus *= 1.0 + by,
            _ => moved.material.get_or_insert(*material).poisson_ratio += by,
        }
        Some(moved)
    }

    pub(crate) fn check(&self) -> Result<(), EmtError> {
        let finite = |quantity: &'static str, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(EmtError::NotFinite { quantity, value }) }
        };
        if self.smooth {
            return Err(Note::smooth_grains().into());
        }
        let positive = |quantity: &'static str, value: f64| {
            finite(quantity, value)?;
            if value > 0.0 { Ok(()) } else { Err(EmtError::NotPositive { quantity, value }) }
        };
        positive("pressure", self.pressure.value)?;
        let (phi, ratio) = (self.solid_fraction, self.stress_ratio);
        for (quantity, value) in [
            ("stddev of pressure", Some(self.pressure.stddev)),
            ("stddev of gamma/Delta", Some(self.gamma.stddev)),
            ("stddev of the solid fraction", phi.map(|p| p.stddev)),
            ("stddev of the stress ratio", ratio.map(|r| r.stddev)),
            ("stddev of the shear modulus of the grains", Some(self.shear_modulus_stddev)),
            ("stddev of the Poisson ratio of the grains", Some(self.poisson_ratio_stddev)),
            ("size spread", self.size_spread),
        ] {
            let Some(value) = value else { continue };
            finite(quantity, value)?;
            if value < 0.0 {
                return Err(EmtError::NegativeStddev { quantity, value });
            }
        }
        finite("gamma/Delta", self.gamma.value)?;
        let within = |quantity, value: Option<Measured>, fits: fn(f64) -> bool, range| match value {
            Some(Measured { value, .. }) if !fits(value) => Err(EmtError::NoState { quantity, value, range }),
            _ => Ok(()),
        };
        within("the solid fraction", phi, |phi| phi > 0.0 && phi < 1.0, "(0, 1)")?;
        let tensile = "[-3/2, 3], where no stress is tensile";
        within("the stress ratio (s33 - (s11 + s22)/2)/p", ratio, |q| (-1.5..=3.0).contains(&q), tensile)?;
        if let Some(m) = &self.material {
            positive("shear modulus of the grains", m.shear_modulus)?;
            let nu = Some(Measured::exact(m.poisson_ratio));
            within("the Poisson ratio of the grains", nu, |nu| (0.0..=0.5).contains(&nu), "[0, 1/2]")?;
        }
        Ok(())
    }
}
