//! The parameters of the node.

use grainlab_acoustics::{Instrument, dispersion, time_of_flight};
use grainlab_node_kit::{ParameterSpec, Range, parameters};

/// The methods that time a burst.
const OF_BURSTS: &[&str] = &["first_arrival", "cross_correlation", "peak"];

/// The methods on which a parameter acts; `None`: all of them.
pub fn methods_with(parameter: &str) -> Option<&'static [&'static str]> {
    match parameter {
        "wavelengths" | "tolerance" | "max_iterations" => Some(&["dispersion"]),
        "frequencies" | "cycles" | "copies" | "amplitude" | "wave_friction" | "sample_rate"
        | "signal_to_noise" | "jitter" | "shots" => Some(OF_BURSTS),
        _ => None,
    }
}

/// The parameters of the node: the set of waves, the methods, noise and errors of the instrument.
pub fn parameters() -> Vec<ParameterSpec> {
    let dispersion = dispersion::Settings::default();
    let flight = time_of_flight::Settings::default();
    let d = Instrument::default();
    parameters! {
        "method" "dispersion", Range::Choice(&["dispersion", "first_arrival", "cross_correlation", "peak"]),
            "how speeds are measured: dispersion (frequencies of long waves in the frozen contact network), or time of flight \
             by first_arrival, cross_correlation or peak";
        "axis" "e3", Range::Any, "axis of symmetry of the rays: e3, unknown, or a direction x,y,z of any length";
        "survey" "complete", Range::Choice(&["complete", "three", "everywhere"]),
            "which rays are sent: complete (along the axis, and enough across and at 45 degrees to average over azimuths), \
             three (one of each), everywhere (over the hemisphere; always used if the axis is unknown)";
        "modes" "all", Range::Choice(&["all", "compression", "shear"]),
            "polarizations sent along each ray: all, compression, shear";
        "wavelengths" dispersion.wavelengths, Range::Double { min: 2.000_001, max: 1e6 },
            "wavelengths of dispersion, mean grain diameters: three or more, each above 2";
        "tolerance" dispersion.tolerance, Range::Double { min: 1e-12, max: 1e-2 },
            "tolerance of the relative error of the squared frequencies of dispersion, 1";
        "max_iterations" i64::from(dispersion.max_iterations), Range::Integer { min: 1, max: 10_000_000 },
            "maximum number of iterations for a mode of dispersion";
        "copies" 0_i64, Range::Integer { min: 0, max: 256 },
            "repetitions of the packing along the path of time of flight, 0 for as many as are needed";
        "frequencies" Vec::<f64>::new(), Range::Positive,
            "centre frequencies of time of flight, Hz; empty for those of waves about 20, 28 and 40 mean grain diameters long";
        "cycles" flight.cycles, Range::Double { min: 1.0, max: 100.0 }, "periods of a burst of time of flight";
        "amplitude" 0.0, Range::Double { min: 0.0, max: 1e-2 }, "peak strain of the waves of time of flight, 1; 0 for 1e-8";
        "wave_friction" -1.0, Range::Double { min: -1.0, max: f64::INFINITY },
            "friction while waves pass (not for dispersion): -1 for that of the packing, whose contacts at the limit slide \
             under any wave; inf for no sliding";
        "sample_rate" 0.0, Range::Double { min: 0.0, max: 1e12 }, "sampling rate, Hz; 0 for forty samples per period";
        "signal_to_noise" d.signal_to_noise, Range::Double { min: -60.0, max: f64::INFINITY },
            "signal to noise of one shot, dB; inf for no noise";
        "jitter" d.jitter, Range::Double { min: 0.0, max: 1.0 },
            "standard deviation of the trigger's time from shot to shot, s";
        "shots" i64::from(d.shots), Range::Integer { min: 1, max: 1_000_000 }, "shots that are averaged";
        "speed_noise" d.speed_noise, Range::Double { min: 0.0, max: 0.5 },
            "additional relative standard deviation of every speed, 1: alignment, lengths";
        "seed" d.seed as i64, Range::Integer { min: 0, max: i64::MAX }, "seed of all noise";
    }
}
