//! Everything that is measured on one packing.

use crate::anisotropy;
use crate::balance::unbalanced;
use crate::bounds::reuss_bulk;
use crate::error::{MicroError, NoNetwork};
use crate::fabric::fabric;
use crate::network::Network;
use crate::probe::{Probe, ProbeResult, probe};
use crate::rattlers::{contacts_needed, participating};
use crate::solve::Solver;
use crate::stiffness;
use grainlab_core::stress::{Stress, stress};
use grainlab_core::{Fabric, Method, Moduli, Packing, Vec3};

/// How a packing is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Relative residual at which the stiffness solve stops, in [1e-13, 1e-2]. The default leaves an error of about 1e-14
    /// in C at z = 5.3; a loose one overestimates C, the more so the closer the network is to isostaticity (z = 4).
    pub tolerance: f64,
    /// How the stiffness solve is done; the result is the same.
    pub solver: Solver,
    /// Iterations after which the solve gives up.
    pub max_iterations: u32,
    /// Axis about which ε, the P4 coefficient and the ratios γ/Δ are taken, and what is read off the
    /// stiffness as moduli ([`grainlab_core::structure::Structure::reference_axis`] keeps it). Any length but zero. The stiffnesses
    /// themselves stay in the frame of the cell.
    pub axis: Vec3,
    /// Whether contacts keep their tangential stiffness ("friction set very high"), or have none (frictionless).
    pub tangential: bool,
    /// Whether the frozen network has the prestress term: see [`Network::with_prestress`]. For networks without tangential
    /// springs alone: the normal forces' term by itself would make grains on two contacts, which tangential forces hold,
    /// give way, and next to tangential springs it is a ten thousandth.
    pub prestress: bool,
    /// With a probe the stiffness is measured by straining the packing, instead of that of the frozen network.
    pub probe: Option<Probe>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-9,
            solver: Solver::Iterative,
            max_iterations: 20_000,
            axis: Vec3::z(),
            tangential: true,
            prestress: false,
            probe: None,
        }
    }
}

/// What [`analyse`] finds.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// Structure: coordination, fabric, the ratios γ/Δ.
    pub fabric: Fabric,
    /// Stress of the elastic contact forces.
    pub stress: Stress,
    /// Mean stress, Pa, positive in compression.
    pub pressure: f64,
    /// Deviatoric stress invariant √(3/2 s:s), Pa.
    pub deviatoric: f64,
    /// Solid fraction φ.
    pub solid_fraction: f64,
    /// Unbalanced force ratio: mean net force of non-rattlers over mean contact force; `None` without forces.
    pub unbalanced: Option<f64>,
    /// Relaxed and affine stiffness of the frozen network, or why there is none.
    pub moduli: Result<Moduli, NoNetwork>,
    /// How the probe went, where there was one.
    pub probe: Option<ProbeResult>,
}

/// Measures structure, stress and stiffness of `packing`.
///
/// A packing without a contact network is measured as far as it goes and says why in [`Analysis::moduli`]. A stiffness
/// that fails its checks is an error.
pub fn analyse(packing: &Packing, settings: &Settings) -> Result<Analysis, MicroError> {
    let axis = checked_axis(settings)?;
    let stress = stress(packing);
    let present = participating(packing);
    let mut fabric = fabric(packing, &axis);
    let mut moduli = measured_moduli(packing, &present, settings)?;
    let probe = match (&mut moduli, &settings.probe) {
        (Ok(moduli), Some(settings)) => Some(probed(packing, settings, moduli)?),
        _ => None,
    };
    if let Ok(m) = &moduli {
        fabric.anisotropy.elastic =
            m.stiffness.isotropic_compression().and_then(|strain| anisotropy::ratio(&strain, &axis));
    }
    Ok(Analysis {
        fabric,
        stress,
        pressure: stress.tensor.mean(),
        deviatoric: stress.tensor.deviatoric_invariant(),
        solid_fraction: packing.solid_fraction(),
        unbalanced: unbalanced(packing, &present),
        moduli,
        probe,
    })
}

/// Puts the stiffness of the probe in the place of the network's; iterations are then solver steps.
fn probed(packing: &Packing, settings: &Probe, moduli: &mut Moduli) -> Result<ProbeResult, MicroError> {
    let found = probe(packing, settings)?;
    moduli.method = Method::Probe;
    moduli.stiffness = found.stiffness;
    moduli.stddev = found.stddev();
    moduli.residual = found.columns.iter().map(|c| c.residual).fold(0.0, f64::max);
    moduli.iterations = found.rest_steps + found.columns.iter().map(|c| c.steps).sum::<u32>();
    Ok(found)
}

fn measured_moduli(
    packing: &Packing,
    present: &[bool],
    settings: &Settings,
) -> Result<Result<Moduli, NoNetwork>, MicroError> {
    let grains = packing.grains();
    if packing.contacts.is_empty() {
        return Ok(Err(NoNetwork::NoContacts { grains }));
    }
    if present.iter().all(|p| !p) {
        return Ok(Err(NoNetwork::OnlyRattlers { grains, needed: contacts_needed(packing.friction) }));
    }
    let mut network = Network::new(packing, settings.tangential)?;
    if settings.prestress {
        network = network.with_prestress(packing);
    }
    let mut moduli =
        stiffness::moduli(&network, settings.solver, settings.tolerance, settings.max_iterations)?;
    if let Ok(moduli) = &mut moduli {
        moduli.reuss_bound = reuss_bulk(packing, settings.tangential);
    }
    Ok(moduli)
}

fn checked_axis(settings: &Settings) -> Result<Vec3, MicroError> {
    let tolerance = settings.tolerance;
    if !(1e-13..=1e-2).contains(&tolerance) {
        let requirement = "between 1e-13 and 1e-2";
        return Err(MicroError::Setting { name: "tolerance", value: tolerance, requirement });
    }
    if settings.prestress && settings.tangential {
        let requirement = "0, without tangential springs, for a network with prestress";
        return Err(MicroError::Setting { name: "tangential", value: 1.0, requirement });
    }
    let length = settings.axis.norm();
    if !(length > 0.0 && length.is_finite()) {
        let requirement = "a finite vector longer than zero";
        return Err(MicroError::Setting { name: "axis", value: length, requirement });
    }
    Ok(settings.axis / length)
}
