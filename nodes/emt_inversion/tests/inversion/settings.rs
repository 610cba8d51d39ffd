use crate::{corrected, s1};
use emt::{Calibration, GammaSource};
use emt_inversion::{
    Axis, CalibrationChoice, Models, Settings, SettingsError, microstructure_message, parameters,
};
use grains::Vec3;
use node_kit::{Names, Parameters, RosArgs};

/// As they come from a command line.
fn given(arguments: &[&str]) -> Result<Settings, SettingsError> {
    let owned: Vec<String> =
        std::iter::once("--ros-args").chain(arguments.iter().copied()).map(Into::into).collect();
    let (ros, _) = RosArgs::parse(&owned).unwrap();
    let names = Names::from_args("emt_inversion", &ros).unwrap();
    Settings::try_from(&Parameters::resolve(&parameters(), "emt_inversion", &names, &ros).unwrap())
}

fn models_of(arguments: &[&str]) -> Vec<String> {
    let settings = given(arguments).unwrap();
    microstructure_message(&s1(), &settings).unwrap().estimates.into_iter().map(|e| e.model).collect()
}

#[test]
fn the_declared_defaults_are_the_typed_ones() {
    assert_eq!(Settings::try_from(&Parameters::defaults(&parameters())), Ok(Settings::default()));
}

#[test]
fn the_models_named_answer_each_once_and_in_the_order_of_the_list() {
    let all: Vec<&str> = emt::models().iter().map(|m| m.name()).collect();
    assert_eq!(models_of(&[]), all);
    assert_eq!(models_of(&["-p", "models:=ratio"]), ["ratio"]);
    let two = ["-p", "models:=ratio-as-printed, ratio,ratio-as-printed"];
    assert_eq!(models_of(&two), ["ratio", "ratio-as-printed"]);
    assert_ne!(Models::named("ratio"), Ok(Models::all()));
    for bad in ["no-such", "ratio,", "''"] {
        let refused = given(&["-p", &format!("models:={bad}")]).unwrap_err().to_string();
        assert!(refused.contains("no model") && refused.contains("ratio-as-printed"), "{bad}: {refused}");
    }
}

#[test]
fn a_calibration_is_that_of_each_model_or_one_for_all_and_named_in_the_result() {
    assert_eq!(given(&[]).unwrap().calibration, CalibrationChoice::Default);
    let paper = given(&["-p", "calibration:=paper"]).unwrap();
    assert_eq!(paper.calibration, CalibrationChoice::One(Calibration::PAPER));
    assert_eq!(
        corrected(&s1(), &Settings::default()).calibration,
        "paper",
        "the paper's models have the paper's"
    );
    let mut other = Settings::default();
    let isotropic = emt::Isotropic::new([190.0, -3.9, 80.0, -0.4], emt::Quantity::K, [4.4, 6.0]).unwrap();
    other.calibration =
        CalibrationChoice::One(Calibration::of_isotropic("mine", isotropic, grains::Material::GLASS));
    let (a, b) = (corrected(&s1(), &other), corrected(&s1(), &paper));
    assert_eq!((a.calibration.as_str(), b.calibration.as_str()), ("mine", "paper"));
    assert!((a.k - b.k).abs() > 0.1, "{} {}: the constants are not those named", a.k, b.k);
    let refused = given(&["-p", "calibration:=papper"]).unwrap_err().to_string();
    assert!(refused.contains("\"papper\"") && refused.contains("default, paper"), "{refused}");
}

#[test]
fn an_axis_is_a_word_or_three_numbers_of_any_length_but_zero() {
    let axis = |text: &str| given(&["-p", &format!("axis:={text}")]).map(|s| s.axis);
    assert_eq!((axis("e3"), axis("found")), (Ok(Axis::E3), Ok(Axis::Found)));
    assert_eq!(axis("0,0,2"), Ok(Axis::Given(Vec3::z())));
    assert_eq!(axis("1e300, 0, 0"), Ok(Axis::Given(Vec3::x())), "no overflow on the way to a unit vector");
    let Ok(Axis::Given(v)) = axis("'-1,2,-2'") else { panic!("a direction") };
    assert!((v - Vec3::new(-1.0, 2.0, -2.0) / 3.0).norm() < 1e-15);
    for bad in ["e1", "0,0,0", "1,2", "1,2,3,4", "1,inf,0", "nan,0,1", "x,y,z", "''"] {
        assert!(matches!(axis(bad), Err(SettingsError::Axis(_))), "{bad}: {:?}", axis(bad));
    }
}

#[test]
fn the_strain_ratio_that_feeds_the_models_can_be_chosen_and_moves_eps_by_as_much() {
    let with =
        |choice: &str| corrected(&s1(), &given(&["-p", &format!("gamma_over_delta:={choice}")]).unwrap());
    let (total, contact, zero) = (with("total"), with("contact"), with("zero"));
    assert_eq!((total.gamma_over_delta, total.gamma_over_delta_source.as_str()), (-0.0623, "total"));
    assert_eq!((contact.gamma_over_delta, contact.gamma_over_delta_source.as_str()), (-0.02, "contact"));
    assert_eq!((zero.gamma_over_delta, zero.gamma_over_delta_source.as_str()), (0.0, "zero"));
    // ε ≈ (5/3) a + g, and k̂ does not depend on g at all.
    for (e, g) in [(&contact, -0.02), (&zero, 0.0)] {
        assert!((e.eps - total.eps - (g + 0.0623)).abs() < 3e-3, "{e:?}");
        assert!((e.k_hat - total.k_hat).abs() < 1e-12);
    }
    assert_eq!(given(&["-p", "gamma_over_delta:=elastic"]).unwrap().gamma, GammaSource::Elastic);
    // An elastic ratio that nobody measured is replaced by that of the contacts.
    assert_eq!(with("elastic").gamma_over_delta_source, "contact");
}
