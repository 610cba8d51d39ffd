//! The independent tools, if they are installed.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A Python with `module` of a ROS 2 installation, which no registry of Python packages has. Without one the test is skipped
/// with a message, also if `GRAINLAB_PYTHON` names a Python.
pub fn with_ros(module: &str) -> Option<PathBuf> {
    let python = std::env::var_os("GRAINLAB_PYTHON").map_or_else(|| "python3".into(), PathBuf::from);
    let found = imports(&python, module);
    if !found {
        say_skipped(&format!("Python has no {module}, which comes with ROS 2"));
    }
    found.then_some(python)
}

fn imports(python: &Path, module: &str) -> bool {
    let imports = Command::new(python).args(["-c", &format!("import {module}")]).output();
    imports.is_ok_and(|o| o.status.success())
}

/// A Python with `module`. Without one the test is skipped with a message; if `GRAINLAB_PYTHON` names a
/// Python (as in the checks of the project), the module must exist.
pub fn with(module: &str) -> Option<PathBuf> {
    let named = std::env::var_os("GRAINLAB_PYTHON").map(PathBuf::from);
    let python = named.clone().unwrap_or_else(|| "python3".into());
    if imports(&python, module) {
        return Some(python);
    }
    assert!(
        named.is_none(),
        "{} cannot import {module}: install tests/tools/requirements.txt",
        python.display()
    );
    say_skipped(&format!("Python has no {module}: see tests/tools/requirements.txt"));
    None
}

/// Prints that a test is skipped. The test harness captures `eprintln!`, but not the stream itself.
pub fn say_skipped(reason: &str) {
    let _ = writeln!(std::io::stderr(), "SKIPPED: {reason}");
}

/// Runs a script of `tests/tools`, which has to succeed; what it prints.
#[track_caller]
pub fn succeeds(python: &Path, script: &str, arguments: &[&str]) -> String {
    printed(tool(python, script, arguments))
}

/// Runs Python code in a folder, which has to succeed; what it prints.
#[track_caller]
pub fn code(python: &Path, code: &str, arguments: &[&str], folder: &Path) -> String {
    printed(Command::new(python).args(["-c", code]).args(arguments).current_dir(folder).output().unwrap())
}

#[track_caller]
fn printed(output: Output) -> String {
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{out}{err}");
    out
}

/// Runs a script of `tests/tools`.
pub fn tool(python: &Path, script: &str, arguments: &[&str]) -> Output {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools").join(script);
    let output = Command::new(python).arg(&script).args(arguments).output();
    output.unwrap_or_else(|e| panic!("{}: {e}", script.display()))
}
