//! `grainlab invert` from the command line.

mod judged;
mod posterior;
mod series;
mod single;
mod tables;

use serde_json::Value;
use std::io::Write;
use std::process::{Command, Stdio};
use system_tests::process::Ended;

/// Runs the command with this standard input.
fn grainlab(arguments: &[&str], input: &[u8]) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let bytes = input.to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&bytes));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// The output of `--table -`: exit code, rows of the CSV by column name, stderr.
fn table(input: &str, flags: &[&str]) -> (i32, Vec<Value>, String) {
    let flags = [&["invert", "--table", "-", "--format", "csv"], flags].concat();
    let output = grainlab(&flags, input.as_bytes());
    let out = output.stdout;
    let mut lines = out.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap_or_default();
    let object = |cells: Vec<&str>| -> Value {
        header.iter().zip(cells).map(|(name, cell)| (name.to_string(), Value::from(cell))).collect()
    };
    (output.code.unwrap(), lines.map(object).collect(), output.stderr)
}

fn number(row: &Value, column: &str) -> f64 {
    row[column].as_str().unwrap_or_else(|| panic!("no {column}")).parse().unwrap()
}

const RATIO: [&str; 2] = ["--model", "ratio"];
