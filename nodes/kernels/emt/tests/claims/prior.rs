//! Prior files, and estimates with a prior.

use crate::ours;
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{
    Calibration, Conditions, Density, EmtError, Inversion, Measured, Model, Moduli, Modulus, Observation,
    Prior, PriorError, Relaxed,
};

fn observation() -> Observation {
    let moduli = Moduli::of_values([74.2e6, 81.8e6, 137.0e6, 226.7e6, 264.8e6, 89.5e6].map(Some));
    let conditions = Conditions {
        stress_ratio: Some(Measured::exact(0.0)),
        size_spread: Some(0.0),
        ..Conditions::at(5e4)
    };
    Observation::new(moduli, conditions).with_relative_error(0.01)
}

fn estimate() -> Inversion {
    Relaxed.infer(&observation(), ours()).unwrap()
}

const ALL: [InferredQuantity; 4] =
    [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness];

#[test]
fn a_flat_prior_gives_the_estimate_without_one_to_rounding() {
    let (without, flat) =
        (estimate(), Prior::parse("[z]\ndistribution = \"uniform\"\nlow = -100\nhigh = 100\n"));
    let with = without.with_prior(&flat.unwrap()).unwrap();
    for q in ALL {
        let (a, b) = (without.structure.get(q).unwrap(), with.structure.get(q).unwrap());
        assert!((a - b).abs() < 1e-12, "{q}: {a} {b}");
        let (a, b) = (without.stddev(q).unwrap(), with.stddev(q).unwrap());
        assert!((a / b - 1.0).abs() < 1e-10, "{q}: {a} {b}");
    }
}

#[test]
fn a_very_narrow_prior_is_the_estimate() {
    for text in [
        "[z]\ndistribution = \"normal\"\nmean = 4.9\nstddev = 1e-7\n",
        "[z]\ndistribution = \"uniform\"\nlow = 4.8999999\nhigh = 4.9000001\n",
        "[z]\ndistribution = \"truncated-normal\"\nmean = 4.9\nstddev = 1e-7\nlow = 4\n",
    ] {
        let with = estimate().with_prior(&Prior::parse(text).unwrap()).unwrap();
        assert!((with.structure.z.unwrap() - 4.9).abs() < 1e-7, "{text}{:?}", with.structure);
        assert!(with.stddev(InferredQuantity::Z).unwrap() < 1.1e-7);
    }
}

/// The gain of a scalar datum: σ²/(σ² + s²).
#[test]
fn a_normal_prior_is_weighed_by_the_variances_and_the_parts_of_the_uncertainty_add_up() {
    let without = estimate();
    let (z, sigma) = (without.structure.z.unwrap(), without.stddev(InferredQuantity::Z).unwrap());
    let prior = Prior::default().with(InferredQuantity::Z, Density::normal(z + 0.1, 2.0 * sigma).unwrap());
    let with = without.with_prior(&prior).unwrap();
    assert!((with.structure.z.unwrap() - (z + 0.1 / 5.0)).abs() < 1e-12);
    assert!((with.stddev(InferredQuantity::Z).unwrap() / (sigma * 0.8f64.sqrt()) - 1.0).abs() < 1e-12);
    let moved = with.structure.k.unwrap() - without.structure.k.unwrap();
    assert!(moved > 0.5 * 0.02, "k is correlated with z, and follows by {moved}");
    let parts =
        with.data_covariance.unwrap() + with.model_covariance.unwrap() + with.prior_covariance.unwrap();
    assert!((parts - with.covariance().unwrap()).amax() < 1e-15);
    assert!(with.prior_covariance.unwrap()[(2, 2)] > 0.0);
}

#[test]
fn intervals_end_at_the_limits_of_the_prior_and_a_contradiction_is_a_warning() {
    let without = estimate();
    let z = without.structure.z.unwrap();
    let above = Prior::default().with(InferredQuantity::Z, Density::uniform(z, 6.0).unwrap());
    let with = without.with_prior(&above).unwrap();
    assert!(with.interval(InferredQuantity::Z).unwrap()[0] >= z && with.structure.z.unwrap() > z);
    let far = Prior::default().with(InferredQuantity::Z, Density::normal(6.2, 0.1).unwrap());
    let with = without.with_prior(&far).unwrap();
    let is_conflict = |w: &Note| w.is(Code::PriorConflict) && w.names("z");
    assert!(with.notes.iter().any(is_conflict) && !without.notes.iter().any(is_conflict));
}

#[test]
fn a_prior_that_moves_the_structure_out_of_the_domain_is_refused() {
    let domain = Relaxed.prior_domain(ours());
    for (quantity, density) in [
        (InferredQuantity::K, Density::normal(-5.0, 0.01).unwrap()),
        (InferredQuantity::K, Density::uniform(20.0, 100.0).unwrap()),
        (InferredQuantity::EpsStiffness, Density::uniform(2.0, 3.0).unwrap()),
    ] {
        let with = estimate().with_prior(&Prior::default().with(quantity, density)).unwrap();
        let refused = with.within(&domain).unwrap_err();
        assert!(
            matches!(refused, EmtError::PriorContradicts { .. }) && refused.is_input_error(),
            "{refused}"
        );
    }
    let near = Prior::default().with(InferredQuantity::K, Density::normal(5.0, 0.1).unwrap());
    assert!(estimate().with_prior(&near).unwrap().within(&domain).is_ok());
}

#[test]
fn a_prior_of_what_the_data_do_not_determine_is_said_to_be_unused() {
    let one = Observation {
        moduli: Moduli::NONE.with(Modulus::G12, observation().moduli.get(Modulus::G12).unwrap()),
        covariance: None,
        ..observation()
    };
    let estimate = Relaxed.infer(&one.with_relative_error(0.01), ours()).unwrap();
    assert_eq!(estimate.structure.eps, None);
    let prior = Prior::default().with(InferredQuantity::Eps, Density::normal(0.08, 1e-3).unwrap());
    let with = estimate.with_prior(&prior).unwrap();
    let unused = Note::prior_unused("eps");
    assert!(with.notes.contains(&unused) && with.structure == estimate.structure, "{:?}", with.notes);
}

/// A calibration without errors of its own has those of the models with the constants of the paper.
#[test]
fn exact_moduli_are_weighed_against_a_prior_by_the_error_of_the_model() {
    let exact = Observation { covariance: None, ..observation() };
    let estimate = grainlab_emt::model("ratio").unwrap().infer(&exact, &Calibration::PAPER).unwrap();
    let prior = Prior::default().with(InferredQuantity::K, Density::normal(5.0, 1.0).unwrap());
    let with = estimate.with_prior(&prior).unwrap();
    let sigma = |e: &Inversion| e.stddev(InferredQuantity::K).unwrap();
    assert!(sigma(&with) < sigma(&estimate) && sigma(&estimate) > 0.05);
}

#[test]
fn a_prior_file_is_what_is_written() {
    let domain = Relaxed.prior_domain(ours());
    let prior = Prior::uniform(&domain)
        .with(InferredQuantity::K, Density::truncated(4.5, 0.3, [4.0, f64::INFINITY]).unwrap())
        .with(InferredQuantity::EpsStiffness, Density::normal(0.0, 0.05).unwrap());
    assert_eq!(Prior::parse(&prior.to_toml()).unwrap(), prior);
    assert_eq!(Prior::uniform(&domain).quantities().count(), 2, "k and eps_stiffness follow");
}

#[test]
fn faults_of_a_prior_file_are_named() {
    let section = |lines: &str| format!("[eps]\n{lines}");
    for (text, words) in [
        ("", &["[z]", "no section"][..]),
        ("[zz]\ndistribution = \"normal\"", &["no quantity [zz]", "eps_stiffness"]),
        (&section("distribution = \"gaussian\""), &["gaussian", "truncated-normal", "line 2"]),
        (&section("distribution = \"normal\"\nmean = 0\nsigma = 1"), &["unknown field `sigma`", "stddev"]),
        (&section("distribution = \"normal\"\nmean = 0"), &["[eps]", "stddev is missing"]),
        (&section("distribution = \"normal\"\nmean = nan\nstddev = 1"), &["[eps]", "mean = NaN", "finite"]),
        (
            &section("distribution = \"normal\"\nmean = 0\nstddev = 0"),
            &["[eps]", "stddev = 0", "more than 0"],
        ),
        (
            &section("distribution = \"normal\"\nmean = 0\nstddev = 1\nlow = 0"),
            &["[eps]", "truncated-normal"],
        ),
        (&section("distribution = \"uniform\"\nlow = 1\nhigh = 0"), &["[eps]", "low = 1 is above high = 0"]),
        (&section("distribution = \"uniform\"\nlow = 1\nhigh = 1"), &["[eps]", "both 1"]),
        (&section("distribution = \"truncated-normal\"\nmean = 0\nstddev = 1"), &["low or high is missing"]),
        (
            &section("distribution = \"truncated-normal\"\nmean = 0\nstddev = 1e-6\nlow = 1e3\nhigh = 2e3"),
            &["no probability"],
        ),
    ] {
        let fault = Prior::parse(text).unwrap_err();
        assert!(words.iter().all(|w| fault.to_string().contains(w)), "{text}\n{fault}");
        assert!(matches!(fault, PriorError::Text(_) | PriorError::Section { .. }));
    }
}

#[test]
fn a_prior_outside_the_domain_of_the_model_is_refused() {
    let domain = Relaxed.prior_domain(ours());
    let prior = Prior::default().with(InferredQuantity::Z, Density::uniform(8.0, 9.0).unwrap());
    let fault = prior.completed(&domain).unwrap_err();
    assert!(matches!(fault, EmtError::PriorOutsideDomain { model: "relaxed", quantity: "z", .. }), "{fault}");
}

#[test]
fn a_prior_far_from_the_data_contradicts_them_and_the_structure_that_it_gives_is_judged_anew() {
    let structure = Microstructure { z: Some(4.8), eps: Some(0.02), ..Microstructure::default() };
    let moduli = Relaxed.predict(&structure, &observation().conditions, ours()).unwrap();
    let exact = Observation::new(moduli, observation().conditions).with_relative_error(0.01);
    let without = Relaxed.infer(&exact, ours()).unwrap();
    assert_eq!(without.status(), Status::Ok, "{:?}", without.notes);
    for text in [
        "[z]\ndistribution = \"uniform\"\nlow = 6\nhigh = 6.2\n",
        "[z]\ndistribution = \"normal\"\nmean = 6\nstddev = 0.1\n",
        // Wide, but its limit is far from the data.
        "[z]\ndistribution = \"uniform\"\nlow = 5.4\nhigh = 6.4\n",
        "[eps]\ndistribution = \"normal\"\nmean = 0.25\nstddev = 0.002\n",
    ] {
        let with = without.with_prior(&Prior::parse(text).unwrap()).unwrap();
        assert_eq!(with.status(), Status::Contradictory, "{text}{:?}", with.notes);
        let outside = with.structure.eps.is_some_and(|eps| eps > 0.22);
        let said = with.notes.iter().any(|w| w.is(Code::AnisotropyOutsideCalibration));
        assert_eq!(outside, said, "{text}{:?}", with.structure);
    }
    let z = without.structure.z.unwrap();
    let near = format!("[z]\ndistribution = \"normal\"\nmean = {z}\nstddev = 0.1\n");
    assert_eq!(without.with_prior(&Prior::parse(&near).unwrap()).unwrap().status(), Status::Ok);
}
