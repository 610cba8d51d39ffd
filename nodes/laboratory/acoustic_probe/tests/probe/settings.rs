use grainlab_acoustic_probe::{Settings, SettingsError, parameters};
use grainlab_acoustics::{MethodSettings, Modes, Survey, time_of_flight::ArrivalPick};
use grainlab_core::Vec3;
use grainlab_node_kit::{Names, Parameters, RosArgs};

fn set(values: &[&str]) -> Result<Result<Settings, SettingsError>, String> {
    let mut args = vec!["--ros-args".to_owned()];
    values.iter().for_each(|v| args.extend(["-p".to_owned(), (*v).to_owned()]));
    let (ros, _) = RosArgs::parse(&args).unwrap();
    let names = Names::from_args("acoustic_probe", &ros).unwrap();
    let parameters = Parameters::resolve(&parameters(), "acoustic_probe", &names, &ros);
    Ok(Settings::try_from(&parameters.map_err(|e| e.to_string())?))
}

fn settings(values: &[&str]) -> grainlab_acoustics::Settings {
    set(values).unwrap().unwrap().0
}

#[test]
fn the_declared_defaults_are_the_typed_ones() {
    assert_eq!(settings(&[]), grainlab_acoustics::Settings::default());
}

#[test]
fn every_method_gets_its_own_settings() {
    let MethodSettings::Dispersion(d) =
        settings(&["wavelengths:=[30, 40, 50, 60]", "tolerance:=1e-8"]).method
    else {
        panic!("dispersion is the default")
    };
    assert_eq!((d.wavelengths, d.tolerance), (vec![30.0, 40.0, 50.0, 60.0], 1e-8));
    for (method, pick) in [
        ("first_arrival", ArrivalPick::FirstArrival),
        ("cross_correlation", ArrivalPick::CrossCorrelation),
        ("peak", ArrivalPick::Peak),
    ] {
        let MethodSettings::TimeOfFlight(f) =
            settings(&[&format!("method:={method}"), "frequencies:=[2e4, 4e4]", "cycles:=3"]).method
        else {
            panic!("a time of flight was asked for")
        };
        assert_eq!((f.pick, f.frequencies, f.cycles, f.copies), (pick, Some(vec![2e4, 4e4]), 3.0, None));
    }
    let MethodSettings::TimeOfFlight(f) = settings(&["method:=peak", "copies:=6", "amplitude:=1e-9"]).method
    else {
        panic!("a time of flight was asked for")
    };
    assert_eq!((f.copies, f.amplitude), (Some(6), 1e-9));
}

#[test]
fn rays_and_instrument_are_as_asked_for() {
    let s = settings(&[
        "axis:=1,0,1",
        "survey:=three",
        "modes:=shear",
        "signal_to_noise:=20",
        "shots:=64",
        "speed_noise:=0.003",
        "seed:=7",
        "sample_rate:=1e6",
    ]);
    assert!((s.axis.unwrap() - Vec3::new(1.0, 0.0, 1.0).normalize()).norm() < 1e-15);
    assert_eq!((s.survey, s.modes), (Survey::Minimal, Modes::Shear));
    let i = s.instrument;
    assert_eq!((i.signal_to_noise, i.shots, i.speed_noise, i.seed), (20.0, 64, 0.003, 7));
    assert_eq!(i.sample_rate, Some(1e6));
    assert_eq!(settings(&["axis:=unknown"]).axis, None);
    assert_eq!(settings(&["signal_to_noise:=.inf"]).instrument.signal_to_noise, f64::INFINITY);
}

#[test]
fn invalid_parameters_are_refused_by_name() {
    for (value, word) in [
        ("axis:=up", "\"axis\""),
        ("axis:=0,0,0", "\"axis\""),
        ("wavelengths:=[60, 80]", "\"wavelengths\" has 2"),
    ] {
        let error = set(&[value]).unwrap().unwrap_err().to_string();
        assert!(error.contains(word), "{value}: {error}");
    }
    for value in [
        "method:=ear",
        "method:=standing_wave",
        "wavelengths:=[1, 80, 60]",
        "speed_noise:=-1",
        "signal_to_noise:=.nan",
        "shots:=0",
    ] {
        assert!(set(&[value]).is_err(), "{value}");
    }
}
