//! From `Moduli` to what a model takes.

use crate::settings::{Axis, Settings};
use emt::{Conditions, Gamma, Measured, Moduli, Modulus, Observation};
use grainlab_msgs::boundary::ModuliReading;
use grains::{Mat3, Stiffness, Vec3};

/// Sine of the angle to e3 below which an axis is e3: rounding.
const ALONG: f64 = 1e-9;

/// Why moduli say nothing about the axis asked for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Unobservable {
    /// The axis is to come with the data, and did not.
    #[error("the axis is to be the one found, and these data name none: set the parameter axis")]
    NoAxis,
    /// Moduli about e3 cannot be turned.
    #[error(
        "the moduli given are those about e3, and without the full stiffness they say nothing about the axis \
         ({x:.4}, {y:.4}, {z:.4})"
    )]
    NoStiffness {
        /// Components of the axis.
        x: f64,
        /// Second.
        y: f64,
        /// Third.
        z: f64,
    },
}

/// The moduli about the axis set, all of them where the full stiffness is known, with their errors and their state.
///
/// Without errors in the data, each modulus measured gets the error of the settings; of a full stiffness these are five,
/// and Θ follows from them.
pub(crate) fn of_moduli(reading: &ModuliReading, settings: &Settings) -> Result<Observation, Unobservable> {
    let axis = match settings.axis {
        Axis::E3 => Vec3::z(),
        Axis::Given(axis) => axis,
        Axis::Found => reading.axis.ok_or(Unobservable::NoAxis)?,
    };
    let along_e3 = axis.xy().norm() < ALONG;
    let conditions = Conditions {
        pressure: Measured::exact(reading.pressure),
        gamma: about(&axis, Gamma::of(&reading.gamma_over_delta, settings.gamma)),
        solid_fraction: reading.solid_fraction.map(Measured::exact),
        material: Some(reading.material),
    };
    // The covariance of the message is that of the moduli about e3.
    let covariance = reading.covariance.filter(|_| along_e3).map(|c| Mat3::from_row_slice(&c));
    match &reading.stiffness {
        Some(stiffness) if along_e3 => {
            let observation = Observation::of_stiffness(stiffness, conditions);
            Ok(of_six(observation, covariance, settings.modulus_error))
        }
        Some(stiffness) => Ok(of_six(turned(stiffness, &axis, conditions), None, settings.modulus_error)),
        None if along_e3 => {
            let moduli = Moduli::of_values([reading.g12, reading.g13, reading.theta, None, None, None]);
            Ok(of_three(Observation::new(moduli, conditions), covariance, settings.modulus_error))
        }
        None => Err(Unobservable::NoStiffness { x: axis.x, y: axis.y, z: axis.z }),
    }
}

/// γ/Δ about another axis than e3, of a strain that is symmetric about e3: less by the Legendre polynomial P₂.
fn about(axis: &Vec3, about_e3: Gamma) -> Gamma {
    Gamma { value: about_e3.value * (1.5 * axis.z * axis.z - 0.5), ..about_e3 }
}

fn turned(stiffness: &Stiffness, axis: &Vec3, conditions: Conditions) -> Observation {
    let t = stiffness.transverse_isotropy_about(axis);
    Observation { asymmetry: Some(t.residual), ..Observation::new(Moduli::of_medium(&t), conditions) }
}

fn of_six(observation: Observation, covariance: Option<Mat3>, error: f64) -> Observation {
    let Some(paper) = covariance else {
        if error == 0.0 {
            return observation;
        }
        let moduli = observation.moduli.without(Modulus::Theta);
        return Observation { moduli, ..observation }.with_relative_error(error);
    };
    // Nothing is said of the errors of C11 and C33. Taken as exact they would outweigh everything else.
    let mut moduli = observation.moduli.without(Modulus::C13);
    if error == 0.0 {
        moduli = moduli.without(Modulus::C11).without(Modulus::C33);
    }
    let mut observation = Observation { moduli, ..observation }.with_relative_error(error);
    if let Some(all) = &mut observation.covariance {
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&paper);
    }
    observation
}

fn of_three(observation: Observation, covariance: Option<Mat3>, error: f64) -> Observation {
    let known = [Modulus::G12, Modulus::G13, Modulus::Theta].map(|m| observation.moduli.get(m).is_some());
    match covariance {
        Some(c) => {
            let of_known = |i: usize, j: usize| if known[i] && known[j] { c[(i, j)] } else { 0.0 };
            observation.with_paper_covariance(&Mat3::from_fn(of_known))
        }
        None if error > 0.0 => observation.with_relative_error(error),
        None => observation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grains::TransverseIsotropy;

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
        of_six(of_medium, covariance, error).checked().unwrap()
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
        // C13 = (9 Θ − 4 C11 + 4 G12 − C33)/4, and its error theirs.
        let variance = (81.0 * 16.0 + 16.0 * 3.6f64.powi(2) + 16.0 * 4.0 + 16.0) / 16.0;
        assert!((with.moduli.get(Modulus::C13).unwrap() - 70.0).abs() < 1e-12);
        assert!((c[(5, 5)] / variance - 1.0).abs() < 1e-12);
        let without = observation(Some(paper), 0.0);
        assert_eq!(without.moduli.known().map(|(m, _)| m).collect::<Vec<_>>(), Modulus::ALL[..3]);
    }

    #[test]
    fn without_any_error_all_six_are_given_and_nothing_is_said_of_theirs() {
        let observation = observation(None, 0.0);
        assert_eq!((observation.moduli.known().count(), observation.covariance), (6, None));
    }
}
