//! A run from beginning to end.

use grainlab_buskit::{Bench, Kind, Record, exit_of};
use grainlab_dem_simulator::{Finish, Settings, parameters};
use grainlab_msgs::msg::{Estimate, Microstructure, Packing, PackingReport, RunState, StrainRate, Stress};
use grainlab_msgs::{stamp, topics};
use grainlab_node_kit::{Exit, Names, Parameters, RosArgs};
use std::time::Duration;

fn pressure(PackingReport { stress, .. }: &PackingReport) -> f64 {
    (stress.xx + stress.yy + stress.zz) / 3.0
}

fn clean_run() -> Record {
    Bench::new(0).whole_run(&Settings::default(), None)
}

#[test]
fn every_packing_is_measured_and_inverted_with_its_stamp_and_step() {
    let record = clean_run();
    let packings: Vec<Packing> = record.messages(&topics::PACKING);
    let reports: Vec<PackingReport> = record.messages(&topics::PACKING_REPORT);
    let inferred: Vec<Microstructure> = record.messages(&topics::MICROSTRUCTURE);
    assert_eq!((packings.len(), reports.len(), inferred.len()), (3, 3, 3));
    for (packing, report) in packings.iter().zip(&reports) {
        assert_eq!(packing.header.stamp, stamp(packing.time));
        assert_eq!((&packing.header, packing.step), (&report.header, report.source_step));
    }
    // The first one has no contact network, hence no stiffness.
    assert_eq!(reports.iter().map(|r| r.stiffness.len()).collect::<Vec<_>>(), [0, 1, 1]);
    assert!(inferred[0].estimates.is_empty());
    for (packing, inferred) in packings.iter().zip(&inferred) {
        assert_eq!((&packing.header, packing.step), (&inferred.header, inferred.source_step));
        assert_eq!(inferred.source, "packing_report");
    }
    for (report, inferred) in reports.iter().zip(&inferred).skip(1) {
        let models: Vec<&str> = inferred.estimates.iter().map(|e| e.model.as_str()).collect();
        let asked = grainlab_emt_inversion::Settings::default().models;
        // The contacts are those of smooth spheres.
        let of_known = asked.iter().map(|m| m.name()).filter(|name| *name != "free-contact");
        assert_eq!(models, of_known.collect::<Vec<_>>());
        for e in inferred.estimates.iter().filter(|e| e.model.starts_with("ratio")) {
            assert!(matches!(e.status, Estimate::STATUS_OK | Estimate::STATUS_EXTRAPOLATED), "{e:?}");
            assert_eq!(
                (e.gamma_over_delta_source.as_str(), &e.gamma_over_delta),
                ("total", &report.strain_ratios.total)
            );
            assert!(e.credible_level > 0.0 && e.interval[0] < e.k[0] && e.k[0] < e.interval[1], "{e:?}");
        }
    }
    let pressure = pressure(&reports[2]);
    // The scene stops its servo at 2 percent of 100 kPa.
    assert!((pressure - 100e3).abs() < 2e3, "{pressure}");
}

#[test]
fn requests_count_from_zero_and_each_is_answered_once_where_nothing_gets_lost() {
    let record = clean_run();
    let requests: Vec<Stress> = record.messages(&topics::STRESS);
    let answers: Vec<StrainRate> = record.messages(&topics::STRAIN_RATE);
    assert_eq!(requests.len(), answers.len());
    for (n, (request, answer)) in requests.iter().zip(&answers).enumerate() {
        assert_eq!((request.sequence, answer.sequence), (n as u64, n as u64));
        assert_eq!(request.header, answer.header);
    }
}

#[test]
fn run_state_names_every_phase_and_the_step_of_the_last_packing() {
    let record = clean_run();
    let states: Vec<RunState> = record.messages(&topics::RUN_STATE);
    let mut phases: Vec<&str> = states.iter().map(|s| s.phase_name.as_str()).collect();
    phases.dedup();
    assert_eq!(phases, ["gas", "relax", "compress", "load"]);
    let (end, last): (&RunState, Packing) = (states.last().unwrap(), record.last(&topics::PACKING).unwrap());
    assert_eq!((end.state, end.progress, end.packings), (RunState::FINISHED, 1.0, 3));
    assert_eq!((end.step, end.last_packing_step), (last.step, last.step));
}

#[test]
fn the_samples_for_viewers_end_with_the_last_request_of_the_run() {
    let record = clean_run();
    let [all, sampled] = [topics::STRESS, topics::STRESS_SAMPLED].map(|t| record.bodies(&t).to_vec());
    assert!(!sampled.is_empty() && sampled.len() < all.len());
    assert_eq!(sampled.last(), all.last());
}

#[test]
fn two_runs_are_the_same_bytes() {
    let [first, second] = [clean_run(), clean_run()].map(|r| r.without_repeats());
    assert_eq!(first.difference(&second), None);
}

#[test]
fn loss_repetition_and_delay_change_no_byte() {
    let clean = clean_run().without_repeats();
    for seed in 1..=12 {
        let record = Bench::faulty(seed).whole_run(&Settings::default(), None);
        let repeats = record.bodies(&topics::STRESS).len() - clean.bodies(&topics::STRESS).len();
        assert!(repeats > 0, "seed {seed} put nothing to the test");
        assert_eq!(record.without_repeats().difference(&clean), None, "seed {seed}");
    }
}

/// The end of a simulator with an analyzer, and with an inversion or without one: its exit, the time from the end of the loading path
/// to its own, and the record.
fn end_of_simulator(settings: &Settings, with_inversion: bool) -> (Option<Exit>, Duration, Record) {
    let bench = Bench::new(0);
    let mut actors = vec![
        bench.simulator(settings, None),
        bench.node(Kind::Recorder),
        bench.node(Kind::Servo),
        bench.node(Kind::Analyzer),
    ];
    if with_inversion {
        actors.push(bench.node(Kind::Inversion));
    }
    let finished = || {
        let state = bench.record.borrow().last::<RunState>(&topics::RUN_STATE);
        state.is_some_and(|s| s.state == RunState::FINISHED)
    };
    bench.run(&mut actors, |actors| finished() || actors[0].ended.is_some());
    let done = bench.hub.now();
    bench.run(&mut actors, |actors| actors[0].ended.is_some());
    let (exit, took) = (exit_of(&actors[0]), bench.hub.now() - done);
    (exit, took, bench.record.take())
}

/// Exit and reason that the last state of the run has.
fn verdict(record: &Record) -> (Option<Exit>, String) {
    let last: RunState = record.last(&topics::RUN_STATE).unwrap();
    (last.exit(), last.message)
}

const INVERTED: Finish = Finish::Inverted;

#[test]
fn a_simulator_that_awaits_inversions_ends_when_its_last_packing_is_inverted() {
    let (exit, _, record) = end_of_simulator(&Settings { finish: INVERTED, ..Settings::default() }, true);
    assert_eq!((exit, verdict(&record)), (Some(Exit::Done), (Some(Exit::Done), String::new())));
    assert!(record.complete(), "it ended before the inversion");
}

#[test]
fn a_simulator_whose_last_packing_is_never_inverted_ends_with_an_error_after_the_time_limit() {
    let speeds = Settings { finish: INVERTED, awaited: vec![topics::WAVE_SPEEDS], ..Settings::default() };
    let alone = Settings { awaited: Vec::new(), ..speeds.clone() };
    for (settings, with_inversion, exit, limit, why) in [
        (&alone, false, Exit::Failure, 30, "the data on packing_report about the last packing (step "),
        (&speeds, true, Exit::DataLoss, 60, "the last packing (step "),
    ] {
        let (found, took, record) = end_of_simulator(settings, with_inversion);
        let (told, reason) = verdict(&record);
        assert_eq!((found, told), (Some(exit), Some(exit)));
        assert!(reason.starts_with(why), "{reason}");
        let limit = Duration::from_secs(limit);
        assert!(took + Duration::from_secs(1) >= limit && took <= limit + Duration::from_secs(3), "{took:?}");
    }
}

#[test]
fn a_simulator_that_awaits_no_inversion_ends_at_the_end_of_its_path() {
    let at_once = Settings { finish: Finish::AtOnce, ..Settings::default() };
    let (exit, took, record) = end_of_simulator(&at_once, false);
    assert_eq!((exit, verdict(&record).0), (Some(Exit::Done), None));
    assert!(took < Duration::from_secs(5), "{took:?}");
}

#[test]
fn the_earlier_names_of_the_parameters_mean_the_same() {
    let of = |given: &[&str]| {
        let words = ["--ros-args"].into_iter().chain(given.iter().flat_map(|value| ["-p", value]));
        let (ros, _) = RosArgs::parse(&words.map(str::to_owned).collect::<Vec<_>>()).unwrap();
        let names = Names::new("dem_simulator").unwrap();
        Settings::from(&Parameters::resolve(&parameters(), "dem_simulator", &names, &ros).unwrap())
    };
    for (earlier, now) in [
        (&["exit_when_finished:=true"][..], &["finish:=at_once"][..]),
        (&["exit_when_finished:=false"], &["finish:=never"]),
        (
            &["exit_when_finished:=true", "until_inverted:=[moduli]"],
            &["finish:=inverted", "awaited:=[moduli]"],
        ),
    ] {
        assert_eq!(of(earlier), of(now), "{earlier:?}");
    }
}
