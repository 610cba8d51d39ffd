//! The laws in a closed loop with one elastic component without inertia: dσ = −K rate dt.

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_servo::{ServoInput, control};

const K: f64 = 200.0e6;
const TARGET: f64 = 50.0e3;
const DT: f64 = 1.0e-6;

/// Stress errors σ − σ* before each of `periods` control periods, Pa, starting with 1 kPa too little
/// compression. Eq. 1 gets a tenth of the stiffness K; otherwise it would be refused beyond its limit.
fn errors(law: ServoLaw, stiffness: f64, dt: f64, periods: usize) -> Vec<f64> {
    let known = if matches!(law, ServoLaw::Integral { .. }) { 0.1 * K } else { K };
    errors_with(law, stiffness, known, dt, periods)
}

/// Errors of a loop whose law is given this stiffness.
fn errors_with(law: ServoLaw, stiffness: f64, known: f64, dt: f64, periods: usize) -> Vec<f64> {
    let mut request = ServoInput {
        stress: SymTensor { zz: TARGET - 1.0e3, ..SymTensor::default() },
        controls: std::array::from_fn(|i| {
            if i == 2 { ComponentControl::Stress(TARGET) } else { ComponentControl::Held }
        }),
        rate: [0.0; 6],
        rate_limit: 1.0e6,
        law,
        tangent: Some([0.0, 0.0, known, 0.0, 0.0, 0.0]),
        control_interval: dt,
    };
    let mut errors = Vec::with_capacity(periods);
    for _ in 0..periods {
        errors.push(request.stress.zz - TARGET);
        request.rate = control(&request).unwrap().rate;
        request.stress.zz -= stiffness * request.rate[2] * dt;
    }
    errors
}

/// The error decreases by exactly 1 − dt/τ per period, so that |error| decreases for every dt < 2τ.
#[test]
fn scaled_law_converges_for_every_interval_below_twice_the_response_time() {
    for share in [1.0e-3, 0.1, 0.5, 1.0, 1.5, 1.99] {
        let e = errors(ServoLaw::Scaled { response_time: DT / share }, K, DT, 20);
        for pair in e.windows(2) {
            // 1e-10 Pa is the rounding of a 50 kPa stress.
            assert!((pair[1] - (1.0 - share) * pair[0]).abs() < 1e-10, "dt/tau = {share}: {pair:?}");
        }
    }
}

/// A relaxed network is softer than the affine estimate: slower, but never unstable.
#[test]
fn scaled_law_converges_without_overshoot_on_a_network_softer_than_estimated() {
    let e = errors(ServoLaw::Scaled { response_time: 10.0 * DT }, 0.4 * K, DT, 600);
    assert!(e.iter().all(|&e| e <= 0.0), "overshoot");
    assert!(e[599].abs() < 1e-3, "{}", e[599]);
}

/// Eq. 1 on an elastic spring is the leapfrog of ë = −(gK/dt) e: sin(ω dt/2) = √(gK dt)/2, ω → √(gK/dt).
#[test]
fn eq_1_to_the_letter_oscillates_undamped_at_the_predicted_frequency() {
    let gain = 1.0e-4 / (K * DT);
    let periods = 200_000;
    let e = errors(ServoLaw::Integral { gain, leak: 0.0 }, K, DT, periods);
    let crossings: Vec<usize> = (1..periods).filter(|&n| e[n - 1] < 0.0 && e[n] >= 0.0).collect();
    let (first, last) = (crossings[0], crossings[crossings.len() - 1]);
    let measured = std::f64::consts::TAU * (crossings.len() - 1) as f64 / ((last - first) as f64 * DT);
    // Finite counting (a step in 2e5) and the leapfrog's gK dt/24 = 4e-6 both stay below 1e-4.
    assert!((measured / (gain * K / DT).sqrt() - 1.0).abs() < 1e-4, "{measured}");
    let late = e[periods - 1000..].iter().fold(0.0f64, |m, e| m.max(e.abs()));
    assert!((late / 1.0e3 - 1.0).abs() < 1e-3, "amplitude {late} Pa after {} swings", crossings.len());
}

/// One period multiplies (rate, error) by a matrix of determinant 1 − leak: amplitude falls by √(1 − leak).
#[test]
fn leak_damps_eq_1_at_the_predicted_pace() {
    let (gain, leak) = (0.01 / (K * DT), 0.01);
    let e = errors(ServoLaw::Integral { gain, leak }, K, DT, 3000);
    let peak = |from: usize| e[from..from + 64].iter().fold(0.0f64, |m, e| m.max(e.abs()));
    let measured = (peak(2000) / peak(1000)).ln() / 1000.0;
    // Windows of 64 periods contain one full oscillation; the position of its peak changes the ratio by a few
    // percent at most.
    assert!((measured / (0.5 * (1.0 - leak).ln()) - 1.0).abs() < 0.06, "{measured}");
    assert!(e[2999].abs() < 1e-3);
}

/// Without inertia or damping in the packing, only the sampling can make the error grow: |error| is bounded
/// just below the critical gain and grows a thousandfold just above, with and without a leak.
#[test]
fn eq_1_on_a_spring_is_stable_up_to_the_critical_gain_and_no_further() {
    for leak in [0.0, 0.3, 0.9] {
        let controls = std::array::from_fn(|i| {
            if i == 2 { ComponentControl::Stress(TARGET) } else { ComponentControl::Held }
        });
        let tangent = [0.0, 0.0, K, 0.0, 0.0, 0.0];
        let critical = grainlab_servo::critical_gain(&tangent, &controls, DT, leak);
        let largest = |gain: f64| {
            let e = errors(ServoLaw::Integral { gain, leak }, K, DT, 400);
            e.iter().fold(0.0f64, |m, e| m.max(e.abs()))
        };
        assert!(largest(0.98 * critical) < 2.0e4, "leak {leak}");
        assert!(largest(1.02 * critical) > 1.0e6, "leak {leak}");
    }
}

/// The number of intervals to 0.1 % of the error is the same for every stiffness and interval: no tuning is
/// needed.
#[test]
fn the_normalised_law_settles_in_as_many_intervals_at_every_stiffness_and_interval() {
    let leak = 0.3;
    let settle = |stiffness: f64, dt: f64| {
        let law = ServoLaw::Normalised { share: 0.3, leak };
        let e = errors_with(law, stiffness, stiffness, dt, 200);
        e.iter().rposition(|e| e.abs() > 1.0).unwrap()
    };
    let reference = settle(K, DT);
    assert!((10..100).contains(&reference), "{reference}");
    for (stiffness, dt) in [(0.01 * K, DT), (100.0 * K, DT), (K, 0.01 * DT), (3.0 * K, 7.0 * DT)] {
        // ±1 interval: rounding decides on which side of the threshold an error falls.
        assert!(settle(stiffness, dt).abs_diff(reference) <= 1);
    }
}
