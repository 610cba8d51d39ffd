//! Errors of the measurements.

use grainlab_core::results::NoStiffness;

/// Why a packing could not be analysed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MicroError {
    /// Numbers that are no packing.
    #[error(transparent)]
    Packing(#[from] grainlab_core::PackingError),
    /// Loads that are not one for each grain.
    #[error("the network has {grains} grains, and there are {loads} loads: give one for each grain")]
    Loads {
        /// Grains of the network.
        grains: usize,
        /// Number of loads.
        loads: usize,
    },
    /// A setting is out of its range.
    #[error("setting {name} = {value:e} is out of range: {requirement}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value found.
        value: f64,
        /// Range that is required.
        requirement: &'static str,
    },
    /// The normal of a contact does not point along its branch vector.
    #[error(
        "contact {contact} (grains {i} and {j}): the normal is not the direction of the branch vector (cosine \
         {cosine}); check positions, cell and image, and that normals point from i to j"
    )]
    Normal {
        /// Index of the contact.
        contact: usize,
        /// Index of the first grain.
        i: u32,
        /// Index of the second grain.
        j: u32,
        /// Cosine of the angle between them; not a number if the centres coincide.
        cosine: f64,
    },
    /// The linear solve did not reach its tolerance.
    #[error(
        "stiffness solve reached a relative residual of {residual:e} after {iterations} iterations, {tolerance:e} was \
         asked for (a network near isostaticity converges slowly, one with chains of grains on two contacts perhaps not at all){}",
        sufficient.map_or_else(String::new, |value| format!("; a tolerance of {value:e} is met"))
    )]
    NotConverged {
        /// The worst relative residual of the columns.
        residual: f64,
        /// The tolerance set.
        tolerance: f64,
        /// Number of iterations done.
        iterations: u32,
        /// A larger tolerance with which the stiffness was found, if there is one.
        sufficient: Option<f64>,
    },
    /// Prestress gives the network a direction of negative stiffness.
    #[error(
        "the prestressed network has a direction of negative stiffness (relative residual {residual:e}): the packing is not at \
         rest, or friction holds it, which this network of normal forces leaves out; relax it without friction, or leave the \
         prestress term out"
    )]
    Unstable {
        /// The worst relative residual of the columns.
        residual: f64,
    },
    /// Two evaluations of the same stiffness, by energy and by stress, differ.
    #[error(
        "stiffness by energy and by stress differ by {relative:e} of the largest entry of the affine stiffness (at most \
         {limit:e}){}",
        sufficient.map_or_else(
            || ": the network is too soft for double precision".to_owned(),
            |value| format!("; with a tolerance of {value:e} they agree")
        )
    )]
    Inconsistent {
        /// Largest difference over the largest entry of the affine stiffness.
        relative: f64,
        /// The largest value allowed.
        limit: f64,
        /// A smaller tolerance with which the stiffness was found, if there is one.
        sufficient: Option<f64>,
    },
    /// The stiffness is not between zero and the affine stiffness.
    #[error(
        "stiffness is out of bounds: smallest eigenvalue of {what} is {eigenvalue:e} Pa; the result is wrong and was \
         withheld"
    )]
    OutOfBounds {
        /// Name of the matrix: "C", "B - C" or "A - B", with B the stiffness of affine motion with a uniform
        /// rotation.
        what: &'static str,
        /// The offending eigenvalue, Pa.
        eigenvalue: f64,
    },
    /// Prestress makes the stiffness negative under some strain.
    #[error(
        "the prestressed packing has a negative stiffness under some strain, {eigenvalue:e} Pa: it is stable only while that \
         strain is held, and has no moduli"
    )]
    HeldOnly {
        /// Smallest eigenvalue of the stiffness, Pa.
        eigenvalue: f64,
    },
    /// The explicit probe failed.
    #[error(transparent)]
    Probe(#[from] ProbeError),
}

impl MicroError {
    /// Returns true if the packing was read and only its stiffness could not be computed, or was withheld.
    pub fn is_of_solve(&self) -> bool {
        match self {
            Self::NotConverged { .. }
            | Self::Unstable { .. }
            | Self::Inconsistent { .. }
            | Self::OutOfBounds { .. }
            | Self::HeldOnly { .. } => true,
            Self::Probe(error) => !matches!(error, ProbeError::Setting { .. }),
            Self::Packing(_) | Self::Loads { .. } | Self::Setting { .. } | Self::Normal { .. } => false,
        }
    }
}

/// Why a packing could not be probed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProbeError {
    /// A setting is out of its range.
    #[error("probe setting {name} = {value:e} is out of range: {requirement}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value found.
        value: f64,
        /// Range that is required.
        requirement: &'static str,
    },
    /// The packing has no contact network.
    #[error(transparent)]
    NoStiffness(#[from] NoStiffness),
    /// The packing did not come to rest before the strain.
    #[error(
        "the packing is not at rest: an unbalanced force ratio of {unbalanced:e} after {steps} steps, {target:e} is needed \
         for this amplitude; relax the packing further, or raise the amplitude"
    )]
    NoRest {
        /// Mean net force of non-rattlers over mean contact force.
        unbalanced: f64,
        /// The largest value allowed.
        target: f64,
        /// Number of steps done.
        steps: u32,
    },
    /// The stress under strain did not settle.
    #[error(
        "column {component} did not settle in {steps} steps: residual force {residual:e}, drift of the stress {drift:e}, \
         tolerance {tolerance:e} (a network near isostaticity converges slowly); lower the amplitude if contacts open"
    )]
    NotConverged {
        /// Voigt component of the strain.
        component: &'static str,
        /// Residual force; see [`crate::probe::ProbeColumn::residual`].
        residual: f64,
        /// Drift of the stress; see [`crate::probe::ProbeColumn::drift`].
        drift: f64,
        /// The tolerance set.
        tolerance: f64,
        /// Number of steps done.
        steps: u32,
    },
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] grainlab_engine::EngineError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unstable_network_without_friction_may_be_one_that_friction_holds() {
        let text = MicroError::Unstable { residual: 1e-3 }.to_string();
        assert!(text.contains("friction holds it") && text.contains("not at rest"), "{text}");
    }

    #[test]
    fn advice_is_about_what_a_command_has() {
        let rest = ProbeError::NoRest { unbalanced: 1e-3, target: 1e-6, steps: 9 };
        let solve = |sufficient| {
            let (residual, tolerance, iterations) = (1e-7, 1e-9, 9);
            MicroError::NotConverged { residual, tolerance, iterations, sufficient }.to_string()
        };
        for text in [rest.to_string(), solve(None), solve(Some(2e-7))] {
            assert!(!text.contains("max_"), "{text}");
        }
        assert!(solve(Some(2e-7)).ends_with("; a tolerance of 2e-7 is met"));
        assert!(solve(None).ends_with("not at all)"), "no tolerance is advised that was not tried");
    }
}
