//! A speed at several wavelengths, and what it goes to at long ones.

use grains::Vec3;

/// ρ v² at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Wave number |q|, rad/m.
    pub wavenumber: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Standard deviation of the speed, m/s.
    pub stddev: f64,
}

/// Speeds of one mode, and their limit by v² = v₀² (1 − b q² + …).
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Unit particle motion.
    pub motion: Vec3,
    /// Measured, longest wave first.
    pub points: Vec<Point>,
    /// Speed of long waves v₀, m/s.
    pub speed: f64,
    /// Its standard deviation: of the points, and of the law itself, m/s.
    pub stddev: f64,
    /// b, m².
    pub bend: f64,
}
