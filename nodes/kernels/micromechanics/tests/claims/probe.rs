//! The explicit probe against that of LAMMPS, against the frozen network, and at its limits.

use crate::golden::{lammps, reference};
use crate::samples::packing;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::results::NoStiffness;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, TimeStep};
use grainlab_micromechanics::probe::{Relaxation, StrainProbe, StrainProbeResult, strain_probe};
use grainlab_micromechanics::{ProbeError, Settings, analyze};
use grainlab_testkit::packings::{FACE_CENTRED, cubic};
use nalgebra::Matrix6;

fn share(difference: Matrix6<f64>, c: &Matrix6<f64>) -> f64 {
    difference.amax() / c[(0, 0)]
}

/// Most of the difference, 2e-4, is due to the strain rate in LAMMPS: with 1000, 2000, 4000 and 32000 steps
/// its C11 is 365.082, 365.122, 365.141 and 365.158 MPa, and the forward part of ours 365.165. The forward
/// shear columns of the two agree to 1e-5.
#[test]
fn six_columns_are_those_of_lammps_within_a_permille_of_c11() {
    let found = strain_probe(&reference(), &StrainProbe::default()).unwrap();
    let raw = lammps("1e-7");
    let error = share(found.stiffness.0 - raw, &raw);
    assert!(error < 1e-3, "{error:e}\n{}\n{raw}", found.stiffness.0);
    // C is symmetric up to the deviatoric stress, 3 kPa here, and the tolerance.
    assert!(found.asymmetry < 2e-5, "{:e}", found.asymmetry);
    // The nonlinearity of Hertz's law is (2/3) 1e-7 Θ/p = 1.1e-4.
    for column in found.columns {
        assert!(column.residual <= 1e-5 && column.drift <= 1e-5, "{column:?}");
        assert!((3e-5..4e-4).contains(&column.forward_backward), "{column:?}");
    }
}

/// LAMMPS has a tangential force with a part along the normal, which a step removes.
#[test]
fn tangential_forces_off_the_contact_plane_do_not_count_as_a_difference_of_directions() {
    let mut packing = reference();
    packing.contacts.iter_mut().for_each(|c| c.tangential_force += 1e-4 * c.normal_force * c.normal);
    let found = strain_probe(&packing, &StrainProbe { tolerance: 1e-3, ..StrainProbe::default() }).unwrap();
    assert!(found.forward_backward() < 2e-3, "{:e}", found.forward_backward());
}

/// Besides the affine differences of −0.4 p, 1.2 p and −0.8 p, relaxation adds others of the order of p.
#[test]
fn frozen_network_is_the_probe_up_to_terms_of_the_pressure() {
    let packing = reference();
    let found = strain_probe(&packing, &StrainProbe::default()).unwrap().stiffness.0;
    let a = analyze(&packing, &Settings::default()).unwrap();
    let difference = (found - a.report.stiffness().copied().unwrap().tensor.0) / a.report.pressure();
    let affine = cubic(-0.4, 1.2, -0.8).0;
    assert!((difference - affine).amax() < 0.5, "in units of the pressure: {difference:.2}");
    assert!(difference.amax() > 1.0, "nothing of the order of the pressure: the test shows nothing");
}

#[test]
fn ten_times_the_amplitude_is_on_the_same_plateau_and_a_hundred_times_is_flagged() {
    let packing = reference();
    let with =
        |amplitude| strain_probe(&packing, &StrainProbe { amplitude, ..StrainProbe::default() }).unwrap();
    let (small, large) = (with(1e-7), with(1e-6));
    let c = &small.stiffness.0;
    let error = share(large.stiffness.0 - c, c);
    assert!(error < 2e-3, "{error:e}");
    // Contacts open at 1e-5, and forward and backward differ by more than Hertz's 1.1e-2.
    let far = with(1e-5);
    assert!(share(far.stiffness.0 - c, c) > 2e-3);
    let opened = |r: &StrainProbeResult| r.sum(|c| c.opened);
    assert!(opened(&far) > 2 * opened(&large), "{} {}", opened(&far), opened(&large));
    assert!(far.columns[1].forward_backward > 0.02);
    assert!(small.columns[1].forward_backward < 3e-4);
}

/// Between rounding errors of the stress and the opening of many contacts, the response is linear.
#[test]
fn the_stated_error_of_a_probe_covers_its_distance_from_the_linear_response() {
    let packing = reference();
    let of =
        |amplitude| strain_probe(&packing, &StrainProbe { amplitude, ..StrainProbe::default() }).unwrap();
    let plateau = of(1e-7).stiffness.0;
    for amplitude in [1e-8, 1e-6, 1e-5] {
        let found = of(amplitude);
        let off = (found.stiffness.0 - plateau).amax();
        assert!(off <= 2.0 * found.stddev().0.amax() + 1e-5 * plateau.amax(), "{amplitude:e}: {off:e}");
    }
}

/// With the friction of its preparation the packing slides under strain; with infinite friction it does not.
#[test]
fn contacts_that_slide_under_the_strain_are_counted() {
    let packing = reference();
    let sliding = |friction| {
        let settings = StrainProbe {
            friction: Some(friction),
            amplitude: 1e-6,
            tolerance: 1e-3,
            ..StrainProbe::default()
        };
        strain_probe(&packing, &settings).unwrap().columns[1].sliding
    };
    assert!(sliding(packing.friction) > 0);
    assert_eq!(sliding(f64::INFINITY), 0);
}

/// LAMMPS's `fix deform` with its default remapping of positions gives C66 = 78.5 MPa on this packing,
/// instead of 137.9.
#[test]
fn homogeneous_strain_enters_the_tangential_springs() {
    let found = strain_probe(&reference(), &StrainProbe::default()).unwrap().stiffness.0;
    assert!((found[(5, 5)] / 137.9e6 - 1.0).abs() < 1e-3, "{}", found[(5, 5)]);
    // A jump of positions by this strain, which tangential springs do not follow.
    let blind = |strain: f64| {
        let mut p = reference();
        let mut f = Mat3::identity();
        (f[(0, 1)], f[(1, 0)]) = (0.5 * strain, 0.5 * strain);
        p.cell = p.cell.deformed(&f).unwrap();
        p.positions.iter_mut().for_each(|x| *x = f * *x);
        let mut relaxation = Relaxation::new(vec![stuck(&Packing { time_step: 0.0, ..p })]);
        for _ in 0..500 {
            relaxation.step().unwrap();
        }
        relaxation.engines[0].observables().unwrap().stress.tensor.xy
    };
    let c66 = -(blind(1e-6) - blind(-1e-6)) / 2e-6;
    assert!((c66 / 78.5e6 - 1.0).abs() < 5e-3, "{c66:e}");
}

/// The packing dilated to a quarter of its pressure and 4.5 contacts per grain; it takes five times the
/// steps.
#[test]
fn near_isostaticity_the_probe_settles_on_the_frozen_network_too() {
    let mut relaxation = Relaxation::new(vec![stuck(&reference())]);
    let engine = &mut relaxation.engines[0];
    let rate = 2e-4 / (2000.0 * engine.time_step());
    engine.set_rate(&[rate, rate, rate, 0.0, 0.0, 0.0]).unwrap();
    for step in 0..6000 {
        if step == 2000 {
            relaxation.engines[0].set_rate(&[0.0; 6]).unwrap();
        }
        relaxation.step().unwrap();
    }
    let packing = relaxation.engines[0].packing(Mat3::identity());
    let a = analyze(&packing, &Settings::default()).unwrap();
    assert!(
        (4.4..4.6).contains(&a.report.contacts.mechanical_coordination),
        "{}",
        a.report.contacts.mechanical_coordination
    );
    let found = strain_probe(&packing, &StrainProbe { amplitude: 1e-8, ..StrainProbe::default() }).unwrap();
    let frozen = a.report.stiffness().copied().unwrap().tensor.0;
    assert!(frozen[(5, 5)] < 0.3 * 138e6, "as stiff as before");
    let error = (found.stiffness.0 - frozen).amax() / a.report.pressure();
    assert!(error < 4.0, "in units of the pressure: {error}");
}

/// An engine with infinite friction, undamped, at the longest stable time step.
fn stuck(packing: &Packing) -> Engine {
    let setting = EngineSettings {
        friction: f64::INFINITY,
        tangential: TangentialLaw::Incremental,
        time_step: TimeStep::FractionOfStable(1.0),
        skin: 1e-2 * packing.radii[0],
        ..EngineSettings::default()
    };
    let mut engine = Engine::from_packing(packing, setting).unwrap();
    engine.initialise().unwrap();
    engine
        .set_settings(EngineSettings { time_step: TimeStep::Fixed(engine.time_step()), ..setting })
        .unwrap();
    engine
}

/// Nothing relaxes in a lattice: C11 = √2 (k_n + k_t)/l, C12 = (k_n − k_t)/(√2 l), C44 = (k_n + k_t)/(√2 l),
/// and pressure terms −p/2, 5p/4 and −3p/4, since the mean of n_x⁴ is 1/6 and that of n_x² n_y² is 1/12. The
/// rest is of second order in amplitude/(overlap/diameter) = 1e-4.
#[test]
fn face_centred_cubic_is_exact_with_its_terms_of_the_pressure() {
    let (radius, overlap) = (1e-4, 2e-7);
    let l = 2.0 * radius - overlap;
    let cell = Cell::cube(l * 2f64.sqrt()).unwrap();
    let positions = FACE_CENTRED.map(|s| cell.matrix() * Vec3::from(s)).to_vec();
    let p = packing(cell, positions, radius, 0.3, None);
    assert_eq!(p.contacts.len(), 24);
    let (k_n, k_t) = p.contact_stiffness(&p.contacts[0]);
    let pressure = grainlab_core::stress::stress(&p).tensor.mean();
    let root = 2f64.sqrt();
    let expected = cubic(root * (k_n + k_t) / l, (k_n - k_t) / (root * l), (k_n + k_t) / (root * l)).0
        + cubic(-0.5, 1.25, -0.75).0 * pressure;
    let found = strain_probe(&p, &StrainProbe::default()).unwrap();
    let error = share(found.stiffness.0 - expected, &expected);
    assert!(error < 1e-7, "{error:e}, pressure {:e}", pressure / expected[(0, 0)]);
    // The terms that this resolves.
    assert!(pressure / expected[(0, 0)] > 1e-4);
    assert!(found.columns.iter().all(|c| c.opened + c.closed == 0));
}

/// A chain along z with force F and stress σ = F l/V: C33 = k_n l²/V. A strain across it changes only the
/// volume: C31 = C32 = σ. In shear the grain rolls until no tangential force is left, and the rotated chain
/// gives C44 = C55 = −σ/2.
#[test]
fn a_chain_has_its_closed_form_and_columns_of_nothing_settle() {
    let (radius, l) = (1e-4, 1.998e-4);
    let cell = Cell::new(Mat3::from_diagonal(&Vec3::new(5e-4, 6e-4, l))).unwrap();
    let p = packing(cell, vec![Vec3::zeros()], radius, 0.3, None);
    assert_eq!(p.contacts.len(), 1);
    let stress = grainlab_core::stress::stress(&p).tensor.zz;
    let mut expected = Matrix6::zeros();
    expected[(2, 2)] = p.contact_stiffness(&p.contacts[0]).0 * l * l / p.cell.volume();
    (expected[(2, 0)], expected[(2, 1)]) = (stress, stress);
    (expected[(3, 3)], expected[(4, 4)]) = (-0.5 * stress, -0.5 * stress);
    let found = strain_probe(&p, &StrainProbe::default()).unwrap().stiffness.0;
    let error = (found - expected).amax() / stress;
    assert!(error < 1e-2, "{error:e} of the stress\n{found:e}\n{expected:e}");
    assert!(expected[(2, 2)] > 100.0 * stress);
}

#[test]
fn a_packing_that_was_shaken_comes_to_rest_first() {
    let still = strain_probe(&reference(), &StrainProbe::default()).unwrap();
    let mut shaken = reference();
    for (i, x) in shaken.positions.iter_mut().enumerate() {
        *x += Vec3::new((i as f64).sin(), (2.0 * i as f64).sin(), (3.0 * i as f64).sin()) * 1e-11;
    }
    shaken.velocities.iter_mut().for_each(|v| *v = Vec3::repeat(1e-3));
    let found = strain_probe(&shaken, &StrainProbe::default()).unwrap();
    assert!(found.rest_steps > 100 && still.rest_steps <= 20, "{} {}", found.rest_steps, still.rest_steps);
    let error = share(found.stiffness.0 - still.stiffness.0, &still.stiffness.0);
    // Overlaps have changed by 4e-4 of their mean.
    assert!(error < 5e-4, "{error:e}");
}

#[test]
fn an_analysis_by_probe_reports_its_stiffness_and_how_it_went() {
    let packing = reference();
    let settings = Settings { probe: Some(StrainProbe::default()), ..Settings::default() };
    let (by_probe, frozen) = (analyze(&packing, &settings).unwrap(), analyze(&packing, &Settings::default()));
    let (found, moduli) = (by_probe.probe.unwrap(), by_probe.report.stiffness().copied().unwrap());
    assert_eq!(found, strain_probe(&packing, &StrainProbe::default()).unwrap());
    assert_eq!(moduli.tensor, found.stiffness);
    let frozen = frozen.unwrap();
    assert_eq!(moduli.bounds.affine, frozen.report.stiffness().copied().unwrap().bounds.affine);
    assert_eq!(frozen.probe, None);
    let short = StrainProbe { max_steps: 60, ..StrainProbe::default() };
    let refused = analyze(&packing, &Settings { probe: Some(short), ..Settings::default() }).unwrap();
    let reason = refused.unsolved.unwrap();
    assert!(
        matches!(reason, grainlab_micromechanics::MicroError::Probe(ProbeError::NotConverged { .. })),
        "{reason:?}"
    );
    assert_eq!(refused.report.stress, frozen.report.stress);
}

#[test]
fn packings_that_cannot_be_probed_are_refused_with_the_reason() {
    let cell = Cell::cube(1e-3).unwrap();
    let gas = packing(cell, vec![Vec3::zeros(), Vec3::repeat(5e-4)], 1e-4, 0.1, None);
    let refused = strain_probe(&gas, &StrainProbe::default()).unwrap_err();
    assert_eq!(refused, ProbeError::NoStiffness(NoStiffness::NoContacts { grains: 2 }));
    let pair = packing(cell, vec![Vec3::zeros(), Vec3::x() * 1.99e-4], 1e-4, 0.1, None);
    let refused = strain_probe(&pair, &StrainProbe::default()).unwrap_err();
    assert_eq!(refused, ProbeError::NoStiffness(NoStiffness::OnlyRattlers { grains: 2, needed: 2 }));
    for (settings, name) in [
        (StrainProbe { amplitude: 0.0, ..StrainProbe::default() }, "amplitude"),
        (StrainProbe { amplitude: f64::NAN, ..StrainProbe::default() }, "amplitude"),
        (StrainProbe { tolerance: 1.0, ..StrainProbe::default() }, "tolerance"),
        (StrainProbe { friction: Some(-1.0), ..StrainProbe::default() }, "friction"),
    ] {
        match strain_probe(&gas, &settings) {
            Err(ProbeError::Setting { name: found, .. }) => assert_eq!(found, name),
            other => panic!("{name}: {other:?}"),
        }
    }
    let short = StrainProbe { max_steps: 60, ..StrainProbe::default() };
    let message = strain_probe(&reference(), &short).unwrap_err().to_string();
    assert!(message.starts_with("column xx did not settle in 60 steps"), "{message}");
}
