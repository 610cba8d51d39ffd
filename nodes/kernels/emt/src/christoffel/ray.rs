//! One speed seen from the axis: which way the wave runs, how the grains move, and what a medium says to that.

use super::ChristoffelError;
use grainlab_core::{Vec3, WaveSpeed};
use nalgebra::SVector;

/// Number of moduli that fix a transversely isotropic medium.
pub(super) const UNKNOWNS: usize = 5;

/// C11, C33, C13, C44 and C66 over the density, m²/s², or a change of something with each of them.
pub(super) type Column = SVector<f64, UNKNOWNS>;

/// Least cos² of the angle between the motion measured and that of the mode it is taken for: 30°.
const CLEAR: f64 = 0.75;

/// sin² of the angle between direction and axis up to which the two S modes are one: their ρ v² differ by less than this
/// share of the anisotropy (1.8°).
const AXIAL: f64 = 1e-3;

/// One speed, in the frame of the plane that holds axis and direction. The direction is (sin θ, 0, cos θ) with θ from 0
/// to a right angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// v, m/s.
    pub(super) speed: f64,
    /// Its standard deviation over v.
    pub(super) error: Option<f64>,
    sin: f64,
    cos: f64,
    /// Unit particle motion: across the axis in the plane, across the plane, along the axis.
    motion: [f64; 3],
    /// Whether it is the S mode that moves across the plane.
    horizontal: bool,
    /// Whether it is one of two S modes, both measured, that are turned from those of the medium: its v² is theirs, each by
    /// its share of the motion. Of a medium that is nearly isotropic about the axis that holds to first order.
    mixed: bool,
    /// Whether direction and motion alone say which mode it is: in no packing are the modes turned far from theirs in an
    /// isotropic medium.
    pub(super) named: bool,
}

/// What a medium says to a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    /// v² of the mode meant, m²/s².
    pub(super) square: f64,
    /// Its slope with each specific modulus.
    pub(super) slopes: Column,
    /// cos² of the angle between the motion measured and the mode's.
    pub(super) share: f64,
}

impl Ray {
    /// Checks one measured speed; `axis` is a unit vector. A motion between two modes is refused, unless these are the S
    /// modes and both were measured (`paired`).
    pub(super) fn new(
        index: usize,
        measured: &WaveSpeed,
        axis: &Vec3,
        paired: bool,
    ) -> Result<Self, ChristoffelError> {
        let (ray, share) = Self::about(index, measured, axis)?;
        if is_clear(share) {
            Ok(ray)
        } else if paired && ray.is_transverse() {
            Ok(ray.mixed())
        } else {
            Err(ambiguous(index, share))
        }
    }

    /// The same about an axis that may be the wrong one, where a motion may well be between two modes: it is taken for the
    /// nearest. With cos² of the angle to the nearest that the direction has in some medium.
    pub(super) fn about(
        index: usize,
        measured: &WaveSpeed,
        axis: &Vec3,
    ) -> Result<(Self, f64), ChristoffelError> {
        let WaveSpeed { direction, polarization, speed, stddev } = *measured;
        if !(speed > 0.0 && speed.is_finite()) {
            return Err(ChristoffelError::Speed { index, value: speed });
        }
        if let Some(value) = stddev
            && !(value > 0.0 && value.is_finite())
        {
            return Err(ChristoffelError::SpeedStddev { index, value });
        }
        let mut n = unit(&direction, || format!("speeds[{index}].direction"))?;
        let p = unit(&polarization, || format!("speeds[{index}].polarization"))?;
        if n.dot(axis) < 0.0 {
            n = -n;
        }
        let cos = n.dot(axis).min(1.0);
        let across = n - cos * axis;
        let sin = across.norm();
        // Along the axis every plane will do: the one that the grains move in.
        let radial = (across.try_normalize(1e-9))
            .or_else(|| (p - p.dot(axis) * axis).try_normalize(1e-9))
            .unwrap_or_else(|| axis.cross(&least(axis)).normalize());
        let motion = [p.dot(&radial), p.dot(&axis.cross(&radial)), p.dot(axis)];
        let [radially, across, axially] = motion.map(|m| m * m);
        let along = p.dot(&n).powi(2);
        let upright = radially + axially - along;
        let is_axial = sin * sin <= AXIAL;
        // Along the axis the two S modes are one.
        let shear = if is_axial { upright + across } else { upright.max(across) };
        let nearest = along.max(shear);
        let named = is_clear(nearest);
        // Between the axes the medium may have turned the modes in the plane.
        let is_turned = !is_axial && cos * cos > AXIAL && is_clear(along + upright);
        let horizontal = across > radially.max(axially);
        let error = stddev.map(|s| s / speed);
        let ray = Self { speed, error, sin, cos, motion, horizontal, mixed: false, named };
        Ok((ray, if is_turned { 1.0 } else { nearest }))
    }

    /// The same as one of two S modes that may be turned from those of the medium.
    pub(super) fn mixed(self) -> Self {
        Self { mixed: true, named: true, ..self }
    }

    /// cos² of the angle between motion and direction.
    fn along(&self) -> f64 {
        (self.sin * self.motion[0] + self.cos * self.motion[2]).powi(2)
    }

    /// Whether the grains move more along the direction than across it.
    pub(super) fn is_compressional(&self) -> bool {
        self.along() > 0.5
    }

    /// Whether they move clearly across it.
    pub(super) fn is_transverse(&self) -> bool {
        is_clear(1.0 - self.along())
    }

    /// Whether the motion of the mode, and with it v², hangs on C13 and on how the moduli compare.
    pub(super) fn is_coupled(&self) -> bool {
        (self.mixed || !self.horizontal) && (self.sin * self.cos).powi(2) > AXIAL
    }

    /// v² of a mode with exactly the motion measured, as a sum over the specific moduli: p·Γ p/ρ.
    pub(super) fn slopes_of_motion(&self) -> Column {
        let [radial, across, axial] = self.motion;
        let mut slopes = self.slopes_in_plane(radial, axial);
        slopes += across * across * self.slopes_across();
        slopes
    }

    /// The mode that the motion measured is nearest to; `None` if it has no speed in this medium.
    ///
    /// Across the plane, v² = C66 sin²θ + C44 cos²θ over ρ. In it, the eigenvalues of
    /// `[[C11 sin² + C44 cos², (C13 + C44) sin cos], [., C44 sin² + C33 cos²]]` over ρ.
    pub(super) fn answer(&self, specific: &Column) -> Option<Answer> {
        let (radial, axial) = self.nearest_in_plane(specific);
        if self.mixed {
            let across = self.motion[1].powi(2) / (1.0 - self.along());
            let slopes = across * self.slopes_across() + (1.0 - across) * self.slopes_in_plane(radial, axial);
            let square = slopes.dot(specific);
            return (square > 0.0).then_some(Answer { square, slopes, share: 1.0 });
        }
        let in_plane = (radial * self.motion[0] + axial * self.motion[2]).powi(2);
        let (slopes, mut share) = if self.horizontal {
            (self.slopes_across(), self.motion[1].powi(2))
        } else {
            (self.slopes_in_plane(radial, axial), in_plane)
        };
        // Near the axis the two S modes are one.
        if self.sin * self.sin <= AXIAL && !self.is_compressional() {
            let upright = if self.horizontal { self.motion[0].powi(2) } else { self.motion[1].powi(2) };
            share += upright;
        }
        // v² is of first degree in the moduli, so that its slopes give it.
        let square = slopes.dot(specific);
        (square > 0.0).then_some(Answer { square, slopes, share })
    }

    /// Motion, across and along the axis, of that mode in the plane which the motion measured is nearest to.
    fn nearest_in_plane(&self, specific: &Column) -> (f64, f64) {
        let [c11, c33, c13, c44, _] = specific.data.0[0];
        let (s2, c2) = (self.sin * self.sin, self.cos * self.cos);
        let half_difference = 0.5 * ((c11 - c44) * s2 - (c33 - c44) * c2);
        let coupling = (c13 + c44) * self.sin * self.cos;
        // The stiffer mode moves at this angle from the plane of isotropy.
        let (sin, cos) = (0.5 * coupling.atan2(half_difference)).sin_cos();
        let [radial, axial] = if self.mixed {
            // An S mode, whatever little of the motion is in the plane.
            [self.cos, -self.sin]
        } else {
            [self.motion[0], self.motion[2]]
        };
        if (cos * radial + sin * axial).abs() >= (cos * axial - sin * radial).abs() {
            (cos, sin)
        } else {
            (-sin, cos)
        }
    }

    fn slopes_in_plane(&self, radial: f64, axial: f64) -> Column {
        let (s, c) = (self.sin, self.cos);
        let mixed = 2.0 * radial * axial * s * c;
        Column::from([
            (radial * s).powi(2),
            (axial * c).powi(2),
            mixed,
            (radial * c).powi(2) + (axial * s).powi(2) + mixed,
            0.0,
        ])
    }

    fn slopes_across(&self) -> Column {
        Column::from([0.0, 0.0, 0.0, self.cos * self.cos, self.sin * self.sin])
    }
}

/// Of every speed, whether it is one of two S modes of its direction that were both measured: with motions perpendicular to
/// each other and to it.
pub(super) fn paired(speeds: &[WaveSpeed]) -> Vec<bool> {
    const ALIKE: f64 = 1e-3;
    const PERPENDICULAR: f64 = 0.1;
    let across = |s: &WaveSpeed| is_clear(1.0 - s.direction.dot(&s.polarization).powi(2));
    let is_pair = |a: &WaveSpeed, b: &WaveSpeed| {
        a.direction.cross(&b.direction).norm_squared() < ALIKE
            && a.polarization.dot(&b.polarization).powi(2) < PERPENDICULAR
    };
    speeds.iter().map(|a| across(a) && speeds.iter().any(|b| across(b) && is_pair(a, b))).collect()
}

/// Whether a motion with this cos² of the angle to a mode's is that mode's.
pub(super) fn is_clear(share: f64) -> bool {
    share >= CLEAR
}

/// What to say to a motion with this cos² of the angle to the nearest mode's.
pub(super) fn ambiguous(index: usize, share: f64) -> ChristoffelError {
    ChristoffelError::Ambiguous { index, degrees: share.max(0.0).sqrt().acos().to_degrees() }
}

/// The vector at exactly unit length, if it has it to the rounding of a file or a message.
pub(super) fn unit(vector: &Vec3, name: impl FnOnce() -> String) -> Result<Vec3, ChristoffelError> {
    let length = vector.norm();
    if (length - 1.0).abs() < 1e-6 {
        return Ok(vector / length);
    }
    Err(ChristoffelError::NotUnit { vector: name(), length })
}

/// The axis of the frame that `vector` has least of.
fn least(vector: &Vec3) -> Vec3 {
    let mut unit = Vec3::zeros();
    unit[vector.iamin()] = 1.0;
    unit
}
