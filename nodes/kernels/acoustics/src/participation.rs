//! The mass that moves with a wave.
//!
//! Rattlers do not, and a grain that can turn freely, about the line through its two contacts say, moves with less than its
//! mass. A motion Z that meets no resistance is left out of every wave (modes are M-orthogonal to it), so a uniform translation
//! T of long waves carries the kinetic energy of its part M-orthogonal to all Z: V ρ = Tᵀ M T − TᵀMZ (ZᵀMZ)⁻¹ ZᵀMT, a
//! tensor. A motion that is nearly free, with a frequency of its own below that of the wave, stays behind as well: the mass
//! that moves depends a little on frequency.

mod cluster;

use crate::error::AcousticsError;
use crate::participation::cluster::{Cluster, clusters};
use grainlab_core::results::NotJammed;
use grainlab_core::{Mat3, Packing, Vec3};
use grainlab_micromechanics::network::{SpringNetwork, Springs};
use grainlab_micromechanics::{PackingView, min_contacts, non_rattlers};

/// Mass of a packing that moves with long waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Participation {
    /// Effective density of a motion p: pᵀ ρ p, kg/m³.
    pub density: Mat3,
    /// Density of all grains, kg/m³.
    pub bulk: f64,
    /// Grains that carry no force.
    pub rattlers: u32,
    /// Motions of the other grains that stay behind: free, or softer than the wave.
    pub left_behind: u32,
}

impl Participation {
    /// Mean over directions, kg/m³.
    pub fn mean(&self) -> f64 {
        self.density.trace() / 3.0
    }

    /// Standard deviation over directions, kg/m³.
    pub fn spread(&self) -> f64 {
        (self.density - Mat3::identity() * self.mean()).norm() / 3f64.sqrt()
    }
}

/// The part of a packing that carries waves.
#[derive(Clone, Debug)]
pub(crate) struct Carrier {
    /// Contacts between grains that carry force.
    pub(crate) network: SpringNetwork,
    /// Mass of each grain, kg; 0 of a rattler.
    pub(crate) mass: Vec<f64>,
    /// Moment of inertia over a², the length that scales rotations, kg; 0 of a rattler.
    pub(crate) inertia: Vec<f64>,
    /// Softest motions of the grains that are held least.
    pub(crate) clusters: Vec<Cluster>,
    /// Volume of the cell, m³.
    volume: f64,
    bulk: f64,
    rattlers: u32,
}

impl Carrier {
    pub(crate) fn new(packing: &Packing) -> Result<Self, AcousticsError> {
        let grains = packing.grains();
        if packing.contacts.is_empty() {
            return Err(NotJammed::NoContacts { grains }.into());
        }
        let carries = non_rattlers(packing);
        if carries.iter().all(|c| !c) {
            return Err(NotJammed::OnlyRattlers { grains, needed: min_contacts(packing.friction) }.into());
        }
        let held = |g: u32| carries[g as usize];
        let mut carrying = packing.clone();
        carrying.contacts.retain(|c| held(c.i) && held(c.j));
        let network =
            SpringNetwork::new(&PackingView::new(&carrying), Springs::with_friction(packing.friction))?;
        let a = network.spin_scale();
        let mass: Vec<f64> = packing.radii.iter().map(|r| packing.material.sphere_mass(*r)).collect();
        let bulk = mass.iter().sum::<f64>() / packing.cell.volume();
        let of = |g: usize, value: f64| if carries[g] { value } else { 0.0 };
        let inertia =
            (0..grains).map(|g| of(g, 0.4 * mass[g] * (packing.radii[g] / a).powi(2))).collect::<Vec<_>>();
        let mass: Vec<f64> = mass.iter().enumerate().map(|(g, m)| of(g, *m)).collect();
        let clusters = clusters(&network, &mass, &inertia);
        let rattlers = carries.iter().filter(|c| !**c).count() as u32;
        Ok(Self { network, mass, inertia, clusters, volume: packing.cell.volume(), bulk, rattlers })
    }

    /// The mass that moves with waves of the angular frequency `frequency`, rad/s, 0 or more.
    pub(crate) fn participation(&self, frequency: f64) -> Participation {
        let mut tensor = Mat3::identity() * self.mass.iter().sum::<f64>();
        let mut left_behind = 0;
        for cluster in &self.clusters {
            for motion in cluster.motions.iter().filter(|m| m.is_free || m.square < frequency.powi(2)) {
                // TᵀM z of the three translations.
                let carried: Vec3 = (cluster.grains.iter().enumerate())
                    .map(|(at, g)| self.mass[*g as usize] * Vec3::from_fn(|k, _| motion.shape[6 * at + k]))
                    .sum();
                tensor -= carried * carried.transpose();
                left_behind += 1;
            }
        }
        Participation { density: tensor / self.volume, bulk: self.bulk, rattlers: self.rattlers, left_behind }
    }
}
