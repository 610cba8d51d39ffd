use super::*;
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_servo::ServoInput;

pub(crate) fn request(sequence: u64) -> msg::Stress {
    let value = 1.0 + (sequence as f64).sin();
    let request = ServoRequest {
        sequence,
        step: 20 * sequence,
        phase: u32::try_from(sequence / 10_000).unwrap(),
        time: 1e-6 * sequence as f64,
        input: ServoInput {
            stress: SymTensor { xx: value, yy: value, zz: value, ..SymTensor::default() },
            controls: [ComponentControl::Stress(2.0); 6],
            rate: [0.0; 6],
            rate_limit: 1.0,
            law: ServoLaw::Scaled { response_time: 1e-3 },
            tangent: Some([1e6; 6]),
            control_interval: 1e-6,
        },
        asymmetry: 0.0,
        strain: SymTensor::default(),
        solid_fraction: 0.6,
        coordination: 4.0,
        unbalanced: 1e-3,
    };
    msg::Stress::try_from(&request).unwrap()
}

#[test]
fn the_history_of_a_long_run_is_bounded_and_ends_with_its_last_value() {
    let mut lab = Laboratory::new(None, Duration::ZERO);
    let size = |lab: &Laboratory| lab.timeline.drawings(&mut Default::default()).len();
    let take = |lab: &mut Laboratory, range: std::ops::Range<u64>| {
        range.for_each(|n| lab.request(&request(n), Duration::from_millis(n)));
        size(lab)
    };
    let first = take(&mut lab, 0..10_000);
    let whole = take(&mut lab, 10_000..300_000);
    assert_eq!(lab.timeline.count(), 300_000);
    // Thirty phases, each with at most 100 bins.
    assert!(whole < 40 * first, "{first} bytes, then {whole}");
    assert_eq!(lab.latest.as_ref().map(|r| r.sequence), Some(299_999));
    // In one phase, more values make the curves no longer.
    let mut one = Laboratory::new(None, Duration::ZERO);
    let at = |n: u64| msg::Stress { phase: 1, ..request(n) };
    (0..50_000).for_each(|n| one.request(&at(n), Duration::ZERO));
    let early = size(&one);
    (50_000..500_000).for_each(|n| one.request(&at(n), Duration::ZERO));
    assert!(size(&one) < 2 * early, "{early} bytes, then {}", size(&one));
}

#[test]
fn a_plot_of_shear_that_was_shown_stays_when_the_shear_becomes_small() {
    let with_shear = |n: u64, normal: f64| {
        let mut message = request(n);
        (message.stress.xx, message.stress.xy) = (normal, 1.0);
        message
    };
    let shown = |all: &[f64], plots: &mut std::collections::BTreeSet<&'static str>| {
        let mut lab = Laboratory::new(None, Duration::ZERO);
        (0..).zip(all).for_each(|(n, normal)| lab.request(&with_shear(n, *normal), Duration::ZERO));
        lab.timeline.drawings(plots).contains("Shear stress")
    };
    let mut plots = Default::default();
    assert!(shown(&[10.0], &mut plots) && shown(&[10.0, 1e4], &mut plots));
    assert!(!shown(&[10.0, 1e4], &mut Default::default()));
}

#[test]
fn messages_that_do_not_satisfy_the_contract_are_counted_and_change_nothing() {
    let mut lab = Laboratory::new(None, Duration::ZERO);
    lab.request(&msg::Stress { solid_fraction: f64::NAN, ..request(1) }, Duration::ZERO);
    lab.run_state(&msg::RunState { progress: 7.0, ..msg::RunState::default() }, Duration::ZERO);
    lab.packing(&msg::Packing::default());
    assert_eq!(lab.refused, 3);
    assert!(lab.latest.is_none() && lab.state.is_none() && lab.timeline.count() == 0);
}

#[test]
fn the_grains_of_now_are_shown_until_a_later_packing_comes_and_never_after_the_end() {
    let at = |step: u64| {
        let mut packing = grainlab_msgs::boundary::packing_message(&pair(), "two", Vec::new());
        packing.step = step;
        packing
    };
    let mut lab = Laboratory::new(None, Duration::ZERO);
    lab.state_of_grains(&at(10));
    assert_eq!((lab.views().len(), lab.timeline.last().is_none()), (1, true));
    lab.packing(&at(20));
    assert_eq!(lab.views().len(), 1, "the packing is later");
    lab.state_of_grains(&at(30));
    assert_eq!((lab.views().len(), lab.timeline.film().count()), (2, 1));
    lab.left();
    assert_eq!(lab.views().len(), 1);
}

/// Two grains that do not touch.
pub(crate) fn pair() -> Packing {
    use grainlab_core::{Cell, Vec3};
    Packing {
        ids: vec![1, 2],
        friction: 0.3,
        time_step: 1e-6,
        ..Packing::at_rest(Cell::cube(8.0).unwrap(), vec![1.0; 2], vec![Vec3::repeat(1.0), Vec3::repeat(5.0)])
    }
}
