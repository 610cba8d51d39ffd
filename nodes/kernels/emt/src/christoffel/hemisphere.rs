//! Directions without sign: a direction and its opposite are the same.

use grainlab_core::{Vec3, WaveSpeed};

/// The direction furthest from all measured ones, among `count`.
pub(super) fn widest_gap(speeds: &[WaveSpeed], count: usize) -> Vec3 {
    let nearest = |n: &Vec3| speeds.iter().map(|s| s.direction.dot(n).abs()).fold(0.0, f64::max);
    hemisphere(count).min_by(|a, b| nearest(a).total_cmp(&nearest(b))).unwrap_or_else(Vec3::z)
}

/// Unit vectors spread evenly over the hemisphere (a spiral of the golden angle).
pub(super) fn hemisphere(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let z = (k as f64 + 0.5) / count as f64;
        let (sin, cos) = (std::f64::consts::TAU * k as f64 * 0.618_033_988_749_894_9).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        Vec3::new(flat * cos, flat * sin, z)
    })
}

/// Angle between two axes, from 0 to a right angle, rad.
pub(super) fn angle(a: &Vec3, b: &Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b).abs())
}

/// The axis or its opposite, with z ≥ 0.
pub(super) fn upward(axis: Vec3) -> Vec3 {
    if axis.z < 0.0 { -axis } else { axis }
}
