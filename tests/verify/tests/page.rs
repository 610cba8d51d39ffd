//! The page that compares grainlab with other programs: its commands print the lines that it shows.

use std::process::{Command, Stdio};

const PAGE: &str = include_str!("../../compare.md");

#[test]
fn the_comparisons_print_the_summaries_of_their_page() {
    let blocks = PAGE.split("```sh\ncargo run --release -p grainlab_verify -- ").skip(1);
    let mut checked = 0;
    for block in blocks {
        let (words, after) = block.split_once("\n```\n\n```text\n").unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_grainlab_verify"));
        let out = program.args(words.split(' ')).stdin(Stdio::null()).output().unwrap();
        let text = String::from_utf8_lossy(&out.stdout);
        assert_eq!(out.status.code(), Some(0), "{words}\n{text}{}", String::from_utf8_lossy(&out.stderr));
        let (lines, _) = after.split_once("\n```").unwrap();
        for line in lines.lines() {
            assert!(text.lines().any(|printed| printed == line), "{words}\n{line}\n{text}");
        }
        checked += 1;
    }
    assert_eq!(checked, 3);
}
