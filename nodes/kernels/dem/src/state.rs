//! Grains and cell in structure-of-arrays form.

use grains::{Cell, Mat3, Material, Vec3};

/// A vector per grain (or per contact), one array a component.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soa {
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
}

impl Soa {
    pub(crate) fn zeros(n: usize) -> Self {
        Self { x: vec![0.0; n], y: vec![0.0; n], z: vec![0.0; n] }
    }

    pub(crate) fn from_vectors(v: &[Vec3]) -> Self {
        let component = |k: usize| v.iter().map(|a| a[k]).collect();
        Self { x: component(0), y: component(1), z: component(2) }
    }

    pub(crate) fn vectors(&self) -> Vec<Vec3> {
        (0..self.x.len()).map(|i| self.get(i)).collect()
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, i: usize, v: Vec3) {
        self.x[i] += v.x;
        self.y[i] += v.y;
        self.z[i] += v.z;
    }

    pub(crate) fn fill(&mut self, value: f64) {
        self.x.fill(value);
        self.y.fill(value);
        self.z.fill(value);
    }

    pub(crate) fn push(&mut self, v: Vec3) {
        self.x.push(v.x);
        self.y.push(v.y);
        self.z.push(v.z);
    }
}

/// Everything that moves.
///
/// Positions are those of step n, velocities and spins those that led there (step n − 1/2): the stage at which forces
/// are evaluated, so that a saved state needs nothing else to go on exactly.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) time_step: f64,
    pub(crate) cell: Cell,
    /// Strain rate in force, 1/s, symmetric.
    pub(crate) rate: Mat3,
    pub(crate) material: Material,
    pub(crate) ids: Vec<u32>,
    pub(crate) radius: Vec<f64>,
    pub(crate) inverse_mass: Vec<f64>,
    pub(crate) inverse_inertia: Vec<f64>,
    pub(crate) position: Soa,
    pub(crate) velocity: Soa,
    pub(crate) spin: Soa,
    pub(crate) force: Soa,
    pub(crate) torque: Soa,
}

impl State {
    pub(crate) fn new(
        cell: Cell,
        material: Material,
        ids: Vec<u32>,
        radius: Vec<f64>,
        position: &[Vec3],
    ) -> Self {
        let n = radius.len();
        let mass = |r: &f64| material.sphere_mass(*r);
        Self {
            step: 0,
            time: 0.0,
            time_step: 0.0,
            cell,
            rate: Mat3::zeros(),
            material,
            ids,
            inverse_mass: radius.iter().map(|r| 1.0 / mass(r)).collect(),
            inverse_inertia: radius.iter().map(|r| 1.0 / (0.4 * mass(r) * r * r)).collect(),
            radius,
            position: Soa::from_vectors(position),
            velocity: Soa::zeros(n),
            spin: Soa::zeros(n),
            force: Soa::zeros(n),
            torque: Soa::zeros(n),
        }
    }

    pub(crate) fn grains(&self) -> usize {
        self.radius.len()
    }

    pub(crate) fn largest_radius(&self) -> f64 {
        self.radius.iter().copied().fold(0.0, f64::max)
    }

    /// Mean of v² over grains, m²/s².
    pub(crate) fn mean_square_speed(&self) -> f64 {
        let v = &self.velocity;
        let sum: f64 = (0..self.grains()).map(|i| v.x[i] * v.x[i] + v.y[i] * v.y[i] + v.z[i] * v.z[i]).sum();
        sum / self.grains() as f64
    }
}
