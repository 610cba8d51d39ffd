//! Estimates against the truth of a table.

use crate::invert::grainlab;
use serde_json::Value;

/// S1 at 50 kPa of the paper's Table III (k = 5.73, eps = 0.016), with these coordination numbers and
/// anisotropies as the truth.
fn said(truths: &[(f64, f64)]) -> String {
    let mut input = String::from("mu,p_kpa,gamma_over_delta,g_total,g12_pa,g13_pa,theta_pa,k,eps\n");
    for (i, (k, eps)) in truths.iter().enumerate() {
        let mu = if i % 2 == 0 { "0.1" } else { "0.3" };
        input += &format!("{mu},50,-0.0623,0.01,121708340.234,127373906.955,144375790.847,{k},{eps}\n");
    }
    input
}

fn judge(input: &str, flags: &[&str]) -> Value {
    let flags = [&["invert", "--table=-", "--judge", "--format=json"], flags].concat();
    let output = grainlab(&flags, input.as_bytes()).assert_code(0);
    output.json()
}

fn of<'a>(judged: &'a Value, quantity: &str) -> &'a Value {
    judged.as_array().unwrap().iter().find(|j| j["quantity"] == quantity).unwrap()
}

fn near(value: &Value, expected: f64) {
    let found = value.as_f64().unwrap();
    assert!((found - expected).abs() < 1e-8, "{found} {expected}");
}

#[test]
fn bias_and_scatter_are_those_of_the_estimates_less_the_truth() {
    let judged = judge(&said(&[(5.63, 0.016), (5.73, 0.016), (5.83, 0.04)]), &["--model=ratio"]);
    let k = of(&judged, "k");
    assert_eq!((k["rows"].as_u64(), k["solved"].as_u64(), &k["truth"]), (Some(3), Some(3), &"k".into()));
    near(&k["bias"], 0.0);
    near(&k["scatter"], 0.1);
    near(&k["rms"], 0.1 * (2.0f64 / 3.0).sqrt());
    near(&k["mean_absolute"], 0.2 / 3.0);
    near(&of(&judged, "eps")["bias"], -0.008);
    let k_hat = of(&judged, "k_hat");
    assert_eq!(k_hat["truth"], "k", "k_hat stands for the coordination of the calibration");
    near(&k_hat["bias"], -0.1);
    assert_eq!((&k["intervals"], &k["covered"]), (&3.into(), &1.0.into()), "the error of the model alone");
}

#[test]
fn intervals_that_have_the_truth_in_them_are_counted() {
    let input = said(&[(5.73, 0.016), (5.75, 0.02), (2.0, 0.016), (9.5, 0.9)]);
    let judged = judge(&input, &["--model=ratio", "--error=0.01"]);
    assert_eq!(of(&judged, "k")["intervals"], 4);
    near(&of(&judged, "k")["covered"], 0.5);
    near(&of(&judged, "eps")["covered"], 0.75);
}

#[test]
fn a_plot_without_a_counted_eps_is_refused_and_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("plot.svg");
    let input = b"p_kpa,g12_pa,g13_pa,theta_pa,k\n50,1.2e8,1.27e8,1.44e8,5.7\n";
    let arguments = ["invert", "--table=-", "--judge", "--model=ratio", "--plot", plot.to_str().unwrap()];
    let output = grainlab(&arguments, input);
    let err = output.stderr;
    assert!(output.code == Some(2) && err.contains("plot.svg is not written"), "{err}");
    assert!(!plot.exists() && output.stdout.contains("ratio"));
}

#[test]
fn a_plot_leaves_out_models_that_infer_no_eps() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("plot.svg");
    let input = said(&[(5.73, 0.016), (5.73, 0.02)]).replace("mu,", "phi,").replace("0.3,50", "0.64,50");
    let input = input.replace("\n0.1,50", "\n0.63,50");
    let models = "--model=ratio,hertz-mindlin";
    let arguments = ["invert", "--table=-", "--judge", models, "--plot", plot.to_str().unwrap()];
    let output = grainlab(&arguments, input.as_bytes()).assert_code(0);
    assert!(output.stdout.contains("hertz-mindlin"), "{}", output.stdout);
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(svg.contains("ratio: rms") && !svg.contains("hertz-mindlin") && !svg.contains("NaN"), "{svg}");
}

#[test]
fn groups_come_in_the_order_of_their_first_row_and_are_judged_alone() {
    let judged =
        judge(&said(&[(5.73, 0.0), (5.63, 0.0), (5.73, 0.0), (5.63, 0.0)]), &["--model=ratio", "--by=mu"]);
    let of_k: Vec<_> = judged.as_array().unwrap().iter().filter(|j| j["quantity"] == "k").collect();
    assert_eq!(of_k.iter().map(|j| j["group"][0].clone()).collect::<Vec<_>>(), ["0.1", "0.3"]);
    near(&of_k[0]["rms"], 0.0);
    near(&of_k[1]["rms"], 0.1);
}

#[test]
fn every_strain_ratio_is_judged_and_one_that_is_not_there_solves_nothing() {
    let judged = judge(&said(&[(5.73, 0.016)]), &["--model=ratio", "--gamma=all"]);
    let eps: Vec<_> = judged.as_array().unwrap().iter().filter(|j| j["quantity"] == "eps").collect();
    let solved: Vec<_> = eps
        .iter()
        .map(|j| (j["gamma_over_delta_source"].as_str().unwrap(), j["solved"].as_u64().unwrap()))
        .collect();
    assert_eq!(solved, [("total", 1), ("elastic", 0), ("contact", 0), ("zero", 1)]);
    assert_ne!(eps[0]["bias"], eps[3]["bias"]);
}

#[test]
fn invalid_rows_are_named_and_not_judged() {
    let input = said(&[(5.73, 0.016)]) + "0.1,50,none,,1,1,1,5,0\n";
    let output = grainlab(&["invert", "--table=-", "--judge", "--model=ratio"], input.as_bytes());
    let (out, err) = (output.stdout, output.stderr);
    assert_eq!(output.code, Some(2));
    assert!(err.contains("line 3: column gamma_over_delta: \"none\" is not a number"), "{err}");
    assert!(out.lines().nth(1).unwrap().contains("  1       1  "), "{out}");
    let no_truth = grainlab(&["invert", "--table=-", "--judge"], b"p_kpa,g12_pa\n50,1e8\n");
    assert!(no_truth.stderr.contains("no column to judge by"), "{}", no_truth.stderr);
}

#[test]
fn a_table_without_any_estimate_ends_with_the_reason() {
    let pascals = said(&[(5.73, 0.016), (5.73, 0.02)]);
    let output = grainlab(
        &["invert", "--table=-", "--judge", "--model=relaxed"],
        pascals.replace(",50,", ",50000000,").as_bytes(),
    );
    let err = output.stderr;
    assert!(output.code == Some(4) && err.contains("2 rows without an estimate"), "{err}");
}
