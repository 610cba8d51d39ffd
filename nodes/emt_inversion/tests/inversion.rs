//! The inversion node on the bus in memory, with the first row of the paper's Table III.

use emt::GammaSource;
use emt_inversion::{EmtInversion, Settings, microstructure_message, parameters};
use grainlab_msgs::boundary::MicrostructureReading;
use grainlab_msgs::msg::{Estimate, Microstructure, Moduli};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{stamp, topics};
use node_kit::{Bus, Demand, Hub, Level, Names, Node, Parameters, Publisher, Subscription};

/// Sample S1: k = 5.73, k̂ = 5.63, ε = .016.
fn s1() -> Moduli {
    Moduli {
        header: Header { stamp: stamp(0.125), frame_id: "cell".into() },
        source_step: 42,
        method: Moduli::METHOD_PROBE,
        g12: 121.71e6,
        g13: 127.37e6,
        theta: 144.38e6,
        pressure: 50e3,
        solid_fraction: 0.636,
        gamma_over_delta_total_known: true,
        gamma_over_delta_total: -0.0623,
        gamma_over_delta_contact_known: true,
        gamma_over_delta_contact: -0.02,
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        grain_density: 2500.0,
        ..Moduli::default()
    }
}

fn corrected(moduli: &Moduli, settings: Settings) -> Estimate {
    let message = microstructure_message(moduli, &settings).unwrap();
    assert!(MicrostructureReading::try_from(&message).is_ok(), "a reader refuses {message:?}");
    message.estimates.into_iter().next().unwrap()
}

#[test]
fn table_iii_comes_back_with_header_step_source_and_models_in_order() {
    let message = microstructure_message(&s1(), &Settings::default()).unwrap();
    assert_eq!((&message.header, message.source_step), (&s1().header, 42));
    assert_eq!(message.source, "moduli");
    let names: Vec<(&str, &str)> =
        message.estimates.iter().map(|e| (e.model.as_str(), e.calibration.as_str())).collect();
    assert_eq!(names, [("ratio", "paper"), ("ratio-as-printed", "paper")]);
    let e = &message.estimates[0];
    // The table prints three digits; ε is printed to .001.
    assert!(
        (e.k - 5.73).abs() < 5e-3 && (e.k_hat - 5.63).abs() < 5e-3 && (e.eps - 0.016).abs() < 1e-3,
        "{e:?}"
    );
    assert_eq!(e.status, Estimate::STATUS_OK);
}

#[test]
fn the_uncertainty_is_that_of_the_data_else_that_of_the_parameter_else_unknown() {
    let assumed = corrected(&s1(), Settings { modulus_error: 0.01, ..Settings::default() });
    assert!(assumed.covariance[0] > 0.0 && assumed.credible_level == 0.95);
    assert!(assumed.interval[0] < assumed.k && assumed.k < assumed.interval[1]);
    let unknown = corrected(&s1(), Settings { modulus_error: 0.0, ..Settings::default() });
    assert_eq!((unknown.covariance, unknown.interval, unknown.credible_level), ([0.0; 9], [0.0; 6], 0.0));
    assert_eq!(unknown.k, assumed.k);
    let mut measured = s1();
    for (place, modulus) in [(0, measured.g12), (4, measured.g13), (8, measured.theta)] {
        measured.covariance[place] = (0.02 * modulus).powi(2);
    }
    // Twice the error, four times the variance, whatever the parameter; the propagation is linear.
    let measured = corrected(&measured, Settings { modulus_error: 0.3, ..Settings::default() });
    assert!((measured.covariance[0] / assumed.covariance[0] - 4.0).abs() < 1e-9);
}

#[test]
fn an_estimate_says_which_strain_ratio_it_was_fed_with() {
    let of = |change: fn(&mut Moduli)| {
        let mut moduli = s1();
        change(&mut moduli);
        let e = corrected(&moduli, Settings::default());
        (e.gamma_over_delta, e.gamma_over_delta_source)
    };
    assert_eq!(of(|_| ()), (-0.0623, "total".into()));
    assert_eq!(of(|m| m.gamma_over_delta_total_known = false), (-0.02, "contact".into()));
    let unknown = |m: &mut Moduli| {
        (m.gamma_over_delta_total_known, m.gamma_over_delta_contact_known) = (false, false);
    };
    assert_eq!(of(unknown), (0.0, "zero".into()));
}

#[test]
fn data_without_a_solution_say_why_and_carry_no_values() {
    let of = |change: fn(&mut Moduli)| {
        let mut moduli = s1();
        change(&mut moduli);
        let e = corrected(&moduli, Settings::default());
        assert_eq!((e.k, e.k_hat, e.eps), (0.0, 0.0, 0.0));
        assert_eq!(e.warnings.len(), 1);
        (e.status, e.warnings[0].clone())
    };
    let (status, why) = of(|m| m.g12 = 0.0);
    assert!(status == Estimate::STATUS_UNDETERMINED && why.contains("G12"), "{status} {why}");
    let (status, why) = of(|m| m.g13 = 2.5 * m.g12);
    assert!(status == Estimate::STATUS_FAILED && why.contains("G13/G12"), "{status} {why}");
    let (status, why) = of(|m| m.theta = 10e6);
    assert!(status == Estimate::STATUS_FAILED && why.contains("G12/Theta"), "{status} {why}");
}

#[test]
fn a_latched_set_of_moduli_is_inverted_by_a_node_that_comes_late_and_a_broken_one_is_refused() {
    let hub = Hub::new(1);
    let mut bus = hub.bus(Names::new("source").unwrap());
    let source: Publisher<Moduli> = Publisher::advertise(&mut bus, &topics::MODULI).unwrap();
    let found: Subscription<Microstructure> =
        Subscription::subscribe(&mut bus, &topics::MICROSTRUCTURE, Demand::reliable(8)).unwrap();
    source.publish(&mut bus, &s1()).unwrap();
    let mut node_bus = hub.bus(Names::new("emt_inversion").unwrap());
    let mut node = EmtInversion::new(&mut node_bus, Settings::default()).unwrap();
    node.step(&mut node_bus).unwrap();
    let (message, _) = found.take_valid(&mut bus).unwrap().unwrap();
    assert_eq!(message, microstructure_message(&s1(), &Settings::default()).unwrap());
    source.publish(&mut bus, &Moduli { g12: f64::NAN, ..s1() }).unwrap();
    node.step(&mut node_bus).unwrap();
    assert!(found.take_valid(&mut bus).unwrap().is_none());
    assert_eq!((node_bus.received()[0].refused, node.health().level), (1, Level::Warn));
    source.publish(&mut bus, &s1()).unwrap();
    node.step(&mut node_bus).unwrap();
    assert_eq!(found.take_valid(&mut bus).unwrap().map(|(m, _)| m), Some(message));
    assert_eq!(node.health().level, Level::Ok);
}

#[test]
fn the_declared_defaults_are_the_typed_ones() {
    let settings = Settings::from(&Parameters::defaults(&parameters()));
    assert_eq!(settings, Settings::default());
}

#[test]
fn the_strain_ratio_that_feeds_the_models_can_be_chosen_and_moves_eps_by_as_much() {
    let with = |gamma| corrected(&s1(), Settings { gamma, ..Settings::default() });
    let (total, contact, zero) =
        (with(GammaSource::Total), with(GammaSource::Contact), with(GammaSource::Zero));
    assert_eq!((contact.gamma_over_delta, contact.gamma_over_delta_source.as_str()), (-0.02, "contact"));
    assert_eq!((zero.gamma_over_delta, zero.gamma_over_delta_source.as_str()), (0.0, "zero"));
    // ε ≈ (5/3) a + g, and k̂ does not depend on g at all.
    for (e, g) in [(&contact, -0.02), (&zero, 0.0)] {
        assert!((e.eps - total.eps - (g + 0.0623)).abs() < 3e-3, "{e:?}");
        assert!((e.k_hat - total.k_hat).abs() < 1e-12);
    }
    // An elastic ratio that nobody measured is replaced by that of the contacts.
    assert_eq!(with(GammaSource::Elastic).gamma_over_delta_source, "contact");
}
