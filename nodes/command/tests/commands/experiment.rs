//! Pages of commands: they print the lines that the pages show.

use crate::grainlab_in;
use std::path::Path;

/// The page for experimentalists, and the comparison with other programs.
const PAGES: [&str; 2] =
    [include_str!("../../../experiment.md"), include_str!("../../../../tests/compare.md")];

/// The command of each block of a page that is followed by lines of its output, and these lines.
fn blocks(page: &'static str) -> Vec<(&'static str, Vec<&'static str>)> {
    let of = |block: &'static str| {
        let (command, after) = block.split_once("\n```\n")?;
        let (_, lines) = after.strip_prefix("\n```text")?.split_once('\n')?;
        Some((command.trim(), lines.split_once("\n```")?.0.lines().collect()))
    };
    let blocks = page.split("```sh\n").skip(1).filter_map(of);
    // Commands of other programs are checked in their own tests.
    blocks.filter(|(command, _)| command.starts_with("grainlab ")).collect()
}

/// Runs the commands of a page in a folder.
fn check(page: &'static str, folder: &Path, number: usize) {
    let blocks = blocks(page);
    assert_eq!(blocks.len(), number);
    for (command, lines) in blocks {
        let mut words = command.split_whitespace();
        assert_eq!(words.next(), Some("grainlab"));
        let text = grainlab_in(folder, &words.collect::<Vec<_>>()).assert_code(0).stdout;
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        for line in lines {
            assert!(text.lines().any(|printed| words(printed) == words(line)), "{command}\n{line}\n{text}");
        }
    }
}

#[test]
fn the_commands_for_experimentalists_print_the_numbers_of_their_page() {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/beads");
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(golden).unwrap().map(Result::unwrap) {
        std::fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    check(PAGES[0], folder.path(), 3);
    assert_eq!(std::fs::read_dir(folder.path().join("picked")).unwrap().count(), 8);
}

#[test]
fn the_commands_beside_other_programs_print_the_numbers_of_their_page() {
    check(PAGES[1], &Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."), 3);
}
