//! The page for experimentalists: its commands print the lines that it shows.

use std::path::Path;
use std::process::{Command, Stdio};

const PAGE: &str = include_str!("../../experiment.md");

/// The command of each block of the page that is followed by lines of its output, and these lines.
fn blocks() -> Vec<(&'static str, Vec<&'static str>)> {
    let of = |block: &'static str| {
        let (command, after) = block.split_once("\n```\n")?;
        let (_, lines) = after.strip_prefix("\n```text")?.split_once('\n')?;
        Some((command.trim(), lines.split_once("\n```")?.0.lines().collect()))
    };
    PAGE.split("```sh\n").skip(1).filter_map(of).collect()
}

#[test]
fn the_commands_of_the_page_print_its_numbers() {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/beads");
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(golden).unwrap().map(Result::unwrap) {
        std::fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    let blocks = blocks();
    assert_eq!(blocks.len(), 3, "plan, pick and infer");
    for (command, lines) in blocks {
        let mut words = command.split_whitespace();
        assert_eq!(words.next(), Some("grainlab"));
        let mut grainlab = Command::new(env!("CARGO_BIN_EXE_grainlab"));
        let out = grainlab.args(words).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap();
        let text = String::from_utf8_lossy(&out.stdout);
        assert_eq!(out.status.code(), Some(0), "{command}\n{text}{}", String::from_utf8_lossy(&out.stderr));
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        for line in lines {
            assert!(text.lines().any(|printed| words(printed) == words(line)), "{command}\n{line}\n{text}");
        }
    }
    assert_eq!(std::fs::read_dir(folder.path().join("picked")).unwrap().count(), 8);
}
