//! Every model of the list against its own forward map. A new model in the list is tested automatically.

use crate::cases::{calibrations, case};
use grainlab_core::Material;
use grainlab_core::notes::Code;
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{
    Calibration, Conditions, Domain, EmtError, Measured, Model, Observation, StrainRatio, models,
};
use grainlab_testkit::{Random, nightly};
use proptest::prelude::*;

/// Cases of each model and calibration.
fn cases() -> usize {
    nightly(5_000, 100_000)
}

/// Every model with every calibration that contains its constants, and its domain there; each has at least
/// one.
fn calibrated() -> Vec<(&'static dyn Model, Calibration, Domain)> {
    let mut all = Vec::new();
    for model in models() {
        let before = all.len();
        for calibration in calibrations() {
            let domain = model.domain(&calibration);
            let (structure, conditions) = case(&mut Random::new(0), &domain);
            match model.predict(&structure, &conditions, &calibration) {
                Err(EmtError::NotCalibrated { .. }) => {}
                _ => all.push((*model, calibration, domain)),
            }
        }
        assert!(all.len() > before, "no calibration here holds the constants of {}", model.name());
    }
    all
}

#[test]
fn every_model_inverts_its_own_prediction_over_its_whole_domain_ends_included() {
    for (seed, (model, calibration, domain)) in calibrated().into_iter().enumerate() {
        let mut random = Random::new(seed as u64);
        let mut unstable = 0;
        for _ in 0..cases() {
            let (truth, conditions) = case(&mut random, &domain);
            let here = || format!("{} ({}): {truth:?} {conditions:?}", model.name(), calibration.name());
            let moduli = match model.predict(&truth, &conditions, &calibration) {
                Ok(moduli) => moduli,
                // A corner of the domain: so few contacts with so large an anisotropy carry no shear.
                Err(e) if e.is(Code::Unstable) => {
                    unstable += 1;
                    continue;
                }
                Err(e) => panic!("{}: {e}", here()),
            };
            let observed = Observation::new(moduli, conditions).checked().unwrap();
            let solution = model.solve(&observed, &calibration).unwrap_or_else(|e| panic!("{}: {e}", here()));
            for quantity in InferredQuantity::ALL {
                let Some(expected) = truth.get(quantity) else { continue };
                let found = solution.structure.get(quantity).unwrap();
                assert!((found - expected).abs() < 1e-9, "{}: {quantity} {found}", here());
            }
        }
        assert!(unstable * 100 <= cases(), "{}: {unstable}", model.name());
    }
}

/// Values slightly beyond each end of each range, one at a time.
#[test]
fn outside_its_domain_a_model_predicts_nothing_and_names_the_quantity() {
    for (model, calibration, domain) in calibrated() {
        let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
        let inside = Microstructure::of_values(domain.structure.map(|r| r.map(middle)));
        let conditions = Conditions {
            gamma: StrainRatio::given(middle(domain.gamma)),
            solid_fraction: Some(Measured::exact(0.63)),
            ..Conditions::at(100.0e3)
        };
        let refused = |structure: &Microstructure, conditions: &Conditions, what: &str| {
            let e = model.predict(structure, conditions, &calibration).unwrap_err();
            let named = match &e {
                EmtError::NoAnswer(why) if why.is(Code::BeyondDomain) => why.names(what),
                EmtError::NoAnswer(why) if why.is(Code::GammaOutOfRange) => what == "gamma/Delta",
                EmtError::NoState { quantity, .. } => *quantity == what,
                _ => false,
            };
            assert!(named, "{}: {what}: {e}", model.name());
        };
        model.predict(&inside, &conditions, &calibration).unwrap();
        let beyond = |[low, high]: [f64; 2]| [low - 1e-6, high + 1e-6, f64::NEG_INFINITY, f64::NAN];
        for (quantity, range) in InferredQuantity::ALL.into_iter().zip(domain.structure) {
            let Some(range) = range else { continue };
            for value in beyond(range) {
                refused(&inside.with(quantity, value), &conditions, quantity.name());
            }
        }
        for g in &beyond(domain.gamma)[..2] {
            refused(&inside, &Conditions { gamma: StrainRatio::given(*g), ..conditions }, "gamma/Delta");
        }
        for nu in &beyond([0.0, 0.5])[..2] {
            let grains = Material { poisson_ratio: *nu, ..Material::GLASS };
            let other = Conditions { material: Some(grains), ..conditions };
            refused(&inside, &other, "the Poisson ratio of the grains");
        }
        let e = model.predict(&Microstructure::default(), &conditions, &calibration).unwrap_err();
        assert!(matches!(e, EmtError::Missing { .. }), "{}: {e}", model.name());
        if domain.needs_solid_fraction {
            let unknown = Conditions { solid_fraction: None, ..conditions };
            let e = model.predict(&inside, &unknown, &calibration).unwrap_err();
            assert_eq!(e, EmtError::Missing { model: model.name(), missing: "the solid fraction" });
        }
    }
}

proptest! {
    /// Any positive numbers give an error or a finite estimate.
    #[test]
    fn no_input_gives_a_number_that_is_not_finite(
        log in prop::array::uniform4(-300.0..300.0f64), ratio in 0.0..2.2f64, g in -1.1..0.6f64,
        related in any::<bool>(), relative in 0.0..1.0f64,
    ) {
        let [g12, mut g13, mut theta, p] = log.map(|l| 10f64.powf(l));
        if related {
            (g13, theta) = (ratio * g12, 0.8 * g12);
        }
        let mut o = Observation::from_g12_g13_theta(g12, g13, theta, p, StrainRatio::given(g)).with_relative_error(relative);
        o.conditions.solid_fraction = Some(Measured { value: 0.63, stddev: 0.01 });
        for (model, calibration, _) in calibrated() {
            if let Ok(e) = model.infer(&o, &calibration) {
                for quantity in InferredQuantity::ALL {
                    let Some(value) = e.structure.get(quantity) else { continue };
                    prop_assert!(value.is_finite(), "{}: {:?}", model.name(), e.structure);
                    let interval = e.interval(quantity).unwrap();
                    prop_assert!(interval.iter().all(|v| v.is_finite()), "{}: {e:?}", model.name());
                }
            }
        }
    }
}

/// Each part of the covariance is finite, and their sum is not.
#[test]
fn a_covariance_that_overflows_is_an_error() {
    let g12 = 10f64.powf(152.8583937658127);
    let (g13, theta, p) = (0.1730961258837982 * g12, 0.8 * g12, 10f64.powf(130.96664356943654));
    let o = Observation::from_g12_g13_theta(g12, g13, theta, p, StrainRatio::given(0.0));
    let mut o = o.with_relative_error(0.3145655737916851);
    o.conditions.solid_fraction = Some(Measured { value: 0.63, stddev: 0.01 });
    let found = grainlab_emt::model("hertz-mindlin").unwrap().infer(&o, &Calibration::PAPER);
    assert!(matches!(found, Err(EmtError::NotFinite { .. })), "{found:?}");
}
