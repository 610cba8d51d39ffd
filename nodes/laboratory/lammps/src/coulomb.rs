//! Contacts at the Coulomb limit.

use grainlab_core::{Contact, Mat3, Packing, Vec3};
use grainlab_engine::EngineSettings;

/// Times that the velocities of the last step are improved: each leaves about a tenth of their error.
const ROUNDS: usize = 8;

/// Share of the limit from which a contact slides. Dashpots are computed again from velocities of a look at the state, so that the
/// share of a sliding contact is not 1 to the last digit.
const SLIDING: f64 = 0.998;

/// The friction that acted in the last steps.
///
/// LAMMPS limits the tangential force with its dashpot to a fraction of the normal force with its dashpot. The elastic part of a
/// sliding contact is therefore below or above the fraction of the elastic normal force that our engine limits it to, by up to
/// some per cent, and does not show whether the contact slides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coulomb {
    friction: f64,
    damping: f64,
    /// Velocity gradient of the affine motion, 1/s.
    affine: Mat3,
}

/// Velocities of all grains, relative to the affine motion.
struct Motion {
    velocities: Vec<Vec3>,
    spins: Vec<Vec3>,
}

impl Coulomb {
    /// The friction of steps under these settings at this strain rate, 1/s.
    pub(crate) fn of_steps(settings: &EngineSettings, rate: &Mat3) -> Self {
        Self { friction: settings.friction, damping: settings.damping, affine: *rate }
    }

    /// Returns the contacts with their elastic tangential forces as our engine has them: at the limit where a contact slides in
    /// LAMMPS, and never beyond.
    pub(crate) fn limited(&self, packing: &Packing, contacts: Vec<Contact>) -> Vec<Contact> {
        let motion = (self.damping > 0.0).then(|| self.motion_of_forces(packing, &contacts));
        let slides = |c: &Contact| motion.as_ref().is_some_and(|motion| self.slides(packing, motion, c));
        let limited = |c: Contact| {
            let (force, limit) = (c.tangential_force.norm(), self.friction * c.normal_force);
            if force > limit || (force > 0.0 && slides(&c)) {
                return Contact { tangential_force: c.tangential_force * (limit / force), ..c };
            }
            c
        };
        contacts.into_iter().map(limited).collect()
    }

    /// Returns the velocities that the dashpots of the last step had. Those of the packing are half a step before its positions by
    /// elastic forces alone, which leaves the impulse of the dashpots in half a step.
    fn motion_of_forces(&self, packing: &Packing, contacts: &[Contact]) -> Motion {
        let half = 0.5 * packing.time_step;
        let mut motion = Motion { velocities: packing.velocities.clone(), spins: packing.spins.clone() };
        for _ in 0..ROUNDS {
            let mut next = Motion { velocities: packing.velocities.clone(), spins: packing.spins.clone() };
            for c in contacts {
                let (normal_force, tangential_force) = self.whole_force(packing, &motion, c);
                let across = tangential_force - c.tangential_force;
                let force = across - c.normal * (normal_force - c.normal_force);
                for (grain, sign) in [(c.i as usize, 1.0), (c.j as usize, -1.0)] {
                    let radius = packing.radii[grain];
                    let share = half / packing.material.sphere_mass(radius);
                    next.velocities[grain] -= force * (sign * share);
                    next.spins[grain] -= c.normal.cross(&across) * (share / (0.4 * radius));
                }
            }
            motion = next;
        }
        motion
    }

    /// Returns the normal and the tangential force with their dashpots, N.
    fn whole_force(&self, packing: &Packing, motion: &Motion, contact: &Contact) -> (f64, Vec3) {
        let [i, j] = [contact.i, contact.j].map(|grain| grain as usize);
        let [a, b] = [i, j].map(|grain| packing.material.sphere_mass(packing.radii[grain]));
        let (normal_stiffness, tangential_stiffness) = packing.contact_stiffness(contact);
        let dashpot = 2.0 * self.damping * (a * b / (a + b) * normal_stiffness).sqrt();
        let share = (tangential_stiffness / normal_stiffness).sqrt();
        let n = contact.normal;
        let affine = self.affine * packing.branch(contact);
        let velocity = motion.velocities[i] - motion.velocities[j] - affine;
        let rolling = motion.spins[i] * packing.radii[i] + motion.spins[j] * packing.radii[j];
        let approach = velocity.dot(&n);
        let slip = velocity - n * approach + rolling.cross(&n);
        let normal_force = (contact.normal_force + dashpot * approach).max(0.0);
        (normal_force, contact.tangential_force - slip * (dashpot * share))
    }

    /// Returns true if the forces of the contact, dashpots included, are at the limit. Without a normal force there is none.
    fn slides(&self, packing: &Packing, motion: &Motion, contact: &Contact) -> bool {
        let (normal_force, tangential_force) = self.whole_force(packing, motion, contact);
        normal_force > 0.0 && tangential_force.norm() >= SLIDING * self.friction * normal_force
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::Cell;

    /// Expected: of two forces that differ by less than their dashpots, the one is at the limit and the other is not.
    #[test]
    fn a_contact_slides_where_its_forces_with_dashpots_are_at_the_limit() {
        let settings = EngineSettings { friction: 0.3, damping: 0.3, ..EngineSettings::default() };
        let (radius, n) = (1e-4, Vec3::x());
        let positions = vec![Vec3::repeat(5e-4), Vec3::repeat(5e-4) + n * 1.99 * radius];
        let mut packing = Packing {
            velocities: vec![Vec3::new(-2e-2, 0.2, 0.0), Vec3::zeros()],
            ..Packing::at_rest(Cell::cube(1e-3).unwrap(), vec![radius; 2], positions)
        };
        let overlap = 0.01 * radius;
        let elastic = packing.law.normal_force(&packing.material, radius / 2.0, overlap);
        let contact = Contact::pressed([0, 1], [0; 3], n, overlap, elastic);
        let (k_n, k_t) = packing.contact_stiffness(&contact);
        let dashpot = 0.6 * (0.5 * packing.material.sphere_mass(radius) * k_n).sqrt();
        // Grains that separate: the limit is lower, and the dashpot takes its share of it.
        let limit = 0.3 * (elastic - 2e-2 * dashpot);
        let sliding = -(limit - 0.2 * dashpot * (k_t / k_n).sqrt());
        let of_limit = sliding.abs() / (0.3 * elastic);
        assert!(of_limit < 0.97, "{of_limit}");
        let coulomb = Coulomb::of_steps(&settings, &Mat3::zeros());
        let limited = |coulomb: &Coulomb, packing: &Packing, force: f64| {
            let contact = Contact { tangential_force: Vec3::y() * force, ..contact };
            coulomb.limited(packing, vec![contact])[0].tangential_force.y / (0.3 * elastic)
        };
        assert!((limited(&coulomb, &packing, sliding) + 1.0).abs() < 1e-12);
        let stuck = 0.99 * sliding;
        assert!((limited(&coulomb, &packing, stuck) - stuck / (0.3 * elastic)).abs() < 1e-12);
        // At rest it does not slide. A shear of the cell slides it as a grain that moves does.
        packing.velocities[0] = Vec3::zeros();
        assert!((limited(&coulomb, &packing, sliding) + of_limit).abs() < 1e-12);
        let mut rate = Mat3::zeros();
        (rate[(0, 0)], rate[(1, 0)]) = (2e-2 / (1.99 * radius), -0.2 / (1.99 * radius));
        let sheared = Coulomb::of_steps(&settings, &rate);
        assert!((limited(&sheared, &packing, sliding) + 1.0).abs() < 1e-12);
    }
}
