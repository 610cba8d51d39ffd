//! One speed in the frame of the axis: direction, polarization, and the speed predicted by a medium.

use super::error::ChristoffelError;
use grainlab_core::{Vec3, WaveSpeed};
use nalgebra::SVector;

/// Number of moduli of a transversely isotropic medium.
pub(super) const UNKNOWNS: usize = 5;

/// C11, C33, C13, C44 and C66 over the density, m²/s², or derivatives with respect to them.
pub(super) type Column = SVector<f64, UNKNOWNS>;

/// Least cos² of the angle between the measured polarization and that of its mode: 30°.
const CLEAR: f64 = 0.75;

/// sin² of the angle between direction and axis up to which the two S modes count as degenerate: their ρ v² differ by
/// less than this fraction of the anisotropy (1.8°).
const AXIAL: f64 = 1e-3;

/// One speed, in the frame of the plane of axis and direction. The direction is (sin θ, 0, cos θ) with θ from 0 to a
/// right angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// Measured speed, m/s.
    pub(super) speed: f64,
    /// Standard deviation of the speed over it.
    pub(super) error: Option<f64>,
    sin: f64,
    cos: f64,
    /// Unit polarization: components across the axis in the plane, across the plane, along the axis.
    motion: [f64; 3],
    /// True for the S mode polarized across the plane.
    horizontal: bool,
    /// True for one of two S modes, both measured, that are turned from those of the medium. v² is then the
    /// mean of theirs, weighted by the squared components of the polarization: exact to first order for a nearly
    /// isotropic medium.
    mixed: bool,
    /// True if direction and polarization alone identify the mode: in a packing the modes are close to those of an
    /// isotropic medium.
    pub(super) named: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Response {
    /// v² of the mode, m²/s².
    pub(super) square: f64,
    /// Derivatives of v² with respect to the specific moduli.
    pub(super) slopes: Column,
    /// cos² of the angle between the measured polarization and that of the mode.
    pub(super) share: f64,
}

impl Ray {
    /// Checks one measured speed; `axis` is a unit vector. A polarization between two modes is an error, unless these
    /// are the S modes and both were measured (`paired`).
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

    /// Checks a speed about a trial axis: a polarization between two modes is assigned to the nearest one. Also
    /// returns cos² of the angle to the nearest polarization that the direction has in any medium.
    pub(super) fn about(
        index: usize,
        measured: &WaveSpeed,
        axis: &Vec3,
    ) -> Result<(Self, f64), ChristoffelError> {
        let WaveSpeed { direction, polarization, speed, stddev } = *measured;
        let of_speed = "m/s must be positive and finite: leave out what was not measured";
        number(speed > 0.0, || format!("speeds[{index}].speed"), speed, of_speed)?;
        if let Some(value) = stddev {
            let of_stddev = "m/s must be positive and finite, or not known";
            number(value > 0.0, || format!("speeds[{index}].stddev"), value, of_stddev)?;
        }
        let mut n = unit(&direction, || format!("speeds[{index}].direction"))?;
        let p = unit(&polarization, || format!("speeds[{index}].polarization"))?;
        if n.dot(axis) < 0.0 {
            n = -n;
        }
        let cos = n.dot(axis).min(1.0);
        let across = n - cos * axis;
        let sin = across.norm();
        // Along the axis the plane is arbitrary: take that of the polarization.
        let radial = (across.try_normalize(1e-9))
            .or_else(|| (p - p.dot(axis) * axis).try_normalize(1e-9))
            .unwrap_or_else(|| axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize());
        let motion = [p.dot(&radial), p.dot(&axis.cross(&radial)), p.dot(axis)];
        let [radially, across, axially] = motion.map(|m| m * m);
        let along = p.dot(&n).powi(2);
        let upright = radially + axially - along;
        let is_axial = sin * sin <= AXIAL;
        // Along the axis the two S modes are degenerate.
        let shear = if is_axial { upright + across } else { upright.max(across) };
        let nearest = along.max(shear);
        let named = is_clear(nearest);
        // In an oblique direction the medium may have turned the modes in the plane.
        let is_turned = !is_axial && cos * cos > AXIAL && is_clear(along + upright);
        let horizontal = across > radially.max(axially);
        let error = stddev.map(|s| s / speed);
        let ray = Self { speed, error, sin, cos, motion, horizontal, mixed: false, named };
        Ok((ray, if is_turned { 1.0 } else { nearest }))
    }

    /// sin² of the angle between direction and axis.
    pub(super) fn sin_squared(&self) -> f64 {
        self.sin * self.sin
    }

    /// True if it is polarized across the plane of direction and axis.
    pub(super) fn is_horizontal(&self) -> bool {
        self.horizontal
    }

    /// This ray as one of two S modes that may be turned from those of the medium.
    pub(super) fn mixed(self) -> Self {
        Self { mixed: true, named: true, ..self }
    }

    /// cos² of the angle between polarization and direction.
    fn along(&self) -> f64 {
        (self.sin * self.motion[0] + self.cos * self.motion[2]).powi(2)
    }

    /// True if the polarization is more along the direction than across it.
    pub(super) fn is_compressional(&self) -> bool {
        self.along() > 0.5
    }

    /// True if the polarization is clearly across the direction.
    pub(super) fn is_transverse(&self) -> bool {
        is_clear(1.0 - self.along())
    }

    /// True if the polarization of the mode, and with it v², depends on C13 and on the ratios of the moduli.
    pub(super) fn is_coupled(&self) -> bool {
        (self.mixed || !self.horizontal) && (self.sin * self.cos).powi(2) > AXIAL
    }

    /// Derivatives of v² with respect to the specific moduli for exactly the measured polarization: v² = p·Γ p/ρ.
    pub(super) fn slopes_of_motion(&self) -> Column {
        let [radial, across, axial] = self.motion;
        let mut slopes = self.slopes_in_plane(radial, axial);
        slopes += across * across * self.slopes_across();
        slopes
    }

    /// The mode nearest to the measured polarization; `None` if its v² is not positive in this medium.
    ///
    /// Across the plane, v² = C66 sin²θ + C44 cos²θ over ρ. In it, the eigenvalues of
    /// `[[C11 sin² + C44 cos², (C13 + C44) sin cos], [., C44 sin² + C33 cos²]]` over ρ.
    pub(super) fn response(&self, specific: &Column) -> Option<Response> {
        let (radial, axial) = self.nearest_in_plane(specific);
        if self.mixed {
            let across = self.motion[1].powi(2) / (1.0 - self.along());
            let slopes = across * self.slopes_across() + (1.0 - across) * self.slopes_in_plane(radial, axial);
            let square = slopes.dot(specific);
            return (square > 0.0).then_some(Response { square, slopes, share: 1.0 });
        }
        let in_plane = (radial * self.motion[0] + axial * self.motion[2]).powi(2);
        let (slopes, mut share) = if self.horizontal {
            (self.slopes_across(), self.motion[1].powi(2))
        } else {
            (self.slopes_in_plane(radial, axial), in_plane)
        };
        // Near the axis the two S modes are degenerate.
        if self.sin * self.sin <= AXIAL && !self.is_compressional() {
            let upright = if self.horizontal { self.motion[0].powi(2) } else { self.motion[1].powi(2) };
            share += upright;
        }
        // v² is homogeneous of degree one in the moduli, so that it follows from its derivatives.
        let square = slopes.dot(specific);
        (square > 0.0).then_some(Response { square, slopes, share })
    }

    /// Polarization, across and along the axis, of the mode in the plane that is nearest to the measured one.
    fn nearest_in_plane(&self, specific: &Column) -> (f64, f64) {
        let [c11, c33, c13, c44, _] = specific.data.0[0];
        let (s2, c2) = (self.sin * self.sin, self.cos * self.cos);
        let half_difference = 0.5 * ((c11 - c44) * s2 - (c33 - c44) * c2);
        let coupling = (c13 + c44) * self.sin * self.cos;
        // The stiffer mode moves at this angle from the plane of isotropy.
        let (sin, cos) = (0.5 * coupling.atan2(half_difference)).sin_cos();
        let [radial, axial] = if self.mixed {
            // An S mode, however small the component in the plane.
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

/// For each speed, whether both S modes of its direction were measured: with polarizations perpendicular to each other
/// and to the direction.
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

/// True if a polarization with this cos² of the angle to that of a mode belongs to the mode.
pub(super) fn is_clear(share: f64) -> bool {
    share >= CLEAR
}

/// The error for a polarization with this cos² of the angle to the nearest mode.
pub(super) fn ambiguous(index: usize, share: f64) -> ChristoffelError {
    ChristoffelError::Ambiguous { index, degrees: share.max(0.0).sqrt().acos().to_degrees() }
}

/// Refuses a number that is not finite or not `valid`.
pub(super) fn number(
    valid: bool,
    what: impl FnOnce() -> String,
    value: f64,
    requirement: &'static str,
) -> Result<(), ChristoffelError> {
    let is_number = valid && value.is_finite();
    if is_number { Ok(()) } else { Err(ChristoffelError::Number { what: what(), value, requirement }) }
}

/// The normalised vector, if its length is 1 to the rounding of a file or a message.
pub(super) fn unit(vector: &Vec3, name: impl FnOnce() -> String) -> Result<Vec3, ChristoffelError> {
    let length = vector.norm();
    if (length - 1.0).abs() < 1e-6 {
        return Ok(vector / length);
    }
    Err(ChristoffelError::NotUnit { vector: name(), length })
}
