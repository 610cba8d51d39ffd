//! The parameters of the node.

use grainlab_acoustics::{Instrument, dispersion, time_of_flight};
use grainlab_node_kit::{ParameterSpec, Range};

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
    vec![
        ParameterSpec::new(
            "method",
            "dispersion",
            "how speeds are measured: dispersion (frequencies of long waves in the frozen contact network), or \
             time of flight by first_arrival, cross_correlation or peak",
        )
        .within(Range::Choice(&["dispersion", "first_arrival", "cross_correlation", "peak"])),
        ParameterSpec::new(
            "axis",
            "e3",
            "axis of symmetry of the rays: e3, unknown, or a direction x,y,z of any length",
        ),
        ParameterSpec::new(
            "survey",
            "complete",
            "which rays are sent: complete (along the axis, and enough across and at 45 degrees to average over azimuths), \
             three (one of each), everywhere (over the hemisphere; always used if the axis is unknown)",
        )
        .within(Range::Choice(&["complete", "three", "everywhere"])),
        ParameterSpec::new("modes", "all", "polarizations sent along each ray: all, compression, shear")
            .within(Range::Choice(&["all", "compression", "shear"])),
        ParameterSpec::new(
            "wavelengths",
            dispersion.wavelengths,
            "wavelengths of dispersion, mean grain diameters: three or more, each above 2",
        )
        .within(Range::Double { min: 2.000_001, max: 1e6 }),
        ParameterSpec::new("tolerance", dispersion.tolerance, "tolerance of the relative error of the squared frequencies of \
             dispersion, 1")
            .within(Range::Double { min: 1e-12, max: 1e-2 }),
        ParameterSpec::new(
            "max_iterations",
            i64::from(dispersion.max_iterations),
            "maximum number of iterations for a mode of dispersion",
        )
        .within(Range::Integer { min: 1, max: 10_000_000 }),
        ParameterSpec::new(
            "copies",
            0_i64,
            "repetitions of the packing along the path of time of flight, 0 for as many as are needed",
        )
        .within(Range::Integer { min: 0, max: 256 }),
        ParameterSpec::new(
            "frequencies",
            Vec::<f64>::new(),
            "centre frequencies of time of flight, Hz; empty for those of waves about 20, 28 and 40 mean grain \
             diameters long",
        )
        .within(Range::Positive),
        ParameterSpec::new("cycles", flight.cycles, "periods of a burst of time of flight")
            .within(Range::Double { min: 1.0, max: 100.0 }),
        ParameterSpec::new(
            "amplitude",
            0.0,
            "peak strain of the waves of time of flight, 1; 0 for 1e-8",
        )
        .within(Range::Double { min: 0.0, max: 1e-2 }),
        ParameterSpec::new(
            "wave_friction",
            -1.0,
            "friction while waves pass (not for dispersion): -1 for that of the packing, whose contacts at the limit slide under any wave; inf \
             for no sliding",
        )
        .within(Range::Double { min: -1.0, max: f64::INFINITY }),
        ParameterSpec::new("sample_rate", 0.0, "sampling rate, Hz; 0 for forty samples per period")
            .within(Range::Double { min: 0.0, max: 1e12 }),
        ParameterSpec::new(
            "signal_to_noise",
            d.signal_to_noise,
            "signal to noise of one shot, dB; inf for no noise",
        )
        .within(Range::Double { min: -60.0, max: f64::INFINITY }),
        ParameterSpec::new(
            "jitter",
            d.jitter,
            "standard deviation of the trigger's time from shot to shot, s",
        )
        .within(Range::Double { min: 0.0, max: 1.0 }),
        ParameterSpec::new("shots", i64::from(d.shots), "shots that are averaged")
            .within(Range::Integer { min: 1, max: 1_000_000 }),
        ParameterSpec::new(
            "speed_noise",
            d.speed_noise,
            "additional relative standard deviation of every speed, 1: alignment, lengths",
        )
        .within(Range::Double { min: 0.0, max: 0.5 }),
        ParameterSpec::new("seed", d.seed as i64, "seed of all noise")
            .within(Range::Integer { min: 0, max: i64::MAX }),
    ]
}
