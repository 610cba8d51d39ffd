//! Attenuation of waves: 1/Q of each ray and polarization at several wavelengths.

use crate::tensor::Vec3;

/// Least number of modes in the width of a line for its width to be that of a larger sample.
pub const RESOLVED: f64 = 10.0;

/// Attenuation of the mode nearest to one polarization of one ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Attenuation {
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Unit polarization asked for.
    pub polarization: Vec3,
    /// One per wavelength, longest first.
    pub points: Vec<AttenuationPoint>,
}

/// Attenuation at one wave vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttenuationPoint {
    /// Wave number, rad/m.
    pub wavenumber: f64,
    /// By the dashpots of the contacts. `None` at wavelengths below 30 mean diameters, where a plane wave is not one mode,
    /// where the mode was not found, and where it does not oscillate.
    pub contact: Option<ContactLoss>,
    /// By scattering. `None` where the wave is so long that the periodic sample has no other wave of its frequency, and
    /// where no tone was found.
    pub scattering: Option<Scattering>,
}

/// Loss by the dashpots of the contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLoss {
    /// ω of the damped mode, rad/s.
    pub omega: f64,
    /// 1/Q = 2 Im ω/Re ω.
    pub loss: f64,
    /// Its numerical error: change in the last round of the solution.
    pub stddev: f64,
    /// 1/Q to first order in the dashpots, u*C u/(ω u*M u) of the undamped mode u. The difference is of higher order.
    pub first_order: f64,
}

/// Decay of one polarization at one wave vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// ω of the coherent wave, rad/s.
    pub omega: f64,
    /// 1/Q = 2γ/ω of the coherent amplitude: that of the material only where it is resolved.
    pub loss: f64,
    /// Its standard deviation: fit, length of the fitted time, and the number of modes in the line.
    pub stddev: f64,
    /// Number of modes of the periodic sample in the width 2γ of the line.
    pub modes_in_width: f64,
    /// The least 1/Q that a sample of this size resolves at this frequency.
    pub least_loss: f64,
}

impl Scattering {
    /// Whether the sample is large enough for the loss to be that of the material. Just above the limit resolved values tend
    /// to be too high, because lower ones are not resolved.
    pub fn is_resolved(&self) -> bool {
        self.modes_in_width >= RESOLVED
    }
}
