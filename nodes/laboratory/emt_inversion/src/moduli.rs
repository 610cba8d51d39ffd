//! From `Moduli` to an observation.

use crate::observed::{Observed, Unobservable, with_error};
use crate::settings::{Axis, Settings};
use grainlab_core::{Mat3, Stiffness, Vec3};
use grainlab_emt::{Conditions, Measured, Moduli, Modulus, Observation, StrainRatio};
use grainlab_msgs::boundary::ModuliReading;

/// Sine of the angle below which two axes are equal up to rounding.
const ALONG: f64 = 1e-9;

/// The moduli about the axis set, with their errors and state; all of them if the full stiffness is known.
///
/// If the data have no errors, each measured modulus gets the error of the settings. A full stiffness has
/// five measured moduli, and Θ follows from them.
pub(crate) fn of_moduli(reading: &ModuliReading, settings: &Settings) -> Result<Observed, Unobservable> {
    let stated = reading.reference_axis;
    let axis = match settings.axis {
        Axis::Stated => stated,
        Axis::E3 => Vec3::z(),
        Axis::Given(axis) => axis,
        Axis::Found => reading.axis.ok_or(Unobservable::NoAxis)?,
    };
    let along_e3 = axis.xy().norm() < ALONG;
    let as_stated = axis.cross(&stated).norm() < ALONG;
    // The strain of the scene is symmetric about e3. γ/Δ about another axis follows only from that about e3.
    if !as_stated && stated.xy().norm() >= ALONG {
        return Err(Unobservable::OtherAxis { stated: stated.into(), asked: axis.into() });
    }
    let conditions = Conditions {
        pressure: Measured { value: reading.pressure, stddev: reading.pressure_stddev },
        gamma: {
            let gamma = StrainRatio::of(&reading.strain_ratios, settings.gamma);
            if as_stated { gamma } else { about(&axis, gamma) }
        },
        solid_fraction: reading.solid_fraction.map(Measured::exact),
        stress_ratio: reading
            .stress_ratio
            .filter(|_| as_stated)
            .map(|value| Measured { value, stddev: reading.stress_ratio_stddev }),
        size_spread: reading.size_spread,
        material: Some(reading.material),
        shear_modulus_stddev: reading.shear_modulus_stddev,
        poisson_ratio_stddev: reading.poisson_ratio_stddev,
        contact_law: reading.contact_law,
        smooth: reading.smooth,
    };
    // The covariance of the message refers to the moduli about the axis stated.
    let covariance = reading.covariance.filter(|_| as_stated).map(|c| Mat3::from_row_slice(&c));
    let observation = match &reading.stiffness {
        Some(stiffness) if along_e3 => Observation::of_stiffness(&stiffness.tensor, conditions),
        Some(stiffness) => turned(&stiffness.tensor, &axis, conditions),
        None if as_stated => {
            let (g12, g13, theta) = (reading.g12, reading.g13, reading.theta);
            Observation::new(Moduli::of_values([g12, g13, theta, None, None, None]), conditions)
        }
        None => return Err(Unobservable::NoStiffness { axis: axis.into() }),
    };
    let observation = Observation { grains: reading.grains, ..observation };
    let error = settings.modulus_error;
    Ok(match covariance {
        None => with_error(observation, error).into(),
        Some(paper) => with_covariance(observation, &paper, error).into(),
    })
}

/// γ/Δ about an axis other than e3, for a strain that is symmetric about e3: multiplied by the Legendre
/// polynomial P₂.
fn about(axis: &Vec3, about_e3: StrainRatio) -> StrainRatio {
    StrainRatio { value: about_e3.value * (1.5 * axis.z * axis.z - 0.5), ..about_e3 }
}

fn turned(stiffness: &Stiffness, axis: &Vec3, conditions: Conditions) -> Observation {
    let t = stiffness.transverse_isotropy_about(axis);
    Observation { asymmetry: Some(t.residual), ..Observation::new(Moduli::of_medium(&t), conditions) }
}

/// With these errors of G12, G13 and Θ, Pa², and the error of the settings for the other two of a full
/// stiffness.
fn with_covariance(observation: Observation, paper: &Mat3, error: f64) -> Observation {
    // The errors of C11 and C33 are unknown: taken as exact, these would outweigh all other data. C13
    // follows.
    let mut moduli = observation.moduli.without(Modulus::C13);
    if error == 0.0 {
        moduli = moduli.without(Modulus::C11).without(Modulus::C33);
    }
    let mut observation = Observation { moduli, ..observation }.with_relative_error(error);
    let known = [Modulus::G12, Modulus::G13, Modulus::Theta].map(|m| moduli.get(m).is_some());
    if let Some(all) = &mut observation.covariance {
        let of_known = |i: usize, j: usize| if known[i] && known[j] { paper[(i, j)] } else { 0.0 };
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&Mat3::from_fn(of_known));
    }
    observation
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::TransverseIsotropy;

    const T: TransverseIsotropy = TransverseIsotropy {
        c11: 360.0,
        c12: 80.0,
        c13: 70.0,
        c33: 400.0,
        g13: 150.0,
        g12: 140.0,
        residual: 0.0,
    };

    fn observation(covariance: Option<Mat3>, error: f64) -> Observation {
        let of_medium = Observation::of_stiffness(&T.stiffness(), Conditions::at(50e3));
        let observation = match covariance {
            None => with_error(of_medium, error),
            Some(paper) => with_covariance(of_medium, &paper, error),
        };
        observation.checked().unwrap()
    }

    #[test]
    fn five_errors_are_independent_and_that_of_theta_follows_from_the_relation() {
        let c = observation(None, 0.01).covariance.unwrap();
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
    fn with_errors_of_the_three_alone_the_others_get_that_of_the_settings_or_are_left_out() {
        let paper = Mat3::new(4.0, 1.0, 0.0, 1.0, 9.0, 0.0, 0.0, 0.0, 16.0);
        let with = observation(Some(paper), 0.01);
        let c = with.covariance.unwrap();
        assert_eq!(c.fixed_view::<3, 3>(0, 0), paper);
        assert!((c[(3, 3)] / 3.6f64.powi(2) - 1.0).abs() < 1e-12 && (c[(4, 4)] / 16.0 - 1.0).abs() < 1e-12);
        // C13 = (9 Θ − 4 C11 + 4 G12 − C33)/4, and its error follows from theirs.
        let variance = (81.0 * 16.0 + 16.0 * 3.6f64.powi(2) + 16.0 * 4.0 + 16.0) / 16.0;
        assert!((with.moduli.get(Modulus::C13).unwrap() - 70.0).abs() < 1e-12);
        assert!((c[(5, 5)] / variance - 1.0).abs() < 1e-12);
        let without = observation(Some(paper), 0.0);
        assert_eq!(without.moduli.known().map(|(m, _)| m).collect::<Vec<_>>(), Modulus::ALL[..3]);
    }

    #[test]
    fn without_any_error_all_six_are_given_without_errors() {
        let observation = observation(None, 0.0);
        assert_eq!((observation.moduli.known().count(), observation.covariance), (6, None));
    }
}
