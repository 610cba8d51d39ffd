//! One contact moved by hand: the engine's contact law under a prescribed motion.

use grainlab_core::Vec3;
use grainlab_core::contact::{ContactKinematics, ContactSprings, SpringDashpotSlider};
use grainlab_core::lanes::LaneVec3;

/// A contact with its history.
#[derive(Clone, Debug)]
pub(crate) struct ForcedContact<S> {
    pub(crate) law: SpringDashpotSlider<S>,
    /// Effective radius R*, m.
    pub(crate) effective_radius: f64,
    /// Effective mass m*, kg.
    pub(crate) effective_mass: f64,
    /// Time step, s.
    pub(crate) time_step: f64,
    history: Vec3,
    contact_radius: f64,
}

/// Motion of a contact in one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Move {
    /// Full overlap, m.
    pub(crate) overlap: f64,
    /// From the first body to the second.
    pub(crate) normal: Vec3,
    /// 1 over the distance of the centres, 1/m; 0 upon a plane.
    pub(crate) inverse_distance: f64,
    /// Velocity of the second centre relative to the first, m/s.
    pub(crate) velocity: Vec3,
    /// Distances of the contact from the centres times the spins, summed, m/s.
    pub(crate) spin_velocity: Vec3,
    /// Sum of the spins, rad/s.
    pub(crate) spin_sum: Vec3,
}

/// Forces of a contact, N.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forces {
    /// Positive in compression, dashpot included.
    pub(crate) normal: f64,
    /// On the first body.
    pub(crate) tangential: Vec3,
}

impl<S: ContactSprings> ForcedContact<S> {
    pub(crate) fn new(
        law: SpringDashpotSlider<S>,
        effective_radius: f64,
        effective_mass: f64,
        time_step: f64,
    ) -> Self {
        let history = Vec3::zeros();
        Self { law, effective_radius, effective_mass, time_step, history, contact_radius: 0.0 }
    }

    pub(crate) fn step(&mut self, m: &Move) -> Forces {
        let contact_radius = (self.effective_radius * m.overlap).sqrt();
        let kinematics = ContactKinematics {
            normal: lanes(m.normal),
            inverse_distance: m.inverse_distance,
            overlap: m.overlap,
            contact_radius,
            contact_radius_before: self.contact_radius,
            m_eff: self.effective_mass,
            relative_velocity: lanes(m.velocity),
            spin_velocity: lanes(m.spin_velocity),
            spin_sum: lanes(m.spin_sum),
        };
        let f = self.law.full_force::<f64, true, true>(&kinematics, lanes(self.history), self.time_step);
        let vector = |v: LaneVec3<f64>| Vec3::new(v.x, v.y, v.z);
        (self.history, self.contact_radius) = (vector(f.history), contact_radius);
        Forces { normal: f.normal, tangential: vector(f.tangential) }
    }
}

fn lanes(v: Vec3) -> LaneVec3<f64> {
    LaneVec3::new(v.x, v.y, v.z)
}
