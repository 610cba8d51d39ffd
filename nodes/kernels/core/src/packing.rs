//! Grains, cell and contact network at one instant.

use crate::cell::Cell;
use crate::contact::ContactLaw;
use crate::material::{Material, effective_radius};
use crate::path::PathPosition;
use crate::tensor::{Mat3, SymTensor, Vec3};

/// One contact between two grains, or between a grain and a periodic image (its own, too).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the first grain.
    pub i: u32,
    /// Index of the second grain, `j ≥ i`.
    pub j: u32,
    /// Cell vectors added to the position of `j` to find the image that is touched.
    pub image: [i8; 3],
    /// Full overlap R_i + R_j − |l|, m, positive.
    pub overlap: f64,
    /// Unit vector from `i` to the image of `j`.
    pub normal: Vec3,
    /// Elastic normal force, N, positive in compression.
    pub normal_force: f64,
    /// Tangential force on `i`, N, perpendicular to [`Contact::normal`].
    pub tangential_force: Vec3,
    /// Elastic rolling force, N, perpendicular to [`Contact::normal`]: R* n × this is a torque on `i`, and the opposite one a
    /// torque on `j` ([`RollingResistance`](crate::contact::RollingResistance)). Zero without resistance to rolling.
    pub rolling_force: Vec3,
}

/// Share of the Coulomb limit from which a contact counts as sliding.
const SLIDING: f64 = 0.999;

impl Contact {
    /// A contact of the grains `i` and `j` with this overlap, m, and normal force, N, and without any other force.
    pub fn pressed([i, j]: [u32; 2], image: [i8; 3], normal: Vec3, overlap: f64, normal_force: f64) -> Self {
        let (tangential_force, rolling_force) = (Vec3::zeros(), Vec3::zeros());
        Self { i, j, image, overlap, normal, normal_force, tangential_force, rolling_force }
    }

    /// This contact as one of the grains `i` and `j` and this image, or with the two exchanged: in the order of a packing.
    pub fn named(self, i: u32, j: u32, image: [i8; 3]) -> Self {
        if (i, [0; 3]) < (j, image) {
            return Self { i, j, image, ..self };
        }
        Self {
            i: j,
            j: i,
            image: image.map(|k| -k),
            normal: -self.normal,
            tangential_force: -self.tangential_force,
            rolling_force: -self.rolling_force,
            ..self
        }
    }

    /// True if the contact is at the Coulomb limit: |F_t| ≥ 0.999 μ F_n. Never true where there is no such limit
    /// (μ = 0 or infinite).
    pub fn slides(&self, friction: f64) -> bool {
        let limited = friction > 0.0 && friction.is_finite();
        limited && self.tangential_force.norm() >= SLIDING * friction * self.normal_force
    }
}

/// A packing of spheres: the mechanical state that is measured, displayed and resumed.
///
/// Built by [`Packing::validated`], which is what makes the fields safe to use as they are: `n = radii.len()` in every
/// per-grain vector, everything finite, indices in range, contacts sorted by `(i, j, image)`.
#[derive(Clone, Debug)]
pub struct Packing {
    /// Solver steps done.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// The periodic cell.
    pub cell: Cell,
    /// Deformation gradient since the reference state, or since the first step of a run until a phase sets one; all NaN for
    /// a packing that has neither ([`Packing::strain`]).
    pub deformation: Mat3,
    /// Persistent ids of the grains.
    pub ids: Vec<u32>,
    /// Radii of the grains, m.
    pub radii: Vec<f64>,
    /// Positions as held: unwrapped, not folded into the cell, m.
    pub positions: Vec<Vec3>,
    /// Velocities relative to the affine motion, m/s.
    pub velocities: Vec<Vec3>,
    /// Angular velocities, rad/s.
    pub spins: Vec<Vec3>,
    /// Contacts with positive overlap, sorted by `(i, j, image)`.
    pub contacts: Vec<Contact>,
    /// Material of every grain.
    pub material: Material,
    /// Contact law of the grains.
    pub law: ContactLaw,
    /// Friction coefficient in force; may be infinite.
    pub friction: f64,
    /// Time step in force, s; 0 if the packing was not made by a simulation of ours.
    pub time_step: f64,
    /// Position on the loading path of its run; `None`: the packing is of no run.
    pub path: Option<PathPosition>,
}

/// Field by field; two deformations without a reference state are equal, although NaN is not.
impl PartialEq for Packing {
    fn eq(&self, other: &Self) -> bool {
        let Self { step, time, cell, deformation, ids, radii, positions, velocities, spins, .. } = self;
        let Self { contacts, material, law, friction, time_step, path, .. } = self;
        let o = other;
        let unknown = |f: &Mat3| f.iter().all(|v| v.is_nan());
        (*deformation == o.deformation || unknown(deformation) && unknown(&o.deformation))
            && (*step, *time, cell, ids) == (o.step, o.time, &o.cell, &o.ids)
            && (radii, positions, velocities, spins) == (&o.radii, &o.positions, &o.velocities, &o.spins)
            && (contacts, material, law) == (&o.contacts, &o.material, &o.law)
            && (*friction, *time_step, path) == (o.friction, o.time_step, &o.path)
    }
}

/// Why a set of numbers is not a packing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A per-grain array has the wrong length.
    #[error("{field} has {found} entries, but there are {expected} grains")]
    Length {
        /// Name of the array.
        field: &'static str,
        /// Entries it should have.
        expected: usize,
        /// Entries it has.
        found: usize,
    },
    /// A number is not finite.
    #[error("{field}[{index}] is not finite ({value})")]
    NotFinite {
        /// Name of the quantity.
        field: &'static str,
        /// Index of the grain or contact.
        index: usize,
        /// The value found.
        value: f64,
    },
    /// A number is out of its range.
    #[error("{field}[{index}] = {value:e} is out of range: {requirement}")]
    Range {
        /// Name of the quantity.
        field: &'static str,
        /// Index of the grain or contact; 0 for a quantity of the whole packing.
        index: usize,
        /// The value found.
        value: f64,
        /// Range that is required.
        requirement: &'static str,
    },
    /// A contact names a grain that does not exist.
    #[error("contact {contact} names grain {grain}, but there are {grains} grains (indices count from 0)")]
    GrainIndex {
        /// Index of the contact.
        contact: usize,
        /// The index it holds.
        grain: u32,
        /// Number of grains.
        grains: usize,
    },
    /// An id occurs twice.
    #[error("grains {first} and {second} have the same id {id} (indices count from 0)")]
    DuplicateId {
        /// The id that both have.
        id: u32,
        /// Index of the first grain with it.
        first: u32,
        /// Index of the second.
        second: u32,
    },
    /// A contact does not belong to the positions and radii.
    #[error(
        "{quantity} of the contact of grains {i} and {j} is {given:e}, but positions and radii give {found:e}: contacts and positions \
         are not of the same state"
    )]
    Contradiction {
        /// Id of the first grain.
        i: u32,
        /// Id of the second grain.
        j: u32,
        /// Quantity that disagrees, with its unit.
        quantity: &'static str,
        /// As the contact has it.
        given: f64,
        /// As positions and radii have it.
        found: f64,
    },
    /// Normals point from the second grain of a contact to the first.
    #[error(
        "the normals of {reversed} of {contacts} contacts point the wrong way, the first of grains {i} and {j}: a normal points from the \
         centre of the first grain to the one of the second; reverse these normals"
    )]
    ReversedNormal {
        /// Id of the first grain of the first such contact.
        i: u32,
        /// Id of the second grain.
        j: u32,
        /// Number of contacts whose normal points the wrong way.
        reversed: usize,
        /// Number of contacts.
        contacts: usize,
    },
    /// A normal force is far beyond the contact law.
    #[error(
        "the normal force of the contact of grains {i} and {j}, {force:.4e} N, is {:.0} times that of {law} contacts at its overlap \
         ({law_force:.4e} N): it belongs to another contact law, to another material, or to another state than the positions",
        (force / law_force).abs()
    )]
    Force {
        /// Id of the first grain.
        i: u32,
        /// Id of the second grain.
        j: u32,
        /// Normal force, N, as the contact has it.
        force: f64,
        /// Name of the contact law.
        law: &'static str,
        /// Normal force, N, of the law at this overlap.
        law_force: f64,
    },
    /// Contacts are not strictly sorted by (i, j, image) with i ≤ j.
    #[error(
        "contact {contact} is out of order: contacts must be sorted by i, j, image, with i <= j and no duplicates"
    )]
    ContactOrder {
        /// Index of the first contact out of order.
        contact: usize,
    },
}

impl Packing {
    /// Glass spheres at rest with the ids 0, 1, 2, …, without contacts, friction and history.
    pub fn at_rest(cell: Cell, radii: Vec<f64>, positions: Vec<Vec3>) -> Self {
        let n = radii.len();
        Self {
            step: 0,
            time: 0.0,
            cell,
            deformation: Mat3::identity(),
            ids: (0..n as u32).collect(),
            radii,
            positions,
            velocities: vec![Vec3::zeros(); n],
            spins: vec![Vec3::zeros(); n],
            contacts: Vec::new(),
            material: Material::GLASS,
            law: ContactLaw::default(),
            friction: 0.0,
            time_step: 0.0,
            path: None,
        }
    }

    /// The packing itself if it is one, else the first fault found.
    pub fn validated(self) -> Result<Self, PackingError> {
        self.check().map(|()| self)
    }

    /// Checks that it is a packing: the first fault found.
    pub fn check(&self) -> Result<(), PackingError> {
        let n = self.radii.len();
        for (field, found) in [
            ("id", self.ids.len()),
            ("position", self.positions.len()),
            ("velocity", self.velocities.len()),
            ("angular_velocity", self.spins.len()),
        ] {
            if found != n {
                return Err(PackingError::Length { field, expected: n, found });
            }
        }
        let m = &self.material;
        positive("shear_modulus", 0, m.shear_modulus)?;
        positive("density", 0, m.density)?;
        finite("poisson_ratio", 0, m.poisson_ratio)?;
        if !(0.0..=0.5).contains(&m.poisson_ratio) {
            return Err(range("poisson_ratio", 0, m.poisson_ratio, "between 0 and 0.5"));
        }
        if self.friction.is_nan() || self.friction < 0.0 {
            return Err(range("friction", 0, self.friction, "0 or more"));
        }
        finite("time", 0, self.time)?;
        finite("time_step", 0, self.time_step)?;
        if self.time_step < 0.0 {
            return Err(range("time_step", 0, self.time_step, "0 or more"));
        }
        if !self.deformation.iter().all(|v| v.is_nan()) {
            for v in self.deformation.iter() {
                finite("deformation", 0, *v)?;
            }
            let stretch = self.deformation.determinant();
            if stretch <= 0.0 {
                return Err(range("deformation", 0, stretch, "a positive determinant"));
            }
        }
        for i in 0..n {
            positive("radius", i, self.radii[i])?;
            finite3("position", i, &self.positions[i])?;
            finite3("velocity", i, &self.velocities[i])?;
            finite3("angular_velocity", i, &self.spins[i])?;
        }
        self.check_contacts()
    }

    fn check_contacts(&self) -> Result<(), PackingError> {
        let n = self.grains();
        for (index, c) in self.contacts.iter().enumerate() {
            for grain in [c.i, c.j] {
                if grain as usize >= n {
                    return Err(PackingError::GrainIndex { contact: index, grain, grains: n });
                }
            }
            let key = |c: &Contact| (c.i, c.j, c.image);
            if c.i > c.j || (index > 0 && key(&self.contacts[index - 1]) >= key(c)) {
                return Err(PackingError::ContactOrder { contact: index });
            }
            positive("contact_overlap", index, c.overlap)?;
            finite("contact_normal_force", index, c.normal_force)?;
            finite3("contact_normal", index, &c.normal)?;
            if (c.normal.norm_squared() - 1.0).abs() > 1e-9 {
                return Err(range("contact_normal", index, c.normal.norm(), "a unit vector"));
            }
            finite3("contact_tangential_force", index, &c.tangential_force)?;
            finite3("contact_rolling_force", index, &c.rolling_force)?;
            if self.law.rolling.is_none() && c.rolling_force != Vec3::zeros() {
                let requirement = "0: the contact law has no resistance to rolling";
                return Err(range("contact_rolling_force", index, c.rolling_force.norm(), requirement));
            }
        }
        Ok(())
    }

    /// Number of grains.
    pub fn grains(&self) -> usize {
        self.radii.len()
    }

    /// Memory of its grains and contacts, bytes.
    pub fn bytes(&self) -> usize {
        let grain = size_of::<u32>() + size_of::<f64>() + 3 * size_of::<Vec3>();
        self.grains() * grain + self.contacts.len() * size_of::<Contact>()
    }

    /// The deformation of a packing without a reference state.
    pub fn no_reference() -> Mat3 {
        Mat3::repeat(f64::NAN)
    }

    /// Logarithmic strain of the deformation, positive in extension; `None` without a reference state.
    pub fn strain(&self) -> Option<SymTensor> {
        let known = self.deformation.iter().all(|v| !v.is_nan());
        known.then(|| SymTensor::logarithmic_strain(&self.deformation))
    }

    /// Solid fraction φ: volume of the spheres over volume of the cell.
    pub fn solid_fraction(&self) -> f64 {
        let solid: f64 = self.radii.iter().map(|r| r.powi(3)).sum();
        4.0 / 3.0 * std::f64::consts::PI * solid / self.cell.volume()
    }

    /// Standard deviation of the radii over their mean; 0 for equal grains.
    pub fn size_spread(&self) -> f64 {
        let count = self.radii.len() as f64;
        let mean = self.radii.iter().sum::<f64>() / count;
        let variance = self.radii.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / count;
        // Rounding of the mean alone does not make grains unequal.
        let spread = variance.sqrt() / mean;
        if spread > 1e-12 { spread } else { 0.0 }
    }

    /// Branch vector of a contact, from the centre of `i` to the centre of the image of `j`, m.
    pub fn branch(&self, c: &Contact) -> Vec3 {
        self.positions[c.j as usize] - self.positions[c.i as usize] + self.cell.shift(c.image)
    }

    /// Fraction of contacts that [slide](Contact::slides); 0 without contacts, and without a Coulomb limit (μ = 0 or infinite).
    pub fn sliding_fraction(&self) -> f64 {
        let sliding = self.contacts.iter().filter(|c| c.slides(self.friction)).count();
        sliding as f64 / self.contacts.len().max(1) as f64
    }

    /// Effective radius R* of a contact, m.
    pub fn effective_radius(&self, c: &Contact) -> f64 {
        effective_radius(self.radii[c.i as usize], self.radii[c.j as usize])
    }

    /// Contact stiffnesses (k_n, k_t) at the present overlap, N/m.
    pub fn contact_stiffness(&self, c: &Contact) -> (f64, f64) {
        self.law.springs.stiffnesses(&self.material, self.effective_radius(c), c.overlap)
    }
}

fn finite(field: &'static str, index: usize, value: f64) -> Result<(), PackingError> {
    if value.is_finite() { Ok(()) } else { Err(PackingError::NotFinite { field, index, value }) }
}

fn finite3(field: &'static str, index: usize, v: &Vec3) -> Result<(), PackingError> {
    v.iter().try_for_each(|x| finite(field, index, *x))
}

fn positive(field: &'static str, index: usize, value: f64) -> Result<(), PackingError> {
    finite(field, index, value)?;
    if value > 0.0 { Ok(()) } else { Err(range(field, index, value, "more than 0")) }
}

fn range(field: &'static str, index: usize, value: f64, requirement: &'static str) -> PackingError {
    PackingError::Range { field, index, value, requirement }
}

mod copies;
#[cfg(test)]
mod pair;

#[cfg(test)]
mod tests {
    use super::pair::pair;
    use super::*;

    #[test]
    fn a_packing_without_a_reference_state_has_no_strain_and_part_of_one_is_refused() {
        assert_eq!(pair().strain(), Some(SymTensor::default()));
        let mut p = Packing { deformation: Packing::no_reference(), ..pair() };
        assert_eq!(p.clone().validated().unwrap().strain(), None);
        assert!(p == p.clone() && p != pair() && p != Packing { step: 1, ..p.clone() });
        p.deformation[(2, 1)] = 0.0;
        assert!(p.validated().is_err());
    }

    #[test]
    fn branch_crosses_the_periodic_boundary() {
        let p = pair().validated().unwrap();
        assert!((p.branch(&p.contacts[0]) - Vec3::new(0.0, 0.0, -0.1)).norm() < 1e-15);
    }

    #[test]
    fn faults_are_named_with_field_and_index() {
        let mut p = pair();
        p.contacts[0].j = 7;
        assert_eq!(p.validated(), Err(PackingError::GrainIndex { contact: 0, grain: 7, grains: 2 }));
        let mut p = pair();
        p.positions[1].y = f64::INFINITY;
        let message = p.validated().unwrap_err().to_string();
        assert_eq!(message, "position[1] is not finite (inf)");
        let mut p = pair();
        p.spins.pop();
        assert_eq!(
            p.validated(),
            Err(PackingError::Length { field: "angular_velocity", expected: 2, found: 1 })
        );
        let mut p = pair();
        p.friction = -0.1;
        assert!(p.validated().is_err());
        let mut p = pair();
        p.contacts.push(p.contacts[0]);
        assert_eq!(p.validated(), Err(PackingError::ContactOrder { contact: 1 }));
    }
}
