//! The backbone: the grains that carry waves, and their effective density.
//!
//! Rattlers do not move with a wave. A grain that can rotate freely, for example about the line through its
//! two contacts, moves with less than its mass. Modes are M-orthogonal to every floppy motion Z, so that the
//! uniform translation T of a long wave has the kinetic energy of its part M-orthogonal to all Z: V ρ = Tᵀ M
//! T − TᵀMZ (ZᵀMZ)⁻¹ ZᵀMT, a tensor. A nearly floppy motion with a frequency below that of the wave does not
//! follow the wave either: the effective density depends weakly on frequency.

mod cluster;

use crate::effective_density::EffectiveDensity;
use crate::error::AcousticsError;
use cluster::{Cluster, clusters};
use grainlab_core::results::NoStiffness;
use grainlab_core::{Mat3, Packing, Vec3, min_contacts, non_rattlers};
use grainlab_micromechanics::network::{SpringNetwork, Springs};
use grainlab_micromechanics::{MicroError, PackingView};

/// The grains that carry force, with masses and contacts.
#[derive(Clone, Debug)]
pub(crate) struct Backbone {
    pub(crate) network: SpringNetwork,
    /// Mass of each grain, kg; 0 for rattlers.
    pub(crate) mass: Vec<f64>,
    /// Moment of inertia of each grain over a², where a is the length that scales rotations, kg; 0 for
    /// rattlers.
    pub(crate) inertia: Vec<f64>,
    pub(crate) clusters: Vec<Cluster>,
    /// Volume of the cell, m³.
    volume: f64,
}

/// For each grain, whether it carries force; an error if none does, or grains overlap beyond every contact law.
pub(crate) fn carrying(packing: &Packing) -> Result<Vec<bool>, NoStiffness> {
    let grains = packing.grains();
    if packing.contacts.is_empty() {
        return Err(NoStiffness::NoContacts { grains });
    }
    let carries = non_rattlers(packing);
    if carries.iter().all(|carries| !carries) {
        return Err(NoStiffness::OnlyRattlers { grains, needed: min_contacts(packing.friction) });
    }
    if packing.overlaps().is_some_and(|overlaps| overlaps.are_too_deep()) {
        return Err(NoStiffness::TooDeep);
    }
    Ok(carries)
}

impl Backbone {
    pub(crate) fn new(packing: &Packing) -> Result<Self, AcousticsError> {
        packing.check().map_err(MicroError::from)?;
        let carries = carrying(packing)?;
        let held = |g: u32| carries[g as usize];
        let mut carrying = packing.clone();
        carrying.contacts.retain(|c| held(c.i) && held(c.j));
        let network =
            SpringNetwork::new(&PackingView::new(&carrying).map_err(MicroError::from)?, Springs::Carried)?;
        let a = network.spin_scale();
        let mass: Vec<f64> = packing.radii.iter().map(|r| packing.material.sphere_mass(*r)).collect();
        let of = |g: usize, value: f64| if carries[g] { value } else { 0.0 };
        let inertia = (0..packing.grains())
            .map(|g| of(g, 0.4 * mass[g] * (packing.radii[g] / a).powi(2)))
            .collect::<Vec<_>>();
        let mass: Vec<f64> = mass.iter().enumerate().map(|(g, m)| of(g, *m)).collect();
        let clusters = clusters(&network, &mass, &inertia);
        Ok(Self { network, mass, inertia, clusters, volume: packing.cell.volume() })
    }

    /// The effective density for waves of the angular frequency `frequency`, rad/s, 0 or more.
    pub(crate) fn effective_density(&self, frequency: f64) -> EffectiveDensity {
        let mut tensor = Mat3::identity() * self.mass.iter().sum::<f64>();
        for cluster in &self.clusters {
            for motion in cluster.motions.iter().filter(|m| m.is_free || m.square < frequency.powi(2)) {
                // TᵀM z for the three translations.
                let carried: Vec3 = (cluster.grains.iter().enumerate())
                    .map(|(at, g)| self.mass[*g as usize] * Vec3::from_fn(|k, _| motion.shape[6 * at + k]))
                    .sum();
                tensor -= carried * carried.transpose();
            }
        }
        EffectiveDensity { density: tensor / self.volume }
    }
}
