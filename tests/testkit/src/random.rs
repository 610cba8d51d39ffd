//! Random numbers, the same in every run.

use grainlab_core::Vec3;
use nalgebra::Rotation3;

/// A 64-bit linear congruential generator.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Creates the generator of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns a number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a number between two others.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a normal number of mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// Returns a vector with components between −`scale` and `scale`.
    pub fn vector(&mut self, scale: f64) -> Vec3 {
        Vec3::from_fn(|_, _| self.between(-scale, scale))
    }

    /// Returns a rotation about an axis of any direction, by an angle of 0 to π.
    pub fn rotation(&mut self) -> Rotation3<f64> {
        let axis = Vec3::from_fn(|_, _| self.normal());
        Rotation3::new(axis.normalize() * std::f64::consts::PI * self.unit())
    }
}
