//! One state from flags.

use crate::invert::grainlab;
use serde_json::Value;

const S1: [&str; 6] = [
    "invert",
    "--g12=121708340.234",
    "--g13=127373906.955",
    "--theta=144375790.847",
    "--pressure=50e3",
    "--gamma-over-delta=-0.0623",
];

fn json(flags: &[&str]) -> Value {
    let output = grainlab(&[flags, &["--format=json"]].concat(), b"").assert_code(0);
    output.json()
}

#[test]
fn every_model_with_its_inputs_has_a_result_and_the_others_name_what_they_need() {
    let answer = json(&S1);
    let results = answer["results"].as_array().unwrap();
    let result = |model: &str| results.iter().find(|r| r["model"] == model).unwrap();
    assert!((result("ratio")["k"].as_f64().unwrap() - 5.73).abs() < 1e-6);
    assert_eq!(
        (&result("ratio")["calibration"], &result("ratio")["status"]),
        (&"paper".into(), &"ok".into())
    );
    let without_phi = result("emt");
    assert_eq!(without_phi["status"], "unknown");
    assert!(without_phi["warnings"][0].as_str().unwrap().contains("solid fraction"), "{without_phi}");
    let with_phi = json(&[&S1[..], &["--phi=0.636", "--model=emt"]].concat());
    assert!(with_phi["results"][0]["k"].as_f64().is_some(), "{with_phi}");
}

#[test]
fn several_calibrations_answer_one_after_the_other() {
    let answer = json(&[&S1[..], &["--model=ratio", "--calibration=grainlab,paper"]].concat());
    let names: Vec<_> =
        answer["results"].as_array().unwrap().iter().map(|r| r["calibration"].clone()).collect();
    assert_eq!(names, ["grainlab", "paper"]);
    assert_ne!(answer["results"][0]["k"], answer["results"][1]["k"]);
    let refused = grainlab(&[&S1[..], &["--calibration=nowhere.toml"]].concat(), b"");
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("nowhere.toml"));
}

#[test]
fn explained_shares_sum_to_the_variance() {
    let answer = json(&[&S1[..], &["--error=0.01", "--model=ratio", "--explain"]].concat());
    let explained = answer["explained"].as_array().unwrap();
    assert_eq!(explained.iter().map(|e| e["quantity"].clone()).collect::<Vec<_>>(), ["k", "k_hat", "eps"]);
    for e in explained {
        let shares: Vec<f64> =
            e["information"].as_object().unwrap().values().map(|s| s.as_f64().unwrap()).collect();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{e}");
        let [sigma, data, model] = ["sigma", "sigma_data", "sigma_model"].map(|key| e[key].as_f64().unwrap());
        assert!(model > 0.0 && (sigma - data.hypot(model)).abs() < 1e-9 * sigma, "{e}");
        assert!(e["condition_number"].as_f64().unwrap() > 1.0);
    }
    assert!(explained[0]["information"]["Theta"].as_f64().unwrap() > 0.9, "k follows Theta almost alone");
    assert!(explained[2]["information"]["Theta"].is_null(), "and eps does not hear of it");

    let people = grainlab(&[&S1[..], &["--error=0.01", "--explain"]].concat(), b"");
    let people = people.stdout;
    for word in ["from data", "from model", "condition", "G13", "98 %"] {
        assert!(people.contains(word), "{word:?} is missing:\n{people}");
    }
}

#[test]
fn the_error_of_the_model_is_separate_from_the_errors_of_the_data() {
    let flags = ["--error=0.01", "--phi=0.636", "--model=relaxed", "--explain"];
    let answer = json(&[&S1[..], &flags].concat());
    for e in answer["explained"].as_array().unwrap() {
        let [sigma, data, model] = ["sigma", "sigma_data", "sigma_model"].map(|k| e[k].as_f64().unwrap());
        assert!(data > 0.0 && model > 0.0, "{e}");
        assert!((sigma - data.hypot(model)).abs() < 1e-9 * sigma, "{e}");
    }
}

/// v = √(C/ρ) along and across the axis.
#[test]
fn wave_speeds_give_what_their_moduli_give() {
    const MODULI: [f64; 4] = [271.4e6, 285.6e6, 105.1e6, 108.9e6];
    const DENSITY: f64 = 1500.0;
    let state = ["invert", "--pressure=50e3", "--stress-ratio=0", "--size-spread=0", "--model=relaxed"];
    let flags = ["--c11", "--c33", "--g12", "--g13"].iter().zip(MODULI).map(|(f, m)| format!("{f}={m}"));
    let flags: Vec<String> = flags.chain(["--error=0.01".to_owned()]).collect();
    let by_moduli = json(&[&state[..], &flags.iter().map(String::as_str).collect::<Vec<_>>()].concat());
    let mut table = "angle_deg,mode,speed,speed_sigma\n".to_owned();
    for ((angle, mode), modulus) in [(90, "p"), (0, "p"), (90, "sh"), (0, "sv")].iter().zip(MODULI) {
        let speed = (modulus / DENSITY).sqrt();
        table += &format!("{angle},{mode},{speed},{}\n", 0.005 * speed);
    }
    let output = grainlab(
        &[&state[..], &["--speeds=-", "--contact=hertz", "--density=1500", "--format=json"]].concat(),
        table.as_bytes(),
    )
    .assert_code(0);
    assert!(output.stdout.contains("do not determine Theta, C13"), "{}", output.stdout);
    assert!(!output.stdout.contains("contact law is not known"), "{}", output.stdout);
    let by_speeds: Value = output.json();
    for key in ["k", "z", "eps", "eps_stiffness"] {
        let [moduli, speeds] = [&by_moduli, &by_speeds].map(|a| a["results"][0][key].as_f64().unwrap());
        assert!((moduli - speeds).abs() < 1e-9, "{key}: {moduli} {speeds}");
    }
    let refused = grainlab(
        &[&state[..], &["--speeds=-", "--contact=hertz", "--density=1500"]].concat(),
        b"angle_deg,mode,speed\n0,q,1\n",
    );
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("line 2: mode"), "{}", refused.stderr);
}

/// Four speeds with errors of half a percent; that across the axis is off by `slip`.
fn four_speeds(slip: f64) -> String {
    format!(
        "angle_deg,mode,speed,speed_sigma\n0,p,437.2,2\n90,p,425,2\n0,sv,269.1,1.3\n90,sv,{},1.3\n90,sh,264.9,1.3\n45,p,433,2\n",
        269.5 * (1.0 + slip)
    )
}

#[test]
fn speeds_that_contradict_each_other_end_with_4_and_say_so_in_every_form() {
    let flags = [
        "invert",
        "--pressure=50e3",
        "--stress-ratio=0",
        "--size-spread=0",
        "--speeds=-",
        "--contact=hertz",
        "--density=1500",
    ];
    let run = |slip: f64, more: &[&str]| {
        grainlab(&[&flags[..], &["--model=relaxed"], more].concat(), four_speeds(slip).as_bytes())
    };
    run(0.0, &["--format=json"]).assert_code(0);
    for format in ["--format=json", "--format=csv", "--format=table"] {
        let output = run(0.08, &[format]);
        assert_eq!(output.code, Some(4), "{format}");
        let out = output.stdout;
        assert!(
            out.contains("contradictory") && out.contains("the wave speeds contradict each other"),
            "{out}"
        );
        assert!(output.stderr.contains("contradict each other"), "{}", output.stderr);
    }
    assert!(
        run(0.08, &[]).stdout.contains("that of line 5") || run(0.08, &[]).stdout.contains("that of line 4")
    );
}

#[test]
fn the_density_and_the_solid_fraction_of_one_state_may_be_columns() {
    let flags =
        ["invert", "--pressure=50e3", "--stress-ratio=0", "--size-spread=0", "--speeds=-", "--contact=hertz"];
    let run = |more: &[&str], columns: [&str; 2]| {
        let table = four_speeds(0.0).replace("\n", &format!("{}\n", columns[1]));
        let table = table.replacen(columns[1], columns[0], 1);
        let output = grainlab(&[&flags[..], &["--format=csv"], more].concat(), table.as_bytes());
        (output.code, output.stdout, output.stderr)
    };
    let by_flags = run(&["--density=1500", "--phi=0.6"], ["", ""]);
    assert_eq!(by_flags.0, Some(0), "{}", by_flags.2);
    assert_eq!(run(&[], [",density,phi", ",1500,0.6"]), by_flags);
    assert_eq!(run(&[], [",grain_density,phi", ",2500,0.6"]), by_flags);
    for (more, columns, fault) in [
        (
            &[][..],
            ["", ""],
            "line 2: column density is empty: give it, or grain_density and phi, or --density",
        ),
        (&["--density=1500"], [",density", ",1500"], "--density is in a column of every row"),
        (&["--density=1500"], [",sample", ",a\n0,p,437.2,2,b"], "sample \"b\" after \"a\""),
        (&[], [",density", ",1500\n0,p,437.2,2,1600"], "density 1600 kg/m3, and 1500 in line 2"),
    ] {
        let (code, _, err) = run(more, columns);
        assert!(code == Some(2) && err.contains(fault), "{code:?} {err}");
    }
}

#[test]
fn a_structure_that_no_packing_has_is_unknown_and_ends_with_4() {
    for (pressure, scale) in [("1e-30", 1.0), ("50", 1.0), ("50e3", 1e-9), ("0.05", 1e-6)] {
        let moduli = [("g12", 100e6), ("g13", 100e6), ("theta", 136e6)];
        let moduli = moduli.map(|(name, value)| format!("--{name}={}", value * scale));
        let pressure = format!("--pressure={pressure}");
        let flags =
            ["invert", &moduli[0], &moduli[1], &moduli[2], &pressure, "--model=ratio", "--format=json"];
        let output = grainlab(&flags, b"");
        let answer: Value = output.json();
        let result = &answer["results"][0];
        assert_eq!((output.code, result["status"].as_str()), (Some(4), Some("unknown")), "{result}");
        assert!(result["k"].is_null(), "{result}");
        assert!(output.stderr.contains("check the units of moduli and pressure (Pa)"), "{result}");
    }
}

#[test]
fn an_unknown_answer_ends_with_4_and_an_invalid_input_with_2() {
    let moduli =
        ["invert", "--g12=104.2e6", "--g13=112.4e6", "--theta=136e6", "--pressure=50e3", "--model=relaxed"];
    // A coordination number that no packing has.
    let stiff =
        ["invert", "--g12=104.2e7", "--g13=112.4e7", "--theta=136e7", "--pressure=50e3", "--model=relaxed"];
    for (flags, more, code) in [
        (&moduli, &["--error=0.01"][..], 0),
        (&stiff, &["--error=0.01"], 4),
        (&moduli, &["--pressure-sigma=-1"], 2),
        (&moduli, &["--poisson-sigma=nan"], 2),
        (&moduli, &["--stress-ratio-sigma=0.1"], 2),
        (&moduli, &["--density-sigma=1"], 2),
    ] {
        let output = grainlab(&[&flags[..], more].concat(), b"");
        assert_eq!(output.code, Some(code), "{more:?}: {} {}", output.stdout, output.stderr);
    }
}

#[test]
fn a_stated_error_of_pressure_grains_or_stress_widens_the_answer() {
    let state = [
        "--error=0.01",
        "--stress-ratio=0",
        "--size-spread=0",
        "--model=relaxed",
        "--grain-shear-modulus=29e9",
        "--poisson=0.2",
        "--probe=sticking",
    ];
    let sigma = |more: &[&str], key: &str| {
        let answer = json(&[&S1[..], &state, more].concat());
        answer["results"][0]["sigma"][key].as_f64().unwrap()
    };
    for (flag, key) in [
        ("--pressure-sigma=5e3", "z"),
        ("--grain-shear-modulus-sigma=1.45e9", "z"),
        // It changes E* and k_t/k_n, whose effects on z cancel.
        ("--poisson-sigma=0.05", "k"),
        ("--stress-ratio-sigma=0.15", "eps"),
    ] {
        let (with, without) = (sigma(&[flag], key), sigma(&[], key));
        assert!(with > 1.001 * without, "{flag}: {with} {without}");
    }
}

#[test]
fn an_answer_without_one_of_the_unknowns_is_not_ok() {
    let flags = ["--error=1", "--stress-ratio=0", "--size-spread=0", "--model=relaxed", "--format=json"];
    let output = grainlab(&[&S1[..], &flags].concat(), b"");
    let answer: Value = output.json();
    let result = &answer["results"][0];
    assert!(result["eps"].is_null(), "{result}");
    assert_ne!(result["status"], "ok");
    let warnings = result["warnings"].as_array().unwrap();
    assert!(
        warnings.iter().any(|w| w.as_str().unwrap().contains("the data do not determine eps")),
        "{result}"
    );
}

#[test]
fn a_sample_of_few_grains_has_a_wider_answer() {
    let state =
        ["--error=0.003", "--stress-ratio=0", "--size-spread=0", "--model=relaxed", "--probe=sticking"];
    let sigma = |more: &[&str]| {
        json(&[&S1[..], &state, more].concat())["results"][0]["sigma"]["eps"].as_f64().unwrap()
    };
    let sizes = ["--grains=200", "--grains=2000", "--grains=20000"].map(|grains| sigma(&[grains]));
    assert!(sizes[0] > 1.3 * sizes[1] && sizes[1] > sizes[2], "{sizes:?}");
    assert!((sizes[1]..sizes[0]).contains(&sigma(&[])), "{sizes:?}");
}

#[test]
fn a_probe_that_is_not_stated_to_stick_widens_the_answer_and_is_noted() {
    let state = ["--error=0.01", "--stress-ratio=0", "--size-spread=0", "--grains=2000", "--model=relaxed"];
    let inferred = |more: &[&str]| json(&[&S1[..], &state, more].concat())["results"][0].clone();
    let [unstated, unknown, sticking] = [&[][..], &["--probe=unknown"], &["--probe=sticking"]].map(inferred);
    assert_eq!(unstated, unknown);
    assert_eq!((&unknown["z"], &unknown["status"]), (&sticking["z"], &sticking["status"]));
    let sigma = |result: &Value| result["sigma"]["z"].as_f64().unwrap();
    assert!((sigma(&unknown) - sigma(&sticking).hypot(0.19)).abs() < 1e-9);
    let noted = |result: &Value| result["warnings"].to_string().contains("contacts may have slid");
    assert!(noted(&unknown) && !noted(&sticking), "{unknown} {sticking}");
    let refused = grainlab(&[&S1[..], &["--probe=stuck"]].concat(), b"");
    assert!(
        refused.code == Some(2) && refused.stderr.contains("give sticking if no contact slid"),
        "{refused:?}"
    );
}
