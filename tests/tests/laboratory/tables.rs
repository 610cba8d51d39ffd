//! Tables of recordings beside rosbags, and definitions that a recording lacks.

use std::process::{Command, Stdio};
use system_tests::lab::{Lab, golden};
use system_tests::python;
use system_tests::terminal::Terminal;

const PAGE: &str = include_str!("../../../recordings/README.md");

#[test]
fn every_value_of_a_csv_table_is_that_of_rosbags_and_the_recipe_of_the_page_reads_it() {
    let Some(python) = python::with("rosbags, pandas, pyarrow") else { return };
    let lab = Lab::new();
    let ours = lab.launch(&golden("scenes/tiny.toml"), &[]);
    python::succeeds(&python, "make_bags.py", &[lab.folder().to_str().unwrap()]);
    let ours = ours.to_str().unwrap();
    for (path, folder) in [(ours, "tables"), ("rosbags", "others")] {
        lab.run(&["bag", "convert", path, "--format", "csv", "-o", folder]).assert_code(0);
        let [path, folder] = [path, folder].map(|p| lab.folder().join(p).to_str().unwrap().to_owned());
        python::succeeds(&python, "compare_csv.py", &[&path, &folder]);
    }
    lab.run(&["bag", "convert", ours, "--format", "json", "-o", "lines"]).assert_code(0);
    let recipe = PAGE.split("```python\n").nth(1).unwrap().split("```").next().unwrap();
    let out = python::code(&python, recipe, &[], lab.folder());
    assert!(out.contains("hertz-mindlin") && out.contains("pressure"), "{out}");
}

/// Writes a recording with topics whose definitions are not in it.
const WITHOUT_DEFINITION: &str = "from mcap.writer import Writer; f = open('old.mcap', 'wb'); w = Writer(f); w.start('ros2')
for topic, kind, data in [('/odd', 'demo_msgs/msg/Odd', b'\\0\\1\\0\\0\\7'),
        ('/text', 'std_msgs/msg/String', b'\\0\\1\\0\\0\\3\\0\\0\\0hi\\0'), ('text', 'std_msgs/msg/Empty', b'\\0\\1\\0\\0\\0')]:
    channel = w.register_channel(topic, 'cdr', w.register_schema(kind, '', b''))
    w.add_message(channel, 5, data, 5)
w.finish()";

#[test]
fn definitions_that_a_recording_lacks_come_from_a_folder_and_can_be_added_to_it() {
    let Some(python) = python::with("mcap, rosbags") else { return };
    let lab = Lab::new();
    python::code(&python, WITHOUT_DEFINITION, &[], lab.folder());
    let define = |folder: &str, text: &str| {
        std::fs::create_dir_all(lab.folder().join(folder).join("demo_msgs/msg")).unwrap();
        lab.write(&format!("{folder}/demo_msgs/msg/Odd.msg"), text);
    };
    define("types", "uint8 n\n");
    let bag = |words: &[&str], code| lab.run(&[&["bag"], words].concat()).assert_code(code);

    bag(&["cat", "old.mcap"], 3)
        .assert_prints(&["\"hi\""])
        .assert_says(&["demo_msgs/msg/Odd.msg with --msg-path"]);
    bag(&["cat", "old.mcap", "--msg-path", "types"], 0)
        .assert_prints(&["{\"n\":7}"])
        .assert_says(&["/odd: the recording has no definition"]);
    bag(&["info", "old.mcap", "--format", "csv"], 0).assert_prints(&["missing"]);
    let missing = "/odd: the recording has no definition of demo_msgs/msg/Odd";
    bag(&["check", "old.mcap"], 0).assert_prints(&[missing]);
    bag(&["convert", "old.mcap", "--format", "csv", "-o", "csv", "--msg-path", "types"], 0);

    // A topic that differs by the slash alone, of a type without fields, is another one.
    bag(&["convert", "old.mcap", "--format", "json", "-o", "t", "--msg-path", "types"], 0)
        .assert_prints(&["text.jsonl  /text  1 row", "text.2.jsonl  text  1 row"]);

    let with =
        |folder: &str, to: &str, code| bag(&["convert", "old.mcap", "--msg-path", folder, "-o", to], code);
    std::fs::create_dir_all(lab.folder().join("wrong/demo_msgs/msg")).unwrap();
    with("wrong", "part.mcap", 3).assert_says(&[missing]);
    bag(&["info", "part.mcap", "--format", "csv"], 0).assert_prints(&["missing"]);
    define("wrong", "float64 n\n");
    with("wrong", "wrong.mcap", 1).assert_says(&["nothing was written"]);
    assert!(!lab.folder().join("wrong.mcap").exists());
    with("types", "new.mcap", 0);
    bag(&["cat", "new.mcap"], 0).assert_prints(&["{\"n\":7}"]);
    let read = "from rosbags.highlevel import AnyReader; from pathlib import Path\n\
                with AnyReader([Path('new.mcap')]) as r: print([r.deserialize(d, c.msgtype) for c, _, d in r.messages()])";
    let out = python::code(&python, read, &[], lab.folder());
    assert!(out.contains("n=7") && out.contains("data='hi'"), "{out}");
}

#[test]
fn a_conversion_of_more_than_a_second_shows_its_progress_on_a_terminal_and_erases_it() {
    let Some(python) = python::with("mcap") else { return };
    let lab = Lab::new();
    let script = "import sys; from mcap.writer import Writer; w = Writer(open(sys.argv[1], 'wb')); w.start('ros2')\n\
                  schema = w.register_schema('p/msg/Many', 'ros2msg', b'float64[] x')\n\
                  channel = w.register_channel('/many', 'cdr', schema); body = b'\\0\\1\\0\\0\\x90\\x5f\\1\\0' + b'\\0' * 4 + b'\\0' * 8 * 90000\n\
                  for n in range(400): w.add_message(channel, n, body, n)\nw.finish()";
    python::code(&python, script, &["many.mcap"], lab.folder());
    // Stopped for a while: it takes more than a second however fast the host is.
    let stopped = "& p=$!; sleep 0.3; kill -STOP $p; sleep 1.2; kill -CONT $p; wait $p";
    let grainlab = system_tests::lab::grainlab();
    let line = format!("{} bag convert many.mcap --format csv -o out {stopped}", grainlab.display());
    let shown =
        Command::new("script").args(["-qec", &line, "/dev/null"]).current_dir(lab.folder()).output().unwrap();
    let text = String::from_utf8_lossy(&shown.stdout);
    let (drawn, end) = (text.find(" % of the recording, "), text.rfind("\r\u{1b}[2K"));
    assert!(shown.status.success() && drawn.is_some() && drawn < end, "{text:?}");
    assert!(text.contains("many.csv  /many  400 rows"), "{text:?}");
}

/// A table that a file gets is what its texts are; on a terminal they must not be obeyed.
#[test]
fn an_escape_sequence_in_a_table_is_shown_on_a_terminal_and_kept_in_a_file() {
    let lab = Lab::new();
    let file = lab.folder().join("t.csv");
    std::fs::write(&file, "sample,pressure_pa,g12_pa,g13_pa,theta_pa\na\x1b[31mb,5e4,1.04e8,1.12e8,1.36e8\n")
        .unwrap();
    let words = ["invert", "--table", &file.to_string_lossy(), "--model", "ratio", "--format", "csv"];
    let kept = lab.run(&words);
    assert!(kept.stdout.contains("a\x1b[31mb"), "{}\n{}", kept.stdout, kept.stderr);
    let (terminal, stdout) = Terminal::open(200);
    let mut command = lab.command(&words);
    assert!(command.stdout(stdout).stderr(Stdio::null()).status().unwrap().success());
    drop(command);
    let shown = terminal.shown().lines.join("\n");
    assert!(shown.contains(r"a\u{1b}[31mb") && !shown.contains('\x1b'), "{shown:?}");
}
