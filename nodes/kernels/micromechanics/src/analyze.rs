//! All measurements on one packing.

use crate::equilibrium::unbalanced_force_ratio;
use crate::error::{MicroError, ProbeError};
use crate::network::{SpringNetwork, Springs, bulk_reuss_bound, relaxed_stiffness};
use crate::probe::{StrainProbe, StrainProbeResult, strain_probe};
use crate::sampling_tolerance::sampling_tolerance;
use crate::structure::{contact_statistics, fabric, strain_ratio, stress_decomposition, total_strain_ratio};
use crate::tolerances::TOLERANCES;
use crate::view::PackingView;
use grainlab_core::results::{
    ElasticStiffness, Elasticity, NoStiffness, PackingReport, StiffnessBounds, StiffnessMethod, StrainRatios,
};
use grainlab_core::{Packing, Stiffness, StrainOrigin, Vec3, min_contacts, symmetry};

/// Grains from which the default tolerance is larger.
const LARGE: usize = 50_000;

/// Settings of the measurement of a packing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Relative residual at which the stiffness solve stops, in [`TOLERANCES`]; None: [`Settings::tolerance_for`]. A larger one
    /// overestimates C, the more so the closer the network is to isostaticity (z = 4). The error is stated with the stiffness.
    pub tolerance: Option<f64>,
    /// Maximum number of iterations of the solve.
    pub max_iterations: u32,
    /// Axis of ε, the P4 coefficient, the ratios γ/Δ, and the moduli taken from the stiffness
    /// ([`grainlab_core::results::Fabric::reference_axis`] keeps it). Of any length above zero. The stiffnesses stay in the frame of
    /// the cell.
    pub axis: Vec3,
    /// Springs of the frozen network; a probe has its own friction.
    pub springs: Springs,
    /// With a probe, the stiffness is measured by straining the packing instead of solving the frozen
    /// network.
    pub probe: Option<StrainProbe>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: None,
            max_iterations: 20_000,
            axis: Vec3::z(),
            springs: Springs::Carried,
            probe: None,
        }
    }
}

/// The result of [`analyze`].
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// The measured quantities.
    pub report: PackingReport,
    /// The result of the probe, if one was set.
    pub probe: Option<StrainProbeResult>,
    /// Why the stiffness could not be computed, where the reason in the report is [`NoStiffness::Unsolved`].
    pub unsolved: Option<MicroError>,
}

impl Analysis {
    /// Returns why there is no stiffness; `None` with one, and where grains overlap too deeply, which the
    /// [warnings](grainlab_core::results::warnings()) of the packing say with the likely cause.
    pub fn why_no_stiffness(&self) -> Option<String> {
        match (self.report.elasticity.as_ref().err()?, &self.unsolved) {
            (NoStiffness::TooDeep, _) => None,
            (NoStiffness::Unsolved, Some(reason)) => Some(format!("the moduli are unknown: {reason}")),
            (why, _) => Some(why.to_string()),
        }
    }
}

/// Measures structure, stress and stiffness of `packing`.
///
/// A packing without a stiffness is measured as far as possible; [`PackingReport::elasticity`] has the reason, and
/// [`Analysis::unsolved`] the details where a stiffness was not found or failed its checks. No stiffness is sought where grains
/// overlap beyond every contact law.
///
/// # Errors
/// A setting out of range, and a contact whose normal is not parallel to its branch vector.
pub fn analyze(packing: &Packing, settings: &Settings) -> Result<Analysis, MicroError> {
    let axis = settings.check()?;
    let view = PackingView::new(packing)?;
    let (elasticity, probe, unsolved) = match elasticity(&view, settings) {
        Ok((elasticity, probe)) => (elasticity, probe, None),
        Err(error) if error.is_of_solve() => (Err(NoStiffness::Unsolved), None, Some(error)),
        Err(error) => return Err(error),
    };
    let fabric = fabric(&view, &axis);
    let contacts = contact_statistics(&view);
    let strain_origin = packing.path.as_ref().map_or(StrainOrigin::Reference, |path| path.strain_origin);
    let strain_ratios = StrainRatios {
        // γ/Δ refers to the state that a phase set.
        total: total_strain_ratio(packing, &axis).filter(|_| strain_origin == StrainOrigin::Reference),
        elastic: elasticity
            .as_deref()
            .ok()
            .and_then(|s| strain_ratio(&s.tensor.isotropic_compression()?, &axis)),
        contact: fabric.orientation.overlap_fit.map(|fit| fit.g),
    };
    let tolerance = sampling_tolerance(contacts.grains);
    let report = PackingReport {
        step: packing.step,
        material: packing.material,
        law: packing.law,
        friction: packing.friction,
        solid_fraction: packing.solid_fraction(),
        size_spread: packing.size_spread(),
        // An earlier version recorded packings before a reference as not strained.
        strain: packing.strain().filter(|_| strain_origin != StrainOrigin::Unknown),
        stress: view.stress,
        unbalanced_force_ratio: unbalanced_force_ratio(packing, &view.non_rattlers),
        symmetry: elasticity.as_deref().ok().and_then(|s| symmetry(&s.tensor, tolerance)),
        contacts,
        stress_decomposition: stress_decomposition(&view, &fabric),
        strain_ratios,
        fabric,
        elasticity,
    };
    Ok(Analysis { report, probe, unsolved })
}

fn elasticity(
    view: &PackingView<'_>,
    settings: &Settings,
) -> Result<(Elasticity, Option<StrainProbeResult>), MicroError> {
    let packing = view.packing;
    let grains = packing.grains();
    let without = |why| Ok((Err(why), None));
    if packing.contacts.is_empty() {
        return without(NoStiffness::NoContacts { grains });
    }
    if view.carrying() == 0 {
        return without(NoStiffness::OnlyRattlers { grains, needed: min_contacts(packing.friction) });
    }
    if packing.overlaps().is_some_and(|overlaps| overlaps.are_too_deep()) {
        return without(NoStiffness::TooDeep);
    }
    let network = SpringNetwork::new(view, settings.springs)?;
    let found = relaxed_stiffness(&network, settings.tolerance_for(grains)?, settings.max_iterations)?;
    let Some(found) = found else {
        return without(NoStiffness::Floppy { contacts: network.contacts() });
    };
    // The energy of springs that carry forces changes with the strain by more than the stress does.
    let cauchy =
        |c: Stiffness| if network.prestressed() { c.of_cauchy_stress(&view.stress.tensor) } else { c };
    let bounds = StiffnessBounds {
        affine: cauchy(found.affine),
        uniform_rotation: cauchy(found.uniform_rotation),
        // The bound is that of springs without prestress, which softens the network.
        bulk_reuss: bulk_reuss_bound(view, settings.springs)
            .filter(|_| !network.prestressed() && settings.probe.is_none()),
    };
    let probe = match settings.probe.as_ref().map(|probe| strain_probe(packing, probe)).transpose() {
        // Another friction may leave rattlers alone.
        Err(ProbeError::NoStiffness(why)) => return without(why),
        probe => probe?,
    };
    let stiffness = match &probe {
        Some(probe) => ElasticStiffness {
            method: StiffnessMethod::StrainProbe,
            smooth: probe.smooth,
            tensor: probe.stiffness,
            stddev: probe.stddev(),
            residual: probe.residual(),
            iterations: probe.steps(),
            bounds,
        },
        None => ElasticStiffness {
            method: if network.prestressed() {
                StiffnessMethod::PrestressedNetwork
            } else {
                StiffnessMethod::FrozenNetwork
            },
            smooth: network.smooth(),
            tensor: cauchy(found.relaxed),
            stddev: found.stddev,
            residual: found.residual,
            iterations: found.iterations,
            bounds,
        },
    };
    Ok((Ok(Box::new(stiffness)), probe))
}

impl Settings {
    /// Residual for so many grains: that of the settings, else 1e-9, and 1e-5 from 50,000 grains. At z = 5.3 these leave errors of
    /// about 1e-14 and 1e-9 of C11; the larger one takes half of the time.
    ///
    /// # Errors
    /// One that is not in [`TOLERANCES`].
    pub fn tolerance_for(&self, grains: usize) -> Result<f64, MicroError> {
        let value = self.tolerance.unwrap_or(if grains < LARGE { 1e-9 } else { 1e-5 });
        if TOLERANCES.contains(&value) {
            Ok(value)
        } else {
            let requirement = "between 1e-13 and 1e-5";
            Err(MicroError::Setting { name: "tolerance", value, requirement })
        }
    }

    /// The axis as a unit vector.
    ///
    /// # Errors
    /// A setting that is not in its range.
    pub fn check(&self) -> Result<Vec3, MicroError> {
        self.tolerance_for(0)?;
        let length = self.axis.norm();
        if !(length > 0.0 && length.is_finite()) {
            let requirement = "a finite vector longer than zero";
            return Err(MicroError::Setting { name: "axis", value: length, requirement });
        }
        Ok(self.axis / length)
    }
}
