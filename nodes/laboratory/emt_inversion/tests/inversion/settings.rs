use crate::{corrected, s1};
use grainlab_core::Vec3;
use grainlab_emt::{Calibration, StrainRatioSource};
use grainlab_emt_inversion::{Axis, Settings, SettingsError, microstructure_of_moduli, parameters};
use grainlab_node_kit::{Names, Parameters, RosArgs};

/// The built-in calibration as text, with another name.
fn mine() -> String {
    let grainlab = Calibration::builtin("grainlab").unwrap().to_toml().unwrap();
    let text = grainlab.replacen("\"grainlab\"", "\"mine\"", 1);
    assert_ne!(text, grainlab);
    text
}

/// Settings from a command line, with two files.
fn given(arguments: &[&str]) -> Result<Settings, SettingsError> {
    let owned: Vec<String> =
        std::iter::once("--ros-args").chain(arguments.iter().copied()).map(Into::into).collect();
    let (ros, _) = RosArgs::parse(&owned).unwrap();
    let names = Names::from_args("emt_inversion", &ros).unwrap();
    Settings::new(&Parameters::resolve(&parameters(), "emt_inversion", &names, &ros).unwrap(), |path| {
        match path {
            "mine.toml" => Ok(mine()),
            "cut.toml" => Ok(mine()[..40].to_owned()),
            _ => Err("no such file".to_owned()),
        }
    })
}

fn models_of(arguments: &[&str]) -> Vec<String> {
    let settings = given(arguments).unwrap();
    microstructure_of_moduli(&s1(), &settings).message.estimates.into_iter().map(|e| e.model).collect()
}

#[test]
fn the_declared_defaults_are_the_typed_ones() {
    let settings = Settings::new(&Parameters::defaults(&parameters()), |path| panic!("{path}"));
    assert_eq!(settings, Ok(Settings::default()));
}

#[test]
fn the_models_named_answer_each_once_and_in_the_order_of_the_list() {
    let all: Vec<&str> = grainlab_emt::models().iter().map(|m| m.name()).collect();
    assert_eq!(models_of(&[]), all);
    assert_eq!(models_of(&["-p", "models:=ratio, free-contact"]), ["free-contact", "ratio"]);
    assert_eq!(models_of(&["-p", "models:=ratio"]), ["ratio"]);
    let two = ["-p", "models:=ratio-as-printed, ratio,ratio-as-printed"];
    assert_eq!(models_of(&two), ["ratio", "ratio-as-printed"]);
    assert_ne!(given(&["-p", "models:=ratio"]).unwrap(), Settings::default());
    for bad in ["no-such", "ratio,", "''"] {
        let refused = given(&["-p", &format!("models:={bad}")]).unwrap_err().to_string();
        assert!(refused.contains("no model") && refused.contains("ratio-as-printed"), "{bad}: {refused}");
    }
}

/// Model and calibration of every estimate.
fn calibrations_of(arguments: &[&str]) -> Vec<(String, String)> {
    let message = microstructure_of_moduli(&s1(), &given(arguments).unwrap()).message;
    message.estimates.into_iter().map(|e| (e.model, e.calibration)).collect()
}

#[test]
fn every_model_gets_its_own_constants_or_all_of_them_those_named() {
    for (model, calibration) in calibrations_of(&[]) {
        let ours = ["relaxed"].contains(&model.as_str());
        assert_eq!(calibration, if ours { "grainlab" } else { "paper" }, "{model}");
    }
    for (name, expected) in [("paper", "paper"), ("grainlab", "grainlab"), ("mine.toml", "mine")] {
        for (model, calibration) in calibrations_of(&["-p", &format!("calibration:={name}")]) {
            assert_eq!(calibration, expected, "{model}");
        }
    }
    let of = |name: &str| corrected(&s1(), &given(&["-p", &format!("calibration:={name}")]).unwrap());
    assert_eq!(corrected(&s1(), &Settings::default()), of("paper"));
    assert!((of("paper").k[0] - of("grainlab").k[0]).abs() > 1e-2, "other constants, another k");
    assert_eq!(of("mine.toml").k, of("grainlab").k);
}

#[test]
fn what_a_calibration_has_learned_of_a_model_is_the_part_that_the_model_leaves_out() {
    let of = |name: &str| corrected(&s1(), &given(&["-p", &format!("calibration:={name}")]).unwrap());
    let (paper, ours) = (of("paper"), of("grainlab"));
    for e in [&paper, &ours] {
        assert!(e.covariance_model[0] > 0.0 && e.covariance_model[18] > 0.0, "{e:?}");
        assert!(e.covariance[18] > e.covariance_model[18], "the data have a part in it, too");
    }
    assert_ne!(paper.covariance_model, ours.covariance_model);
}

#[test]
fn a_calibration_that_is_none_is_refused_by_name() {
    let refused = |name: &str| given(&["-p", &format!("calibration:={name}")]).unwrap_err().to_string();
    let text = refused("papper");
    assert!(text.contains("\"papper\"") && text.contains("default, paper, grainlab"), "{text}");
    let text = refused("gone.toml");
    assert!(text.contains("gone.toml") && text.contains("no such file"), "{text}");
    assert!(matches!(given(&["-p", "calibration:=cut.toml"]), Err(SettingsError("calibration", _))));
}

#[test]
fn an_axis_is_a_word_or_three_numbers_of_any_length_but_zero() {
    let axis = |text: &str| given(&["-p", &format!("axis:={text}")]).map(|s| s.axis);
    assert_eq!(
        (axis("e3"), axis("found"), axis("stated")),
        (Ok(Axis::E3), Ok(Axis::Found), Ok(Axis::Stated))
    );
    assert_eq!(axis("0,0,2"), Ok(Axis::Given(Vec3::z())));
    assert_eq!(axis("1e300, 0, 0"), Ok(Axis::Given(Vec3::x())), "no overflow on the way to a unit vector");
    let Ok(Axis::Given(v)) = axis("'-1,2,-2'") else { panic!("a direction") };
    assert!((v - Vec3::new(-1.0, 2.0, -2.0) / 3.0).norm() < 1e-15);
    for bad in ["e1", "0,0,0", "1,2", "1,2,3,4", "1,inf,0", "nan,0,1", "x,y,z", "''"] {
        assert!(matches!(axis(bad), Err(SettingsError("axis", _))), "{bad}: {:?}", axis(bad));
    }
}

#[test]
fn the_strain_ratio_that_feeds_the_models_can_be_chosen_and_moves_eps_by_as_much() {
    let with =
        |choice: &str| corrected(&s1(), &given(&["-p", &format!("gamma_over_delta:={choice}")]).unwrap());
    let (total, contact, zero) = (with("total"), with("contact"), with("zero"));
    assert_eq!(
        (total.gamma_over_delta.clone(), total.gamma_over_delta_source.as_str()),
        (vec![-0.0623], "total")
    );
    assert_eq!(
        (contact.gamma_over_delta.clone(), contact.gamma_over_delta_source.as_str()),
        (vec![-0.02], "contact")
    );
    assert_eq!((zero.gamma_over_delta.clone(), zero.gamma_over_delta_source.as_str()), (vec![0.0], "zero"));
    // ε ≈ (5/3) a + g, and k̂ does not depend on g.
    for (e, g) in [(&contact, -0.02), (&zero, 0.0)] {
        assert!((e.eps[0] - total.eps[0] - (g + 0.0623)).abs() < 3e-3, "{e:?}");
        assert!((e.k_hat[0] - total.k_hat[0]).abs() < 1e-12);
    }
    assert_eq!(given(&["-p", "gamma_over_delta:=elastic"]).unwrap().gamma, StrainRatioSource::Elastic);
    // An elastic ratio that was not measured is replaced by that of the contacts.
    assert_eq!(with("elastic").gamma_over_delta_source, "contact");
}
