//! Recordings that are made here, message by message.

use super::*;
use crate::measured_packing::tests::{lattice, measured};
use grainlab_core::Packing;
use grainlab_core::contact::RollingResistance;
use grainlab_core::notes::{Code, texts};
use grainlab_core::results::InferredQuantity;
use grainlab_emt_inversion::{
    Answer, Settings, microstructure_of_moduli, microstructure_of_report, microstructure_of_speeds,
};
use grainlab_msgs::boundary::{packing_header, packing_message, packing_report_message};
use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::{Exit, Guid, msg, to_cdr};
use grainlab_recordings::{Incoming, RunWriter, TopicSpec, WriterOptions};
use std::path::{Path, PathBuf};

const TOPICS: [(&Topic, &str); 5] = [
    (&topics::PACKING, "/packing"),
    (&topics::PACKING_REPORT, "/packing_report"),
    (&topics::MODULI, "/moduli"),
    (&topics::WAVE_SPEEDS, "/wave_speeds"),
    (&topics::MICROSTRUCTURE, "/microstructure"),
];

/// A recording in a directory that is removed with it.
struct Made {
    directory: tempfile::TempDir,
    writer: Option<RunWriter>,
    sent: u64,
}

impl Made {
    fn new() -> Self {
        Self::with(&TOPICS)
    }

    fn with(topics: &[(&Topic, &str)]) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let specs: Vec<_> = topics.iter().map(|(topic, name)| TopicSpec::of_contract(topic, name)).collect();
        let writer = RunWriter::create(&directory.path().join("r"), "r", &specs, WriterOptions::default());
        Self { directory, writer: Some(writer.unwrap()), sent: 0 }
    }

    fn write(&mut self, topic: &str, payload: &[u8]) {
        self.sent += 1;
        let (guid, sequence, receive_time) = (Guid([1; 16]), self.sent as i64, self.sent);
        let sample = Incoming { guid, sequence, source_time: None, receive_time, payload };
        self.writer.as_mut().unwrap().write(topic, &sample).unwrap();
    }

    /// The packing, and what analyzer and inversion send about it.
    fn state(&mut self, packing: &Packing) {
        self.write("/packing", &to_cdr(&packing_message(packing, "made", Vec::new())));
        let report = report(packing);
        self.write("/packing_report", &to_cdr(&report));
        self.answer(microstructure_of_report(&report, &Settings::default()));
    }

    fn answer(&mut self, answer: Answer) {
        self.write("/microstructure", &to_cdr(&answer.message));
    }

    fn moduli(&mut self, moduli: &msg::Moduli) {
        self.write("/moduli", &to_cdr(moduli));
        self.answer(microstructure_of_moduli(moduli, &Settings::default()));
    }

    fn speeds(&mut self, speeds: &msg::WaveSpeeds, answered: bool) {
        self.write("/wave_speeds", &to_cdr(speeds));
        if answered {
            self.answer(microstructure_of_speeds(speeds, &Settings::default()));
        }
    }

    fn path(&self) -> PathBuf {
        self.directory.path().join("r")
    }

    fn read(&mut self) -> ReadBack {
        self.writer.take().unwrap().finish().unwrap();
        read(&Recording::open(&self.path()).unwrap())
    }
}

fn report(packing: &Packing) -> msg::PackingReport {
    packing_report_message(packing_header(packing), &measured(packing).report).unwrap()
}

/// The lattice at another step and time, with its grain elsewhere.
fn later(step: u64, x: f64) -> Packing {
    let mut packing = Packing { step, time: 1e-6 * step as f64, ..lattice(true) };
    packing.positions[0].x = x;
    packing
}

/// Speeds along the third axis, of a shot of this packing.
fn shot(packing: &Packing, name: &str, speed: f64) -> msg::WaveSpeeds {
    let along = |x: f64, speed: f64| msg::WaveSpeed {
        direction: Vector3 { x: 0.0, y: 0.0, z: 1.0 },
        polarization: Vector3 { x, y: 0.0, z: 1.0 - x },
        speed,
        speed_stddev: 0.01 * speed,
        method: msg::WaveSpeed::METHOD_FIRST_ARRIVAL,
        ..msg::WaveSpeed::default()
    };
    msg::WaveSpeeds {
        header: packing_header(packing),
        name: name.to_owned(),
        source_step: packing.step,
        density: 1500.0,
        pressure: 5e4,
        solid_fraction: 0.6,
        grain_shear_modulus: packing.material.shear_modulus,
        grain_poisson_ratio: packing.material.poisson_ratio,
        speeds: vec![along(0.0, 1.6 * speed), along(1.0, speed)],
        ..msg::WaveSpeeds::default()
    }
}

#[test]
fn a_run_is_read_back_and_one_measurement_has_no_label() {
    let mut made = Made::new();
    made.state(&later(7, 0.0));
    made.speeds(&shot(&later(7, 0.0), "bench", 300.0), true);
    made.state(&later(9, 1e-6));
    let back = made.read();
    assert_eq!((back.states.len(), back.complaints.len(), back.refused), (2, 0, 0), "{:?}", back.complaints);
    let state = &back.states[0];
    assert!(state.acoustic.is_some() && state.further_acoustic.is_empty());
    assert!(state.results.iter().all(|r| r.origin.measurement.is_none()));
    let json = serde_json::to_value(state).unwrap();
    assert!(json.get("further_acoustic").is_none() && json["acoustic"].get("measurement").is_none());
}

/// The report of a packing does not have its geometry.
#[test]
fn doubts_about_the_geometry_of_a_recorded_packing_are_read_back_with_it() {
    let (mut deep, overlap) = (lattice(true), 0.12 * 2e-4);
    deep.cell = grainlab_core::Cell::cube(2e-4 - overlap).unwrap();
    let normal_force = deep.material.normal_force(0.5e-4, overlap);
    deep.contacts.iter_mut().for_each(|c| (c.overlap, c.normal_force) = (overlap, normal_force));
    let mut made = Made::new();
    made.state(&deep);
    let back = made.read();
    let found = &back.states[0].packing;
    assert!(found.report.elasticity.as_ref().is_err_and(|none| none.is_fault()), "{:?}", back.complaints);
    let warnings = texts(&found.notes).join("; ");
    assert!(warnings.contains("3 of 3 contacts overlap by more than 10 %"), "{warnings}");
}

#[test]
fn results_of_two_runs_are_never_joined_by_their_step() {
    for (other, sign) in [
        (later(7, 2e-6), "two different packings of step 7"),
        (later(8, 2e-6), "step 8 comes after one of step 9"),
    ] {
        let mut made = Made::new();
        [later(7, 0.0), later(9, 1e-6), other].iter().for_each(|packing| made.state(packing));
        let back = made.read();
        assert!(back.several_runs.as_ref().unwrap().to_string().contains(sign), "{back:?}");
        assert!(back.states.is_empty() && back.complaints[0].contains("holds several runs"), "{back:?}");
    }
    // The report of another run, whose packings are not there.
    let mut made = Made::new();
    made.state(&later(7, 0.0));
    let foreign = Packing { time: 0.5, ..later(7, 0.0) };
    made.write("/packing_report", &to_cdr(&report(&foreign)));
    let several = made.read().several_runs.unwrap().to_string();
    assert!(several.contains("the packing_report of step 7 is not that of the packing"), "{several}");
}

#[test]
fn every_shot_of_a_packing_keeps_its_own_speeds_and_estimates() {
    let packing = later(7, 0.0);
    let mut made = Made::new();
    made.state(&packing);
    for n in 0..3 {
        made.speeds(&shot(&packing, &format!("shot {n}"), 300.0 + 20.0 * f64::from(n)), true);
    }
    let back = made.read();
    let state = &back.states[0];
    assert!(back.complaints.is_empty(), "{:?}", back.complaints);
    assert_eq!(state.acoustics().count(), 3);
    let groups = crate::by_origin(&state.results);
    let data: Vec<String> = groups.iter().filter_map(|(origin, _)| origin.data()).collect();
    assert_eq!(data, ["moduli", "wave_speeds, shot 0", "wave_speeds, shot 1", "wave_speeds, shot 2"]);
    for (n, (origin, results)) in groups.iter().skip(1).enumerate() {
        let sent = shot(&packing, &format!("shot {n}"), 300.0 + 20.0 * n as f64);
        let own = state.acoustic_of(origin.measurement.as_ref()).unwrap();
        assert_eq!(own.reading.speeds[1].wave.speed, sent.speeds[1].speed, "{origin:?}");
        let answer = microstructure_of_speeds(&sent, &Settings::default()).message;
        let expected: Vec<Option<f64>> = answer.estimates.iter().map(|e| e.k.first().copied()).collect();
        assert_eq!(
            results.iter().map(|r| r.values[InferredQuantity::K]).collect::<Vec<_>>(),
            expected,
            "{origin:?}"
        );
    }
    let json = serde_json::to_value(state).unwrap();
    assert_eq!(json["acoustic"]["measurement"], "shot 0");
    assert_eq!(json["further_acoustic"][1]["measurement"], "shot 2");
    let labelled: Vec<_> =
        json["results"].as_array().unwrap().iter().filter(|r| r["measurement"] == "shot 1").collect();
    assert_eq!(labelled.len(), groups[2].1.len());
}

#[test]
fn shots_that_nothing_tells_apart_are_not_paired_with_estimates() {
    let packing = later(7, 0.0);
    let mut made = Made::new();
    made.state(&packing);
    [300.0, 320.0].iter().for_each(|speed| made.speeds(&shot(&packing, "", *speed), true));
    let back = made.read();
    let state = &back.states[0];
    for (origin, _) in crate::by_origin(&state.results).iter().skip(1) {
        assert!(state.acoustic_of(origin.measurement.as_ref()).is_none(), "{origin:?}");
    }
    assert!(
        texts(&state.packing.notes).iter().any(|w| w.contains("is not known")),
        "{:?}",
        state.packing.notes
    );
}

#[test]
fn data_without_an_answer_are_counted() {
    let packing = later(7, 0.0);
    let mut made = Made::new();
    made.state(&packing);
    for n in 0..5 {
        made.speeds(&shot(&packing, &format!("shot {n}"), 300.0 + f64::from(n)), n < 3);
    }
    let back = made.read();
    assert_eq!(back.not_inverted, 2);
    assert_eq!(
        back.complaints,
        ["2 of 5 wave_speeds of step 7 have no estimate of their own in the recording"]
    );
}

#[test]
fn estimates_are_listed_by_their_data_whichever_were_inverted_first() {
    let packing = later(7, 0.0);
    let made = |speeds_first: bool| {
        let mut made = Made::new();
        made.write("/packing", &to_cdr(&packing_message(&packing, "made", Vec::new())));
        let (report, speeds) = (report(&packing), shot(&packing, "bench", 300.0));
        made.write("/packing_report", &to_cdr(&report));
        made.write("/wave_speeds", &to_cdr(&speeds));
        let mut answers = [
            microstructure_of_report(&report, &Settings::default()),
            microstructure_of_speeds(&speeds, &Settings::default()),
        ];
        if speeds_first {
            answers.reverse();
        }
        answers.into_iter().for_each(|answer| made.answer(answer));
        made.read().states.remove(0).results
    };
    let results = made(false);
    assert_eq!(results.first().unwrap().origin.source.as_deref(), Some("packing_report"));
    assert_eq!(results.last().unwrap().origin.source.as_deref(), Some("wave_speeds"));
    assert_eq!(made(true), results);
}

#[test]
fn refused_data_are_in_the_recording_and_the_reason_is_said() {
    let packing = later(7, 0.0);
    let mut made = Made::new();
    made.state(&packing);
    made.speeds(&shot(&packing, "bench", f64::NAN), true);
    let back = made.read();
    assert_eq!((back.refused, back.not_inverted), (1, 0));
    assert!(back.results[topics::WAVE_SPEEDS.name].contains(&7), "it is in the recording");
    assert!(
        back.complaints.len() == 1 && back.complaints[0].contains("NaN is refused"),
        "{:?}",
        back.complaints
    );
}

#[test]
fn a_report_is_read_back_as_it_was_recorded() {
    let rolling = RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 };
    let mut packing = later(7, 0.0);
    packing.law = packing.law.with_rolling(rolling);
    let mut made = Made::new();
    made.state(&packing);
    made.state(&Packing { contacts: Vec::new(), ..later(9, 1e-6) });
    let states = made.read().states;
    assert_eq!(states[0].packing.report, measured(&packing).report);
    assert!(states[0].packing.notes.iter().any(|note| note.is(Code::WithoutRolling)));
    // The reason is that of the analyzer.
    assert!(states[1].packing.notes[0] == Note::no_contacts(1.0));
    assert!(states[1].results.is_empty());
    let summary = crate::Summary { states, ..crate::Summary::of_nothing(Exit::Done) };
    let table = crate::brief::text(&summary, Path::new("r"), &["recording"], "grainlab");
    assert!(table.contains("no contacts that resist a strain"), "{table}");
}

#[test]
fn the_moduli_of_another_program_do_not_replace_those_of_the_network() {
    let packing = later(7, 0.0);
    let bench = msg::Moduli {
        header: packing_header(&packing),
        name: "bench".into(),
        source_step: 7,
        g12: vec![6e7],
        pressure: 5e4,
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        grain_density: 2500.0,
        ..msg::Moduli::default()
    };
    let mut made = Made::new();
    made.moduli(&bench);
    made.state(&packing);
    let back = made.read();
    assert!(back.complaints.is_empty(), "{:?}", back.complaints);
    let state = &back.states[0];
    assert!(state.packing.report.stiffness().is_some());
    let data: Vec<_> = crate::by_origin(&state.results).iter().filter_map(|(o, _)| o.data()).collect();
    assert_eq!(data, ["moduli", "moduli of an instrument"]);
}

#[test]
fn a_recording_of_an_earlier_version_says_how_its_packings_are_measured_again() {
    let old = Topic { name: "fabric", info: TypeInfo::of::<msg::Fabric>(), ..topics::PACKING_REPORT };
    let mut made = Made::with(&[(&topics::PACKING, "/packing"), (&old, "/fabric")]);
    made.write("/packing", &to_cdr(&packing_message(&later(7, 0.0), "made", Vec::new())));
    let back = made.read();
    assert_eq!((back.states.len(), back.not_analysed, back.complaints.len()), (0, 1, 1));
    assert!(back.complaints[0].contains("grainlab analyze"), "{:?}", back.complaints);
}

#[test]
fn what_an_instrument_measured_elsewhere_is_no_result_of_the_packing_that_a_run_starts_from() {
    let first = later(0, 0.0);
    let mut made = Made::new();
    made.state(&first);
    let elsewhere = msg::WaveSpeeds {
        header: grainlab_msgs::std_msgs::Header {
            stamp: Time { sec: 77, nanosec: 5 },
            frame_id: String::new(),
        },
        ..shot(&first, "glass beads", 300.0)
    };
    made.speeds(&elsewhere, true);
    let back = made.read();
    let state = &back.states[0];
    assert!(
        state.acoustic.is_none()
            && state.results.iter().all(|r| r.origin.source.as_deref() == Some("packing_report"))
    );
    assert!(!back.of_instruments.is_empty());
    assert!(back.of_instruments.iter().all(|r| r.origin.data().unwrap() == "wave_speeds, glass beads"));
}

#[test]
fn the_table_of_a_launch_has_a_row_for_every_shot_and_counts_those_that_it_leaves_out() {
    let shown = |shots: u32| {
        let packing = later(7, 0.0);
        let mut made = Made::new();
        made.state(&later(5, 1e-6));
        made.state(&packing);
        for n in 0..shots {
            made.speeds(&shot(&packing, &format!("shot {n}"), 300.0 + f64::from(n)), true);
        }
        let summary = crate::Summary { states: made.read().states, ..crate::Summary::of_nothing(Exit::Done) };
        crate::brief::text(&summary, Path::new("r"), &["recording"], "grainlab")
    };
    let few = shown(4);
    // The lattice has no estimate from its moduli: that of the first shot stands in the row of the packing.
    assert!(few.contains("step 7: inferred from wave_speeds, shot 0\n"), "{few}");
    assert!((1..4).all(|n| few.contains(&format!("\nwave_speeds, shot {n} "))), "{few}");
    let many = shown(200);
    assert!(many.contains("step 7: and 190 estimates more: summary.json has all"), "{many}");
}

#[test]
fn two_nodes_that_report_a_packing_differently_are_named_and_the_first_is_shown() {
    let mut made = Made::new();
    let (packing, mut authors) = (lattice(true), Authors::default());
    made.write("/packing", &to_cdr(&packing_message(&packing, "made", Vec::new())));
    let own = report(&packing);
    for (who, report) in [(1, own.clone()), (2, msg::PackingReport { size_spread: 0.5, ..own.clone() })] {
        made.write("/packing_report", &to_cdr(&report));
        authors.enter("/packing_report", made.sent, Guid([who; 16]));
        let ledger = made.writer.as_mut().unwrap().ledger_mut();
        ledger.report("/packing_report", Guid([who; 16]), 0);
        ledger.name(Guid([who; 16]), &format!("/node{who}"));
    }
    let text = serde_json::to_string(&authors).unwrap();
    made.writer.as_mut().unwrap().set_metadata(strangers::AUTHORS, &text);
    let back = made.read();
    let named = |c: &String| c.starts_with("/node1 and /node2 sent different reports");
    assert!(back.disputed && back.complaints.iter().any(named), "{:?}", back.complaints);
    assert_eq!(back.states[0].packing.report.size_spread.to_bits(), own.size_spread.to_bits());
}
