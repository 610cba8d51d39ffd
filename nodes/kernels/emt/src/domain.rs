//! The range of a model.

use crate::conditions::Conditions;
use crate::error::EmtError;
use grainlab_core::contact::SpringLaw;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// Lowest and highest value, both included.
pub type Range = [f64; 2];

/// Solid fractions of jammed packings of spheres, with a margin. The loosest of frictional spheres have .55 (Jerkins et al. 2008),
/// those of the calibration .595 and more; the densest of equal spheres .74 (fcc), random ones of sizes of 1:3 at most .72 at the
/// onset of jamming, and some percent more under pressure.
const JAMMED: Range = [0.5, 0.8];

/// Range of one quantity over the packings that the constants of a model were learned from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Lowest and highest of them.
    pub range: Range,
    /// Range that still counts as inside: that of the packings, or wider by the ends that random packings do not reach.
    pub inside: Range,
}

/// The structures and states for which a model predicts moduli and inverts its prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Name of the model.
    pub model: &'static str,
    /// Range of each quantity in the order of [`InferredQuantity::ALL`]; `None` for those that the model does not use.
    pub structure: [Option<Range>; InferredQuantity::COUNT],
    /// The packings of the calibration, in the same order: beyond them an estimate is an extrapolation.
    pub fitted: [Option<Fitted>; InferredQuantity::COUNT],
    /// Range of g = γ/Δ.
    pub gamma: Range,
    /// Range of p/E*.
    pub reduced_pressure: Range,
    /// Range of (σ_33 − (σ_11 + σ_22)/2)/p.
    pub stress_ratio: Range,
    /// Range of the standard deviation of the radii over their mean.
    pub size_spread: Range,
    /// True if the solid fraction must be known.
    pub needs_solid_fraction: bool,
    /// True if the contacts may have any law, or one that is not known.
    pub any_contact: bool,
    /// True if the model compares pressure, grains and stress with the packings of its calibration.
    pub compares_state: bool,
}

impl Domain {
    /// These structures, in every state that an elastic packing can have, whether or not its solid fraction is known.
    pub(crate) fn new(model: &'static str, ranges: &[(InferredQuantity, Range)]) -> Self {
        Self {
            model,
            structure: by_quantity(ranges),
            fitted: [None; InferredQuantity::COUNT],
            gamma: [-1.0, 1.0],
            reduced_pressure: [0.0, f64::INFINITY],
            stress_ratio: [-1.5, 3.0],
            size_spread: [0.0, f64::INFINITY],
            needs_solid_fraction: false,
            any_contact: false,
            compares_state: false,
        }
    }

    /// Refuses contacts whose law the model does not know.
    pub(crate) fn validate_contact(&self, conditions: &Conditions) -> Result<(), EmtError> {
        match conditions.contact_law.map(|law| law.springs) {
            Some(springs) if springs != SpringLaw::HertzMindlin && !self.any_contact => {
                Err(Note::other_contact_law(springs.name()).into())
            }
            _ => Ok(()),
        }
    }

    /// Refuses a pressure, Pa, outside the range for grains of this effective modulus E*, Pa.
    pub(crate) fn validate_pressure(&self, pressure: f64, effective_young: f64) -> Result<(), EmtError> {
        self.within("p/E*", pressure / effective_young, self.reduced_pressure)
    }

    /// The values of `structure` that the model uses, in the order of [`InferredQuantity::ALL`], with zero for the
    /// others. An error if one of them is missing, or if one of them or of `conditions` lies outside.
    pub fn validate(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
    ) -> Result<[f64; InferredQuantity::COUNT], EmtError> {
        conditions.check()?;
        self.validate_contact(conditions)?;
        let mut values = [0.0; InferredQuantity::COUNT];
        for (i, quantity) in InferredQuantity::ALL.into_iter().enumerate() {
            let Some(range) = self.structure[i] else { continue };
            let missing = EmtError::Missing { model: self.model, missing: quantity.name() };
            values[i] = structure.get(quantity).ok_or(missing)?;
            self.within(quantity.name(), values[i], range)?;
        }
        self.within("gamma/Delta", conditions.gamma.value, self.gamma)?;
        if let Some(ratio) = conditions.stress_ratio {
            self.within("the axial stress ratio", ratio.value, self.stress_ratio)?;
        }
        if let Some(spread) = conditions.size_spread {
            self.within("the spread of the grain sizes", spread, self.size_spread)?;
        }
        if self.needs_solid_fraction && conditions.solid_fraction.is_none() {
            return Err(EmtError::Missing { model: self.model, missing: "the solid fraction" });
        }
        self.validate_solid_fraction(conditions)?;
        Ok(values)
    }

    /// Refuses a solid fraction that no jammed packing has, if the model uses it.
    pub(crate) fn validate_solid_fraction(&self, conditions: &Conditions) -> Result<(), EmtError> {
        let used = conditions.solid_fraction.filter(|_| self.needs_solid_fraction);
        used.map_or(Ok(()), |phi| self.within("the solid fraction", phi.value, JAMMED))
    }

    /// True if everything of `structure` that the model uses lies inside.
    pub fn contains(&self, structure: &Microstructure) -> bool {
        structure.values().iter().zip(&self.structure).all(|(value, range)| match (value, range) {
            (Some(v), Some([low, high])) => (*low..=*high).contains(v),
            _ => true,
        })
    }

    fn within(&self, quantity: &'static str, value: f64, [low, high]: Range) -> Result<(), EmtError> {
        // False for NaN.
        if (low..=high).contains(&value) {
            return Ok(());
        }
        Err(Note::beyond_domain(quantity, self.model, value, low, high).into())
    }
}

/// Some entries, in the order of [`InferredQuantity::ALL`].
pub(crate) fn by_quantity<T: Copy>(known: &[(InferredQuantity, T)]) -> [Option<T>; InferredQuantity::COUNT] {
    let mut all = [None; InferredQuantity::COUNT];
    known.iter().for_each(|(quantity, entry)| all[*quantity as usize] = Some(*entry));
    all
}

pub(crate) fn outside_fitted(
    fitted: &[Option<Fitted>; InferredQuantity::COUNT],
    structure: &Microstructure,
) -> Vec<Note> {
    let of = |quantity: InferredQuantity| {
        let (value, Fitted { range, inside: [low, high] }) =
            structure.get(quantity).zip(fitted[quantity as usize])?;
        let note = || match quantity {
            InferredQuantity::Eps => {
                Note::anisotropy_outside_calibration(quantity.name(), value, range[0], range[1])
            }
            _ if value < range[0] => Note::below_calibration(quantity.name(), value, range[0]),
            _ => Note::above_calibration(quantity.name(), value, range[1]),
        };
        // Also where it is not a number.
        (!(low..=high).contains(&value)).then(note)
    };
    InferredQuantity::ALL.into_iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::Measured;

    #[test]
    fn a_solid_fraction_that_no_jammed_packing_has_is_refused_by_models_that_use_it() {
        let uses = Domain { needs_solid_fraction: true, ..Domain::new("emt", &[]) };
        let at = |phi| Conditions { solid_fraction: Some(Measured::exact(phi)), ..Conditions::at(5e4) };
        for phi in [0.5, 0.55, 0.64, 0.74, 0.8] {
            assert_eq!(uses.validate_solid_fraction(&at(phi)), Ok(()), "{phi}");
        }
        for phi in [0.2, 0.499, 0.81, 0.99] {
            let refused = uses.validate_solid_fraction(&at(phi)).unwrap_err().to_string();
            assert!(refused.contains("the solid fraction") && refused.contains("[0.5, 0.8]"), "{refused}");
            assert_eq!(Domain::new("relaxed", &[]).validate_solid_fraction(&at(phi)), Ok(()));
        }
    }
}
