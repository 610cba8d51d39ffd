//! Valid and invalid tables; results are in order.

use crate::invert::{RATIO, grainlab, number, table};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

#[test]
fn a_bad_row_is_named_and_does_not_stop_the_rest() {
    let good = "121708340.234,127373906.955,144375790.847,50,-0.0623";
    let input = format!(
        "# a comment\nsample,g12_pa,g13_pa,theta_pa,p_kpa,gamma_over_delta\nfirst,{good}\nshort,1e8,2e8\n\nwords,{}\n\
         stiff,1e8,3e8,1e8,50,0\ncompressed,{}\nlast,{good}\n",
        good.replace("144375790.847", "stiff"),
        good.replace(",50,", ",-50,"),
    );
    let (code, rows, err) = table(&input, &RATIO);
    let status: Vec<_> = rows.iter().map(|r| (r["line"].as_str().unwrap(), r["status"].clone())).collect();
    assert_eq!(
        status,
        [
            ("3", "ok".into()),
            ("4", "unknown".into()),
            ("6", "unknown".into()),
            ("7", "unknown".into()),
            ("8", "unknown".into()),
            ("9", "ok".into())
        ]
    );
    assert_eq!(rows[5]["sample"], "last");
    assert!((number(&rows[5], "k") - 5.73).abs() < 1e-6);
    assert!(rows[2]["reason"].as_str().unwrap().contains("column theta_pa"), "{}", rows[2]);
    assert_eq!(code, 2, "numbers that are no moduli are worse than moduli that no packing has");
    for word in [
        "line 4: 3 cells under 6 columns",
        "line 6 (words): column theta_pa: \"stiff\" is not a number",
        "line 7 (stiff): ratio: G13/G12 = 3.0000 is outside (0, 2)",
        "line 8 (compressed): ratio: pressure = -5e4 Pa must be positive",
        "6 rows, 4 bad",
    ] {
        assert!(err.contains(word), "{word:?} is missing:\n{err}");
    }
}

#[test]
fn the_exit_code_is_that_of_the_worst_row() {
    let header = "g12_pa,g13_pa,theta_pa,p_kpa\n";
    let (good, stiff, none) = ("1e8,1e8,1.3e8,50\n", "1e8,3e8,1e8,50\n", "1e8,1e8,1.3e8,\n");
    for (rows, code) in [
        (good.to_owned(), 0),
        (good.to_owned() + stiff + good, 4),
        (good.to_owned() + none + stiff, 2),
        (String::new(), 2),
    ] {
        assert_eq!(table(&(header.to_owned() + &rows), &RATIO).0, code, "{rows}");
    }
}

#[test]
fn results_come_in_the_order_of_the_rows_however_many() {
    let mut input = String::from("sample,g12_pa,g13_pa,theta_pa,p_kpa\n");
    let rows = 20_000;
    for i in 0..rows {
        // Every tenth row takes longer, or less long.
        let g13 = if i % 10 == 0 { "3e8" } else { "1e8" };
        input += &format!("{i},1e8,{g13},{},50\n", 1.3e8 + f64::from(i));
    }
    let (code, found, _) = table(&input, &RATIO);
    assert_eq!((code, found.len()), (4, rows as usize));
    for (i, row) in found.iter().enumerate() {
        assert_eq!(row["sample"], i.to_string());
        assert_eq!(row["line"], (i + 2).to_string());
        assert_eq!(row["status"] == "unknown", i % 10 == 0, "{row}");
    }
    let output =
        grainlab(&["invert", "--table", "-", "--format", "json", "--model", "ratio"], input.as_bytes());
    let all: Value = output.json();
    for (i, one) in all.as_array().unwrap().iter().enumerate() {
        assert_eq!(one["inputs"]["sample"], i.to_string());
        let k = one["results"][0]["k"].as_f64();
        assert_eq!(k, found[i]["k"].as_str().unwrap().parse().ok(), "JSON and CSV agree");
    }
}

#[test]
fn what_is_missing_leaves_undetermined_what_needs_it_and_no_more() {
    let input = "g12_pa,g13_pa,theta_pa,c33_pa,pressure_pa\n1e8,1.1e8,,,5e4\n1e8,1.1e8,1.3e8,,5e4\n1e8,,1.3e8,2e8,5e4\n";
    let (code, rows, err) = table(input, &RATIO);
    assert_eq!((rows[0]["status"].as_str(), rows[0]["k"].as_str()), (Some("extrapolated"), Some("")));
    assert!(rows[0]["reason"].as_str().unwrap().contains("do not determine k"), "{}", rows[0]);
    assert_eq!(rows[0]["eps"], rows[1]["eps"]);
    assert!(number(&rows[1], "k") > 4.0);
    assert_eq!((rows[2]["status"].as_str(), rows[2]["eps"].as_str()), (Some("unknown"), Some("")));
    assert!(rows[2]["reason"].as_str().unwrap().contains("needs G13"), "{}", rows[2]);
    assert!(err.contains("line 4: ratio: needs G13"), "{err}");
    assert_eq!(code, 2, "nothing at all can be said of the last row");

    let arguments =
        ["invert", "--g12=1e8", "--g13=1.1e8", "--pressure=5e4", "--format=json", "--model=ratio"];
    let output = grainlab(&arguments, b"");
    assert_eq!(output.code, Some(0));
    let answer: Value = output.json();
    let result = &answer["results"][0];
    assert_eq!(result["eps"].to_string(), rows[0]["eps"].as_str().unwrap());
    assert!(result["k"].is_null() && answer["inputs"]["theta_pa"].is_null());
    let said = result["warnings"].to_string();
    assert!(said.contains("do not determine k, k_hat"), "{said}");
}

#[test]
fn errors_of_single_moduli_go_before_the_one_for_all() {
    let input =
        "g12_pa,g13_pa,theta_pa,p_kpa,theta_sigma_pa\n1e8,1.05e8,1.3e8,50,1.3e7\n1e8,1.05e8,1.3e8,50,\n";
    let (_, rows, _) = table(input, &[&RATIO[..], &["--error", "0.01"]].concat());
    assert_eq!(rows[0]["sigma_eps"], rows[1]["sigma_eps"], "the bulk modulus has no say in it");
    let of_data = |row: &Value| number(row, "sigma_k").powi(2) - number(row, "sigma_model_k").powi(2);
    assert!(of_data(&rows[0]) > 25.0 * of_data(&rows[1]));
}

#[test]
fn the_strain_ratio_is_the_one_asked_for() {
    let input = "g12_pa,g13_pa,theta_pa,p_kpa,gamma_over_delta,g_total,g_elastic,g_contact\n\
                 1e8,1.05e8,1.3e8,50,-0.05,-0.06,,0.02\n";
    let eps = |flags: &[&str]| -> Vec<f64> {
        let (_, rows, _) = table(input, &[&RATIO[..], flags].concat());
        rows.iter().map(|r| r["eps"].as_str().unwrap().parse().unwrap_or(f64::NAN)).collect()
    };
    let alone = |g: &str| {
        let flag = format!("--gamma-over-delta={g}");
        let flags =
            ["invert", "--g12=1e8", "--g13=1.05e8", "--theta=1.3e8", "--pressure=50e3", "--format=json"];
        let output = grainlab(&[&flags[..], &RATIO, &[&flag]].concat(), b"");
        output.json()["results"][0]["eps"].as_f64().unwrap()
    };
    assert_eq!(eps(&[]), [alone("-0.05")]);
    assert_eq!(eps(&["--gamma", "total"]), [alone("-0.06")]);
    assert_eq!(eps(&["--gamma", "contact"]), [alone("0.02")]);
    assert!(eps(&["--gamma", "elastic"])[0].is_nan(), "what is not there is not replaced");
    let all = eps(&["--gamma", "all"]);
    assert_eq!((all[0], all[2], all[3]), (alone("-0.06"), alone("0.02"), alone("0")));
    assert!(all[1].is_nan());
}

#[test]
fn the_csv_of_analyze_is_a_table_of_states() {
    let packing = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/reference/ref_packing_500.csv.gz");
    let analyzed = grainlab(&["analyze", packing, "--format", "csv"], b"").assert_code(0);
    let (code, rows, err) = table(&analyzed.stdout, &RATIO);
    assert_eq!((code, rows.len()), (0, 1), "{err}");
    assert!(rows[0]["sample"].as_str().unwrap().contains("ref_packing_500"), "{}", rows[0]);

    let measured = grainlab(&["analyze", packing, "--format", "json"], b"");
    let measured: Value = measured.json();
    let state = &measured[0];
    let flag = |name: &str, key: &Value| format!("--{name}={}", key.as_f64().unwrap());
    let flags = [
        flag("g12", &state["g12_pa"]),
        flag("g13", &state["g13_pa"]),
        flag("theta", &state["theta_pa"]),
        flag("pressure", &state["pressure_pa"]),
        flag("gamma-over-delta", &state["g_contact"]),
    ];
    let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
    let alone = grainlab(&[&["invert", "--format=json"], &RATIO[..], &flags].concat(), b"");
    let alone: Value = alone.json();
    for key in ["k", "k_hat", "eps"] {
        let (of_table, of_flags) = (number(&rows[0], key), alone["results"][0][key].as_f64().unwrap());
        assert!((of_table - of_flags).abs() < 1e-12, "{key}: {of_table} {of_flags}");
    }
}

#[test]
fn an_invalid_table_is_refused_with_what_is_missing() {
    for (input, word) in [
        ("", "empty"),
        ("# only a comment\n", "empty"),
        ("g12_pa,g13_pa\n1,2\n", "no column of the pressure"),
        ("p_kpa,k\n1,2\n", "no column of a modulus"),
        ("p_kpa,g12_pa,g12_pa\n1,2,3\n", "g12_pa is there twice"),
        ("p_kpa,g12_pa\n", "no state below the header"),
    ] {
        let (code, _, err) = table(input, &[]);
        assert_eq!(code, 2, "{input:?}: {err}");
        assert!(err.contains("standard input") && err.contains(word), "{word:?} is missing: {err}");
    }
}

#[test]
fn thousands_of_states_are_not_printed_as_a_text_table() {
    let input = "g12_pa,g13_pa,theta_pa,p_kpa\n".to_owned() + &"1e8,1e8,1.3e8,50\n".repeat(1001);
    let output = grainlab(&["invert", "--table", "-"], input.as_bytes());
    assert_eq!(output.code, Some(2));
    assert!(output.stdout.is_empty() && output.stderr.contains("--format csv"));
}

#[test]
fn a_row_is_answered_before_the_next_one_is_there() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(["invert", "--table=-", "--format=csv", "--model=ratio"]);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let (mut stdin, stdout) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
    let (sender, lines) = mpsc::channel();
    std::thread::spawn(move || {
        BufReader::new(stdout).lines().try_for_each(|line| sender.send(line.unwrap()))
    });
    let next =
        || lines.recv_timeout(Duration::from_secs(60)).expect("an answer while the input is still open");
    stdin.write_all(b"sample,g12_pa,g13_pa,theta_pa,p_kpa\n").unwrap();
    for name in ["first", "second", "third"] {
        stdin.write_all(format!("{name},1e8,1.05e8,1.3e8,50\n").as_bytes()).unwrap();
        if name == "first" {
            assert!(next().starts_with("sample,"));
        }
        assert!(next().starts_with(name));
    }
    drop(stdin);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn the_reason_of_a_status_and_what_was_assumed_are_in_every_row() {
    let input = "sample,g12_pa,g13_pa,theta_pa,p_kpa\nbare,104.2e6,112.4e6,136e6,50\nstiff,104.2e7,112.4e7,136e7,50\n";
    let (code, rows, _) = table(input, &["--model=relaxed", "--error=0.01"]);
    assert_eq!(code, 4);
    assert!(rows[0]["reason"].as_str().unwrap().contains("axial stress ratio"), "{}", rows[0]);
    for row in rows.iter().filter(|row| row["status"] != "ok") {
        assert!(!row["reason"].as_str().unwrap().is_empty(), "{row}");
    }
}

#[test]
fn a_slip_in_a_header_is_refused_with_the_column_that_is_probably_meant() {
    for (column, meant) in
        [("g12_sigma", "g12_sigma_pa"), ("G13_PA", "g13_pa"), ("q_over_p", "axial_q_over_p")]
    {
        let (code, rows, err) = table(&format!("g12_pa,theta_pa,p_kpa,{column}\n1e8,1.3e8,50,1\n"), &RATIO);
        assert_eq!((code, rows.len()), (2, 0));
        assert!(
            err.contains(&format!("column {column} ")) && err.contains(&format!("almost {meant}: rename")),
            "{err}"
        );
    }
    let (code, _, err) = table("g12_pa,g13_pa,theta_pa,p_kpa,c66_pa\n1e8,1e8,1.3e8,50,8e7\n", &RATIO);
    assert!(code == 2 && err.contains("columns g12_pa and c66_pa both contain g12_pa"), "{err}");
    let (code, rows, err) =
        table("name,g12_pa,g13_pa,theta_pa,p_kpa,_q_over_p\nx,1e8,1e8,1.3e8,50,1\n", &RATIO);
    assert_eq!((code, rows.len()), (0, 1), "{err}");
}

#[test]
fn settings_and_tables_that_may_be_endless_or_are_too_large_are_refused_before_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let large = folder.path().join("large.toml");
    std::fs::write(&large, "#".repeat(2 << 20)).unwrap();
    let large = large.to_string_lossy();
    let speeds = folder.path().join("speeds.csv");
    std::fs::write(&speeds, "pressure_pa,mode,speed,density\n1e5,p,425,1640\n").unwrap();
    let speeds = speeds.to_string_lossy();
    // Without content, and with more zeros than the maximum of a table.
    let endless = folder.path().join("endless.csv");
    std::fs::File::create(&endless).unwrap().set_len((1 << 28) + 1).unwrap();
    let endless = endless.to_string_lossy();
    let grains = ["--grain-shear-modulus=44e9", "--poisson=0.08"];
    for (flags, cause) in [
        (&["--plan", "/dev/null"][..], "it is a device"),
        (&["--plan", &large], "more than 1048576 bytes"),
        (&["--speeds", "/dev/null", grains[0], grains[1]], "it is a device"),
        (&["--speeds", &endless, grains[0], grains[1]], "more than 268435456 bytes"),
        (&["--speeds", &speeds, grains[0], grains[1], "--prior", "/dev/null"], "it is a device"),
        (&["--speeds", &speeds, grains[0], grains[1], "--prior", &large], "more than 1048576 bytes"),
    ] {
        let output = grainlab(&[&["invert"], flags].concat(), b"");
        let said = output.stderr;
        assert!(output.code != Some(0) && said.contains(cause), "{flags:?}: {said}");
    }
}
