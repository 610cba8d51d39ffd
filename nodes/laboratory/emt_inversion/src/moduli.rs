//! From `PackingReport` or `Moduli` to an observation.

use crate::observed::{Observed, Unobservable, with_error};
use crate::settings::{Axis, Settings};
use grainlab_core::results::PackingReport;
use grainlab_core::{Mat3, Vec3};
use grainlab_emt::{Conditions, Measured, Moduli, Observation, StrainRatio};
use grainlab_msgs::boundary::ModuliReading;

/// Sine of the angle below which two axes are equal up to rounding.
const ALONG: f64 = 1e-9;

/// The axis that is used, and whether it is the one stated.
fn chosen(axis: Axis, stated: Vec3, found: Vec3) -> Result<(Vec3, bool), Unobservable> {
    let axis = match axis {
        Axis::Stated => stated,
        Axis::E3 => Vec3::z(),
        Axis::Given(axis) => axis,
        Axis::Found => found,
    };
    let as_stated = axis.cross(&stated).norm() < ALONG;
    // The strain of the scene is symmetric about e3. γ/Δ about another axis follows only from that about e3.
    if !as_stated && stated.xy().norm() >= ALONG {
        return Err(Unobservable::OtherAxis { stated: stated.into(), asked: axis.into() });
    }
    Ok((axis, as_stated))
}

/// All moduli of a packing about the axis set, and its state. Five are measured, each with the error of the settings, and Θ
/// follows from them. `None` without a stiffness.
pub(crate) fn of_report(
    report: &PackingReport,
    settings: &Settings,
) -> Option<Result<Observed, Unobservable>> {
    let (tensor, mut observation) = (report.stiffness()?.tensor, Observation::of(report)?);
    let (stated, found) = (report.fabric.reference_axis, report.fabric.principal_axis.direction);
    let (axis, as_stated) = match chosen(settings.axis, stated, found) {
        Ok(chosen) => chosen,
        Err(other) => return Some(Err(other)),
    };
    let along_e3 = axis.xy().norm() < ALONG;
    let medium = tensor.transverse_isotropy_about(&if along_e3 { Vec3::z() } else { axis });
    (observation.moduli, observation.asymmetry) = (Moduli::of_medium(&medium), Some(medium.residual));
    let gamma = StrainRatio::of(&report.strain_ratios, settings.gamma);
    observation.conditions.gamma = if as_stated { gamma } else { about(&axis, gamma) };
    // That of the report is about its own axis.
    observation.conditions.stress_ratio = observation.conditions.stress_ratio.filter(|_| as_stated);
    Some(Ok(with_error(observation, settings.modulus_error).into()))
}

/// The moduli of a sample, which are those about its own axis, with their errors, else those of the settings.
pub(crate) fn of_moduli(reading: &ModuliReading, settings: &Settings) -> Result<Observed, Unobservable> {
    let stated = reading.reference_axis;
    let (axis, as_stated) = chosen(settings.axis, stated, stated)?;
    if !as_stated {
        return Err(Unobservable::NoStiffness { axis: axis.into() });
    }
    let stress_ratio = |value| Measured { value, stddev: reading.stress_ratio_stddev };
    let conditions = Conditions {
        pressure: Measured { value: reading.pressure, stddev: reading.pressure_stddev },
        gamma: StrainRatio::of(&reading.strain_ratios, settings.gamma),
        solid_fraction: reading.solid_fraction.map(Measured::exact),
        stress_ratio: reading.stress_ratio.map(stress_ratio),
        size_spread: reading.size_spread,
        material: Some(reading.material),
        shear_modulus_stddev: reading.shear_modulus_stddev,
        poisson_ratio_stddev: reading.poisson_ratio_stddev,
        contact_law: reading.contact_law,
        smooth: reading.smooth,
    };
    let known = [reading.g12, reading.g13, reading.theta];
    let [g12, g13, theta] = known;
    let moduli = Moduli::of_values([g12, g13, theta, None, None, None]);
    let observation =
        Observation { grains: reading.grains, probe: settings.probe, ..Observation::new(moduli, conditions) };
    Ok(match reading.covariance {
        None => with_error(observation, settings.modulus_error).into(),
        Some(c) => {
            let of_known =
                |i: usize, j: usize| if known[i].and(known[j]).is_some() { c[3 * i + j] } else { 0.0 };
            observation.with_g12_g13_theta_covariance(&Mat3::from_fn(of_known)).into()
        }
    })
}

/// γ/Δ about an axis other than e3, for a strain that is symmetric about e3: multiplied by the Legendre
/// polynomial P₂.
fn about(axis: &Vec3, about_e3: StrainRatio) -> StrainRatio {
    StrainRatio { value: about_e3.value * (1.5 * axis.z * axis.z - 0.5), ..about_e3 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::TransverseIsotropy;
    use grainlab_emt::Modulus;

    const T: TransverseIsotropy = TransverseIsotropy::of_constants(360.0, 400.0, 70.0, 150.0, 140.0);

    fn observation(error: f64) -> Observation {
        with_error(Observation::of_stiffness(&T.stiffness(), Conditions::at(50e3)), error).checked().unwrap()
    }

    #[test]
    fn five_errors_are_independent_and_that_of_theta_follows_from_the_relation() {
        let c = observation(0.01).covariance.unwrap();
        let at = |a: Modulus, b: Modulus| c[(a as usize, b as usize)];
        let five = [
            (Modulus::C11, 360.0),
            (Modulus::C33, 400.0),
            (Modulus::C13, 70.0),
            (Modulus::G12, 140.0),
            (Modulus::G13, 150.0),
        ];
        for (i, (a, value)) in five.into_iter().enumerate() {
            assert!((at(a, a).sqrt() / (0.01 * value) - 1.0).abs() < 1e-12, "{a}");
            assert!(five[..i].iter().all(|(b, _)| at(a, *b) == 0.0), "{a}");
        }
        // 9 Θ = 4 C11 − 4 G12 + 4 C13 + C33
        let parts = [4.0 * 3.6, -4.0 * 1.4, 4.0 * 0.7, 4.0].map(|p| p / 9.0);
        let variance: f64 = parts.iter().map(|p| p * p).sum();
        assert!((at(Modulus::Theta, Modulus::Theta) / variance - 1.0).abs() < 1e-12);
        assert!((at(Modulus::Theta, Modulus::G12) / (parts[1] * 1.4) - 1.0).abs() < 1e-12);
        assert_eq!(at(Modulus::Theta, Modulus::G13), 0.0);
    }

    #[test]
    fn without_any_error_all_six_are_given_without_errors() {
        let observation = observation(0.0);
        assert_eq!((observation.moduli.known().count(), observation.covariance), (6, None));
    }
}
