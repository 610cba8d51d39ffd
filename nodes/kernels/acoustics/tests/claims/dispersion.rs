//! The dispersion of real packings has the static stiffness as its long-wave limit.

use crate::sample::{self, minimal, stiffness, surveys};
use grainlab_acoustics::dispersion::{self, curves};
use grainlab_acoustics::{
    AcousticsError, DispersionCurve, MethodSettings, Modes, Ray, Settings, Survey, measure,
};
use grainlab_core::{Stiffness, Vec3};
use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
use grainlab_testkit::packings::mode_nearest;

/// ρ v² from the stiffness for the direction and polarization of this curve, Pa.
fn modulus(c: &Stiffness, curve: &DispersionCurve) -> f64 {
    curve.polarization.dot(&(c.christoffel(&curve.direction) * curve.polarization))
}

#[test]
fn long_waves_have_the_static_stiffness_and_every_speed_is_inside_its_uncertainty() {
    for (m, c) in surveys() {
        assert_eq!((m.curves.len(), m.notes.len()), (27, 0));
        for curve in &m.curves {
            let (found, expected) = (m.density * curve.speed.powi(2), modulus(c, curve));
            let error = (found / expected - 1.0).abs();
            let sigma = (2.0 * curve.stddev / curve.speed).hypot(m.density_stddev / m.density);
            assert!(error < 4e-4, "{error:e} {curve:?}");
            assert!(error < 2.5 * sigma, "{error:e} stated {sigma:e} {curve:?}");
        }
    }
}

#[test]
fn christoffel_gives_the_moduli_of_the_transversely_isotropic_projection() {
    for (m, c) in surveys() {
        let speeds: Vec<_> = m.waves.iter().map(|w| w.wave).collect();
        let density = Measured { value: m.density, stddev: m.density_stddev };
        let fitted = christoffel::moduli_from_speeds(&speeds, density, m.axis, Conditions::at(50e3)).unwrap();
        let t = c.transverse_isotropy();
        for (modulus, expected) in [
            (Modulus::C33, t.c33),
            (Modulus::C11, t.c11),
            (Modulus::G13, t.g13),
            (Modulus::G12, t.g12),
            (Modulus::C13, t.c13),
        ] {
            let found = fitted.observation.moduli.get(modulus).unwrap();
            assert!((found / expected - 1.0).abs() < 3e-3, "{modulus:?} {found:e} {expected:e}");
        }
    }
}

#[test]
fn the_law_of_the_extrapolation_holds_at_all_long_waves() {
    let rays = Survey::Minimal.rays(&Vec3::z(), Modes::All);
    let wavelengths = vec![60.0, 100.0, 160.0, 640.0];
    let near = dispersion::Settings { wavelengths, doublings: 0, ..dispersion::Settings::default() };
    let near = curves(&sample::anisotropic(), &rays, &near).unwrap();
    assert_eq!(near.len(), minimal().curves.len());
    for (law, seen) in minimal().curves.iter().zip(&near) {
        for point in &seen.points {
            // Below 100 diameters, loosely held grains stop following the wave one by one.
            let allowed = if point.wavenumber * 2e-4 < 0.045 { 5e-5 } else { 2e-3 };
            let bent = (1.0 - law.dispersion_coefficient * point.wavenumber.powi(2)).sqrt();
            let off = point.speed / (law.speed * bent) - 1.0;
            assert!(off.abs() < allowed, "{off:e} {point:?} {law:?}");
        }
    }
}

#[test]
fn without_an_axis_every_mode_is_measured_as_it_is() {
    let packing = sample::anisotropic();
    let m = measure(&packing, &Settings { axis: None, ..Settings::default() }).unwrap();
    assert_eq!((m.curves.len(), m.axis), (39, None));
    let c = stiffness(&packing);
    for curve in &m.curves {
        let (modulus, share) = mode_nearest(&c, &curve.direction, &curve.polarization);
        assert!(share > 1.0 - 1e-4, "{share} {curve:?}");
        let error = (m.density * curve.speed.powi(2) / modulus - 1.0).abs();
        assert!(error < 1e-4, "{error:e} {curve:?}");
    }
}

#[test]
fn rattlers_do_not_move_and_grains_that_turn_freely_move_less() {
    let (packing, moving) = (sample::isotropic(), surveys()[0].0.effective_density.mean());
    let carried =
        packing.radii.iter().zip(grainlab_core::non_rattlers(&packing)).filter(|(_, carries)| *carries);
    let masses: Vec<f64> = carried.map(|(r, _)| packing.material.sphere_mass(*r)).collect();
    assert_eq!(masses.len(), 2000 - 97);
    let without = masses.iter().sum::<f64>() / packing.cell.volume();
    assert!(moving < without && moving > 0.999 * without, "{moving} {without}");
}

#[test]
fn two_threads_give_the_bits_of_one() {
    assert_eq!(&sample::minimal_by(1), minimal());
}

#[test]
fn what_carries_no_wave_is_refused_with_the_reason() {
    let mut gas = sample::isotropic();
    gas.contacts.clear();
    let error = measure(&gas, &Settings::default()).unwrap_err();
    assert!(error.to_string().contains("none of the 2000 grains touches another"), "{error}");
    // A chain in which each grain touches only the next.
    let mut loose = sample::isotropic();
    loose.contacts.truncate(3);
    let error = measure(&loose, &Settings::default()).unwrap_err();
    assert!(error.to_string().contains("are rattlers"), "{error}");
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let packing = sample::isotropic();
    let refused = |way: dispersion::Settings, what: &str| {
        let error =
            measure(&packing, &Settings { method: MethodSettings::Dispersion(way), ..Settings::default() })
                .unwrap_err();
        assert!(
            matches!(error, AcousticsError::Setting { .. }) && error.to_string().contains(what),
            "{error}"
        );
    };
    let usual = dispersion::Settings::default;
    refused(
        dispersion::Settings { wavelengths: vec![100.0, 200.0, 100.0], ..usual() },
        "number of wavelengths",
    );
    refused(dispersion::Settings { wavelengths: vec![100.0, 200.0, 1.9], ..usual() }, "wavelength = 1.9e0");
    refused(
        dispersion::Settings { wavelengths: vec![100.0, 200.0, f64::NAN], ..usual() },
        "wavelength = NaN",
    );
    refused(dispersion::Settings { tolerance: 0.0, ..usual() }, "tolerance");
    let axis = Some(Vec3::new(0.0, f64::NAN, 1.0));
    let error = measure(&packing, &Settings { axis, ..Settings::default() }).unwrap_err();
    assert!(error.to_string().contains("|axis|"), "{error}");
    let short = dispersion::Settings { max_iterations: 3, ..usual() };
    let ray = Ray { direction: Vec3::z(), indices: None, polarizations: vec![Vec3::z()] };
    let error = curves(&packing, &[ray], &short).unwrap_err();
    assert!(matches!(error, AcousticsError::NotConverged { .. }), "{error}");
}
