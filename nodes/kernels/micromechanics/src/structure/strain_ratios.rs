//! The three ratios γ/Δ of deviatoric to volumetric strain.

use grainlab_core::results::OverlapAnisotropyFit;
use grainlab_core::{Packing, SymTensor, Vec3};

/// γ/Δ of a strain about the unit vector `axis`: γ = (E_aa − (tr E − E_aa)/2)/2, Δ = −tr E. `None` if the volume does
/// not change (|Δ| below 10⁻⁹ of the largest component).
///
/// ```
/// use grainlab_core::{SymTensor, Vec3};
/// // Table II, S1: E33 = -.0194, E11 = E22 = -.0136.
/// let e = SymTensor { xx: -0.0136, yy: -0.0136, zz: -0.0194, ..Default::default() };
/// let g = grainlab_micromechanics::structure::strain_ratio(&e, &Vec3::z()).unwrap();
/// assert!((g - (-0.0029 / 0.0466)).abs() < 1e-15);
/// ```
pub fn strain_ratio(strain: &SymTensor, axis: &Vec3) -> Option<f64> {
    let along = axis.dot(&(strain.matrix() * axis));
    let trace = strain.trace();
    let largest = strain.voigt().iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let g = (along - 0.5 * (trace - along)) / 2.0 / -trace;
    (trace.abs() > 1e-9 * largest && g.is_finite()).then_some(g)
}

/// Solid fraction below which spheres are a gas: no packing is as loose.
const GAS: f64 = 0.5;

/// γ/Δ of the strain of a packing. `None` if it has no strain, if the strain counts from a gas, whose grains do not touch
/// (a run without a reference state), and if the volume is unchanged.
pub fn total_strain_ratio(packing: &Packing, axis: &Vec3) -> Option<f64> {
    let before = packing.solid_fraction() * packing.deformation.determinant();
    strain_ratio(&packing.strain().filter(|_| before >= GAS)?, axis)
}

/// Least squares of √overlap to A(1 + g − 3 g x²), x = n·`axis` (Eq. 10), with the standard error of g for independent
/// contacts of equal scatter. `None` if the contacts do not determine it (fewer than two, or all at one inclination).
///
/// With s = 1 − 3x² this is a straight line, A + (A g) s; the variance of the quotient g is taken to first order in the
/// covariance of intercept and slope.
pub fn overlap_anisotropy_fit(packing: &Packing, axis: &Vec3) -> Option<OverlapAnisotropyFit> {
    let count = packing.contacts.len() as f64;
    let sample = || {
        packing.contacts.iter().map(|c| {
            let x = c.normal.dot(axis);
            (1.0 - 3.0 * x * x, c.overlap.sqrt())
        })
    };
    let (s_sum, y_sum) = sample().fold((0.0, 0.0), |(s, y), (a, b)| (s + a, y + b));
    let (s_mean, y_mean) = (s_sum / count, y_sum / count);
    let (mut covariance, mut variance, mut spread) = (0.0, 0.0, 0.0);
    for (s, y) in sample() {
        covariance += (s - s_mean) * (y - y_mean);
        variance += (s - s_mean) * (s - s_mean);
        spread += (y - y_mean) * (y - y_mean);
    }
    if packing.contacts.is_empty() || variance <= 1e-12 * count {
        return None;
    }
    let slope = covariance / variance;
    let level = y_mean - slope * s_mean;
    let g = slope / level;
    // Scatter of the residuals, √overlap in m^½.
    let scatter = (spread - slope * covariance).max(0.0) / (count - 2.0);
    let of_slope = scatter / variance;
    let of_level = scatter / count + s_mean * s_mean * of_slope;
    let of_both = -s_mean * of_slope;
    let of_g = (of_slope + g * g * of_level - 2.0 * g * of_both) / (level * level);
    let g_stddev = (packing.contacts.len() > 2).then(|| of_g.max(0.0).sqrt()).filter(|v| v.is_finite());
    g.is_finite().then_some(OverlapAnisotropyFit { g, g_stddev })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn isochoric_strain_has_no_ratio() {
        let e = SymTensor { xx: -0.01, yy: -0.01, zz: 0.02, ..Default::default() };
        assert_eq!(strain_ratio(&e, &Vec3::z()), None);
        assert_eq!(strain_ratio(&SymTensor::default(), &Vec3::z()), None);
    }
}
