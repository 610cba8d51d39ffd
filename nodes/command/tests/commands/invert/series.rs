//! Wave speeds of a sample over pressure.

use crate::invert::grainlab;
use serde_json::Value;

const QUARTZ: [&str; 5] =
    ["invert", "--speeds=-", "--grain-shear-modulus=44e9", "--poisson=0.08", "--density=1640"];

/// P and S of a sand; `slip` is the error of the last S.
fn sand(slip: f64) -> String {
    format!(
        "pressure_pa,mode,speed,speed_sigma\n1e5,p,425,4.3\n1e5,s,252,2.5\n4e5,p,600,6\n4e5,s,358,3.6\n1.6e6,p,848,8.5\n1.6e6,s,{},5.1\n4e6,p,,\n",
        507.0 * (1.0 + slip)
    )
}

fn run(flags: &[&str], input: &str) -> (Option<i32>, String, String) {
    let output = grainlab(&[&QUARTZ[..], flags].concat(), input.as_bytes());
    (output.code, output.stdout, output.stderr)
}

#[test]
fn an_answer_says_its_contact_what_is_not_determined_and_what_is_predicted() {
    let (code, out, err) = run(&[], &sand(0.0));
    assert_eq!(code, Some(0), "{err}");
    for part in [
        "contact: free (laboratory)",
        "probability of each contact law",
        "validated on simulated spheres",
        "eps is not determined",
        "predicted\n",
    ] {
        assert!(out.contains(part), "{part:?} is missing:\n{out}");
    }
    let (_, json, _) = run(&["--format=json"], &sand(0.0));
    let all: Value = serde_json::from_str(&json).unwrap();
    let estimate = &all[0]["estimate"];
    let z = |k: usize| estimate["pressures"][k]["z"]["mean"].as_f64().unwrap();
    assert!((0..4).all(|k| (4.05..=6.6).contains(&z(k))), "{json}");
    let predicted = estimate["rows"][6]["predicted"].as_f64().unwrap();
    assert!((980.0..1130.0).contains(&predicted), "{predicted}");
    let (_, csv, _) = run(&["--format=csv"], &sand(0.0));
    assert_eq!(csv.lines().count(), 5);
}

#[test]
fn samples_of_one_file_are_inferred_apart_and_a_contradiction_ends_with_4() {
    let bad = sand(0.25);
    let (code, out, err) = run(&[], &bad);
    assert_eq!(code, Some(4), "{out}");
    assert!(err.contains("contradictory") && err.contains("line 7"), "{err}");
    let good = sand(0.0);
    let named = |text: &str, name: &str| -> String {
        text.lines().skip(1).map(|l| format!("{name},{l}\n")).collect()
    };
    let header = "sample,pressure_pa,mode,speed,speed_sigma\n";
    let both = format!("{header}{}{}", named(&good, "one"), named(&bad, "two"));
    let (code, out, _) = run(&["--format=csv"], &both);
    assert_eq!(
        (code, out.matches("\none,").count(), out.matches("\ntwo,").count()),
        (Some(4), 4, 4),
        "{out}"
    );
}

#[test]
fn wrong_units_and_missing_inputs_are_named_with_their_line() {
    for (from, to, fault) in [
        ("1e5,p,425", "100,p,425", "line 2: column pressure_pa: 100 Pa is"),
        ("600,6", "9600,6", "line 4: column speed: 9600 m/s is not between"),
        ("1e5,p,425,4.3", "1e5,sh,425,4.3", "line 2: mode \"sh\" without a direction"),
        ("1e5,p,425", "1e5,p,225", "line 3: this S wave is too fast"),
    ] {
        let (code, _, err) = run(&[], &sand(0.0).replace(from, to));
        assert!(code == Some(2) && err.contains(fault), "{code:?} {err}");
    }
    let without = |flag: &str| {
        let flags: Vec<&str> = QUARTZ.into_iter().filter(|f| !f.starts_with(flag)).collect();
        grainlab(&flags, sand(0.0).as_bytes()).stderr
    };
    assert!(without("--density").contains("column density is empty"));
    assert!(without("--poisson").contains("the material of the grains is needed"));
    let soft = ["invert", "--speeds=-", "--grain-shear-modulus=44", "--poisson=0.08", "--density=1640"];
    let err = grainlab(&soft, sand(0.0).as_bytes()).stderr;
    assert!(err.contains("--grain-shear-modulus 44 must be from 1e5 to 1e12"), "{err}");
    let light = "pressure_pa,mode,speed,grain_density,phi\n1e5,p,425,2.65,0.62\n1e5,s,252,,\n";
    let (code, _, err) = run(&[], light);
    assert!(code == Some(2) && err.contains("column grain_density: 2.65"), "{err}");
    let level = |flags: &[&str]| -> f64 {
        let (_, json, err) = run(&[flags, &["--format=json"]].concat(), &sand(0.0));
        let all: Value = serde_json::from_str(&json).unwrap_or_else(|_| panic!("{err}"));
        all[0]["estimate"]["level"]["prior_stddev"].as_f64().unwrap()
    };
    assert!(
        level(&["--density-sigma=800"]) > 1.2 * level(&[]),
        "an error of the density is part of the scale"
    );
    let (code, _, err) = run(&["--explain"], &sand(0.0));
    assert!(code == Some(2) && err.contains("--contact hertz"), "{err}");
}

#[test]
fn loading_and_unloading_in_one_sample_are_doubted_and_rows_that_are_there_twice_refused() {
    let doubt = "speeds at 100 kPa were measured twice, with other pressures between";
    let words = |out: String| out.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, out, _) = run(&[], &(sand(0.0) + "1e5,p,440,4\n"));
    assert!(words(out).contains(doubt));
    let (_, out, _) = run(&[], &sand(0.0));
    assert!(!words(out).contains("measured twice"));
    let (code, _, err) = run(&[], &(sand(0.0) + "1e5,p,425,4.3\n"));
    assert!(code == Some(2) && err.contains("duplicate rows: lines 2 and 9"), "{err}");
}

#[test]
fn semicolons_and_decimal_commas_give_the_answer_of_commas() {
    let german = sand(0.0).replace(',', ";").replace('.', ",");
    let both = [sand(0.0), german].map(|table| run(&["--format=csv"], &table));
    assert_eq!(both[0].1, both[1].1);
    assert_eq!(both[1].0, Some(0), "{}", both[1].2);
}

#[test]
fn speeds_that_no_posterior_represents_give_a_reason_and_no_numbers() {
    let rows: String =
        (0..8).map(|k| format!("{}e3,{},{}\n", 200 + 20 * k, ["p", "sv"][k % 2], 50 << (k / 2))).collect();
    let table = format!("pressure_pa,mode,speed,direction\n{}", rows.replace('\n', ",along\n"));
    let (code, out, err) = run(&[], &table);
    assert_eq!((code, out.as_str()), (Some(4), ""), "{err}");
    assert!(err.contains("the sampling failed; do not use these numbers"), "{err}");
}

#[test]
fn eps_that_speeds_do_not_determine_is_named_with_the_waves_that_are_one_modulus() {
    let table = "pressure_pa,mode,direction,speed\n5e4,p,along,322\n5e4,sv,along,190\n5e4,sv,across,200\n4e5,p,along,524\n4e5,sv,along,320\n4e5,sv,across,333\n";
    let (_, out, _) = run(&[], table);
    let out = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        out.contains("eps is not determined")
            && out.contains("are one modulus, and their speeds differ by 4."),
        "{out}"
    );
    let (_, out, _) = run(
        &[],
        &table
            .replace("sv,across", "sh,across")
            .replace(",speed", ",speed,speed_sigma")
            .replace("\n", ",60\n")
            .replace("speed_sigma,60", "speed_sigma"),
    );
    let out = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(out.contains("eps from 50 to 400 kPa"), "{out}");
}

#[test]
fn the_prior_is_a_file_that_can_be_changed_and_smooth_spheres_have_another_answer() {
    let printed = grainlab(&["invert", "--print-prior", "--contact=free"], b"").stdout;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("prior.toml");
    let z = |flags: &[&str]| -> f64 {
        let (code, json, err) = run(&[flags, &["--format=json"]].concat(), &sand(0.0));
        assert_eq!(code, Some(0), "{err}");
        serde_json::from_str::<Value>(&json).unwrap()[0]["estimate"]["pressures"][0]["z"]["mean"]
            .as_f64()
            .unwrap()
    };
    std::fs::write(&file, &printed).unwrap();
    let prior = format!("--prior={}", file.display());
    assert_eq!(z(&[&prior]), z(&[]));
    std::fs::write(&file, printed.replace("lowest_stiffness_ratio = 0.3", "lowest_stiffness_ratio = 0.8"))
        .unwrap();
    assert!((z(&[&prior]) - z(&[])).abs() > 0.1);
    std::fs::write(&file, printed.replace("weight = 1.0", "weight = -1.0")).unwrap();
    let (code, _, err) = run(&[&prior], &sand(0.0));
    assert!(code == Some(2) && err.contains("weight = -1 must be positive"), "{err}");
    let (_, out, _) = run(&["--contact=hertz"], &sand(0.0));
    assert!(out.starts_with("contact: hertz (ideal)"), "{out}");
}

/// The exit code, the statuses of the pressures, and the first reason.
fn answered(flags: &[&str], table: &str) -> (Option<i32>, Vec<String>, String) {
    let output = grainlab(&[&["invert", "--speeds=-", "--format=csv"], flags].concat(), table.as_bytes());
    let out = output.stdout;
    let mut reader = csv::Reader::from_reader(out.as_bytes());
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let at = rows[0].len() - 2;
    let statuses = rows.iter().map(|row| row[at].to_owned()).collect();
    (output.code, statuses, rows[0][at + 1].to_owned())
}

const GLASS: [&str; 2] = ["--grain-shear-modulus=29e9", "--poisson=0.2"];

#[test]
fn pressures_beyond_the_calibration_are_extrapolated_and_those_within_are_ok() {
    let s_alone = |unit: &str| format!("{unit},mode,speed,speed_sigma\n100000,s,255,3\n400000,s,330,3\n");
    let (code, statuses, _) = answered(&QUARTZ[2..], &s_alone("pressure_pa"));
    assert_eq!((code, statuses), (Some(0), vec!["ok".to_owned(); 2]));
    let (_, statuses, reason) = answered(&QUARTZ[2..], &s_alone("p_kpa"));
    assert!(statuses.iter().all(|status| status != "ok"), "{statuses:?}");
    assert!(
        reason.contains("extrapolated at 100000, 400000 kPa: p/E* = 2.09e-3 is outside 2.32e-8 to 2.06e-4"),
        "{reason}"
    );
    assert!(reason.contains("of the posterior has z below 4.11"), "{reason}");
    let high = sand(0.0) + "20e6,p,1400,14\n20e6,s,860,9\n";
    let (code, statuses, _) = answered(&QUARTZ[2..], &high);
    assert_eq!((code, statuses.join(" ").as_str()), (Some(0), "ok ok ok ok extrapolated"));
}

#[test]
fn a_row_that_decides_z_against_the_others_ends_with_4_and_z_without_it_is_printed() {
    let series = |first: f64| {
        let p = [
            (3e4, 324.35 * first),
            (1.2e5, 434.78),
            (2.6e5, 520.56),
            (4.5e5, 589.42),
            (9e5, 674.07),
            (1.35e6, 729.21),
        ];
        let p_later = [(2.2e6, 818.14), (3.4e6, 900.99), (4.5e6, 960.33)];
        let s =
            [(7e4, 237.27), (2.5e5, 311.62), (4e5, 344.96), (8e5, 395.22), (1.3e6, 439.51), (1.8e6, 473.83)];
        let s_later = [(3.3e6, 543.05), (4.4e6, 588.13), (5.5e6, 593.93)];
        let of = |mode: &'static str| {
            move |(pressure, speed): (f64, f64)| {
                format!("{pressure},1540,46,{mode},{speed},{}\n", 0.02 * speed)
            }
        };
        let rows = p.into_iter().chain(p_later).map(of("p")).chain(s.into_iter().chain(s_later).map(of("s")));
        "pressure_pa,density,density_sigma,mode,speed,speed_sigma\n".to_owned() + &rows.collect::<String>()
    };
    let (code, statuses, _) = answered(&GLASS, &series(1.0));
    assert_eq!((code, statuses[0].as_str()), (Some(0), "ok"));
    let (code, statuses, reason) = answered(&GLASS, &series(1.1));
    assert_eq!((code, statuses[0].as_str()), (Some(4), "contradictory"), "{reason}");
    assert!(reason.contains("without line 2 (p at 30 kPa), z is 5.5"), "{reason}");
}

#[test]
fn waves_along_and_across_that_are_one_modulus_and_differ_end_with_4() {
    let table = |sv_across: f64| {
        format!(
            "direction,mode,speed,speed_sigma,pressure_pa,density\nalong,p,420,4,2e5,1600\nacross,p,415,4,2e5,1600\nalong,sv,240,2.4,2e5,1600\nacross,sv,{sv_across},2.5,2e5,1600\nacross,sh,256,2.5,2e5,1600\n"
        )
    };
    let (code, statuses, reason) = answered(&GLASS, &table(252.0));
    assert_eq!((code, statuses[0].as_str()), (Some(4), "contradictory"), "{reason}");
    assert!(
        reason.contains("are one modulus, and their speeds differ by more than their errors (p 0.0005)"),
        "{reason}"
    );
    let (code, statuses, reason) = answered(&GLASS, &table(244.0));
    assert_eq!((code, statuses[0].as_str()), (Some(0), "ok"), "{reason}");
}
