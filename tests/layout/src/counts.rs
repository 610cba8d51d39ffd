//! Amount of source: lines of code, which are neither blank nor comment, of every language alike.

use crate::modules::modules;
use crate::workspace::roots;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::{Item, UseTree, Visibility};

/// Most lines of code of the laboratory, of the studio with the command, and of all tests. They fall with what is deleted, and
/// rise only by what a feature states.
const LABORATORY: usize = 55_800;
const STUDIO_AND_COMMAND: usize = 30_975;
const TESTS: usize = 49_400;

/// First words that leave open what is described.
const OPENINGS: [&str; 9] = ["What", "How", "Where", "Which", "Whether", "Its", "Their", "Of", "The same"];

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Every file under `folder` that is written by hand.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir()
            && !["vendor", "generated", "target", "golden", "runs", "campaigns"].contains(&name.as_str())
        {
            files(&path, found);
        } else if !name.ends_with(".min.js")
            && path
                .extension()
                .is_some_and(|e| ["rs", "py", "html", "js", "css"].iter().any(|known| e == *known))
        {
            found.push(path);
        }
    }
}

/// Lines of `text` that are neither blank nor comment, in the language with this extension.
fn code(text: &str, extension: &str) -> usize {
    let (line, block): (&[&str], &[(&str, &str)]) = match extension {
        "py" => (&["#"], &[("\"\"\"", "\"\"\"")]),
        "html" => (&[], &[("<!--", "-->")]),
        "css" => (&[], &[("/*", "*/")]),
        _ => (&["//"], &[("/*", "*/")]),
    };
    let mut end: Option<&str> = None;
    let is_code = |raw: &&str| {
        let text = raw.trim();
        if let Some(closing) = end {
            end = if text.contains(closing) { None } else { end };
            return false;
        }
        if let Some((opening, closing)) = block.iter().find(|(opening, _)| text.starts_with(opening)) {
            end = if text[opening.len()..].contains(closing) { None } else { Some(closing) };
            return false;
        }
        !text.is_empty() && !line.iter().any(|mark| text.starts_with(mark))
    };
    text.lines().filter(is_code).count()
}

/// A Rust file without the inline modules and functions of its tests.
fn without_tests(text: &str) -> String {
    let mut kept = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            kept += line;
            kept.push('\n');
            continue;
        }
        // The item ends with its first line, or with a brace that is indented as it is.
        let end = line.replace("#[cfg(test)]", "}");
        let mut item = lines.by_ref().skip_while(|l| l.trim_start().starts_with("#["));
        if !item.next().is_none_or(|first| first.ends_with(';')) {
            item.find(|l| *l == end);
        }
    }
    kept
}

/// Adjectives after which "beside" would mean "compared with".
const COMPARED: [&str; 10] =
    ["small", "large", "stiff", "soft", "fast", "slow", "little", "weak", "improbable", "negligible"];

/// Comments of Rust, as number of the first line and text, that begin with one of the openings; comments of documentation
/// of fewer than three words; and those that compare by "beside".
fn faulty_comments(text: &str) -> Vec<(usize, String)> {
    let marks = [("//!", true), ("///", true), ("//", false)];
    let comment = |line: &str| {
        let line = line.trim();
        marks.iter().find_map(|(mark, doc)| Some((line.strip_prefix(mark)?.trim().to_owned(), *doc)))
    };
    let mut blocks: Vec<(usize, String, bool)> = Vec::new();
    let mut goes_on = false;
    for (n, line) in text.lines().enumerate() {
        let found = comment(line);
        match (&found, blocks.last_mut()) {
            (Some((more, _)), Some(block)) if goes_on => block.1 += &format!(" {more}"),
            (Some((first, doc)), _) => blocks.push((n + 1, first.clone(), *doc)),
            (None, _) => {}
        }
        goes_on = found.is_some();
    }
    let begins = |text: &str, word: &str| text.strip_prefix(word).is_some_and(|r| r.starts_with([' ', ',']));
    let is_faulty = |(_, text, doc): &(usize, String, bool)| {
        let compares = COMPARED.iter().any(|word| text.contains(&format!("{word} beside")));
        let is_short = *doc && !text.starts_with('#') && text.split_whitespace().count() < 3;
        OPENINGS.iter().any(|word| begins(text, word)) || is_short || compares
    };
    blocks.into_iter().filter(is_faulty).map(|(n, text, _)| (n, text)).collect()
}

/// Lines of code of the laboratory, of studio and command, of tests; and comments that break the rules.
fn counted() -> ([usize; 3], Vec<String>) {
    let top = top();
    let source: BTreeSet<PathBuf> = roots()
        .iter()
        .flat_map(|root| modules(root).into_values().map(|m| m.file.canonicalize().unwrap()))
        .collect();
    let mut all = Vec::new();
    for folder in ["msgs", "recordings", "nodes", "tests"] {
        files(&top.join(folder), &mut all);
    }
    let (mut counts, mut faults) = ([0; 3], Vec::new());
    for file in all {
        let short = file.strip_prefix(&top).unwrap();
        let extension = file.extension().unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        let total = code(&text, extension);
        let own = match extension {
            _ if short.starts_with("tests") || short.components().any(|c| c.as_os_str() == "tests") => 0,
            "rs" if source.contains(&file) => code(&without_tests(&text), extension),
            // Tests, examples and generators in files of their own.
            "rs" => 0,
            _ => total,
        };
        let studio = short.starts_with("nodes/studio") || short.starts_with("nodes/command");
        counts[usize::from(studio)] += own;
        counts[2] += total - own;
        if extension == "rs" {
            let of_file = faulty_comments(&text).into_iter();
            faults.extend(of_file.map(|(line, text)| format!("{}:{line}: {text}", short.display())));
        }
    }
    (counts, faults)
}

/// Texts with one place in all crates and their assets, and its file or folder.
const ONCE: [(&str, &str); 7] = [
    ("[\"xx\", \"yy\", \"zz\"", "nodes/kernels/core/src/tensor.rs"),
    ("<!DOCTYPE", "nodes/studio/page"),
    ("<html", "nodes/studio/page"),
    // Counting sort; half width of 95 %; spread of Wilson and Hilferty; subprotocols.
    ("first[bin + 1] += first[bin]", "nodes/kernels/core/src/bins.rs"),
    ("1.959_96", "nodes/kernels/emt/src/normal.rs"),
    ("2.0 / (9.0 *", "nodes/kernels/emt/src/normal.rs"),
    ("\"foxglove.sdk.v1\"", "nodes/studio/foxglove_bridge/src/protocol.rs"),
];

/// Names of types that say nothing of what they are.
const VAGUE: [&str; 8] = ["At", "Company", "Desk", "Knob", "Outlet", "Sink", "Tape", "Way"];

/// Types of `source` with a vague name.
fn vague(source: &str) -> Vec<&str> {
    let named = |word: &'static str| {
        let kinds = ["struct", "enum", "trait", "type"];
        let forms = |kind: &str| [" ", "<", "(", ";"].map(|end| format!("{kind} {word}{end}"));
        kinds.iter().flat_map(|kind| forms(kind)).any(|form| source.contains(&form)).then_some(word)
    };
    VAGUE.into_iter().filter_map(named).collect()
}

/// Types that may share a name: more say nothing of what they are. Arguments of commands all have one name.
const NAMESAKES: usize = 9;

/// Names of the types that `source` defines.
fn defined(source: &str) -> impl Iterator<Item = &str> {
    let name = |line: &'_ str| -> Option<(usize, usize)> {
        let visible = line.trim_start().strip_prefix("pub").map_or(line.trim_start(), |rest| {
            rest.split_once(") ")
                .filter(|_| rest.starts_with('('))
                .map_or(rest, |(_, rest)| rest)
                .trim_start()
        });
        let rest = visible.strip_prefix("struct ").or(visible.strip_prefix("enum "))?;
        let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
        Some((line.len() - rest.len(), end))
    };
    source.lines().filter_map(move |line| name(line).map(|(from, end)| &line[from..from + end]))
}

/// Names that more types have than may share one.
fn namesakes<'a>(sources: impl Iterator<Item = &'a str>) -> Vec<(&'a str, usize)> {
    let mut counts = BTreeMap::new();
    sources.flat_map(defined).for_each(|name| *counts.entry(name).or_insert(0) += 1);
    counts.into_iter().filter(|(name, count)| *name != "Args" && *count > NAMESAKES).collect()
}

/// Inferred quantities that a file may name. More are a list by hand, which a new quantity would miss.
const NAMED: usize = 3;

/// Places that define, infer and send the quantities.
const OF_QUANTITIES: [&str; 3] = ["nodes/kernels/core", "nodes/kernels/emt", "msgs/src/boundary/estimate.rs"];

/// Inferred quantities that a file names beyond the limit.
fn listed(file: &Path, source: &str) -> Option<String> {
    let of = |text: &str| text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned();
    let mut named: BTreeSet<String> = source.split("InferredQuantity::").skip(1).map(of).collect();
    named.retain(|name| name.starts_with(char::is_uppercase) && !["ALL", "COUNT"].contains(&name.as_str()));
    let elsewhere = OF_QUANTITIES.iter().all(|place| !file.starts_with(place));
    (elsewhere && named.len() > NAMED).then(|| format!("{} lists {named:?} by hand", file.display()))
}

/// Places of a text beside the one that it has.
fn repeated(text: &str, place: &str, files: &[(PathBuf, String)]) -> Vec<String> {
    let (there, others): (Vec<_>, Vec<_>) = files
        .iter()
        .filter(|(_, source)| source.contains(text))
        .partition(|(file, _)| file.starts_with(place));
    assert!(!there.is_empty(), "{text} is not in {place}");
    others.iter().map(|(file, _)| format!("{} repeats {text} of {place}", file.display())).collect()
}

/// Folders of the top that `text` installs by a bare name, which pip takes from its registry: somebody else's package.
fn bare_installs(text: &str, folders: &[&str]) -> Vec<String> {
    let names = text.split("pip install ").skip(1).filter_map(|rest| rest.split([' ', '`', '\n']).next());
    names.filter(|name| folders.contains(name)).map(str::to_owned).collect()
}

#[test]
fn no_page_installs_a_folder_of_the_top_from_the_registry_of_pip_or_names_a_folder_of_one_machine() {
    let folders = ["nodes", "msgs", "recordings", "tests"];
    assert_eq!(bare_installs("`pip install msgs` and pip install ./msgs", &folders), ["msgs"]);
    let mut all = vec![top().join("README.md")];
    ["nodes", "msgs", "recordings", ".github"].iter().for_each(|folder| files(&top().join(folder), &mut all));
    for file in all {
        let text = std::fs::read(&file).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap();
        assert_eq!(bare_installs(&text, &folders), Vec::<String>::new(), "{}", file.display());
        let is_page = file.extension().is_some_and(|e| e == "md");
        assert!(
            !is_page || !["/tmp/", "/home/", "/root/"].iter().any(|f| text.contains(f)),
            "{}",
            file.display()
        );
    }
}

#[test]
fn what_has_one_place_is_in_no_other() {
    let top = top();
    let mut all = Vec::new();
    files(&top.join("nodes"), &mut all);
    all.retain(|file| file.extension().is_some_and(|e| e != "rs"));
    all.extend(roots().iter().flat_map(|root| modules(root).into_values().map(|m| m.file)));
    let source = |file: PathBuf| {
        let file = file.canonicalize().unwrap();
        let text = without_tests(&std::fs::read_to_string(&file).unwrap());
        (file.strip_prefix(&top).unwrap().to_owned(), text)
    };
    // The rules themselves name these texts.
    let mut files: Vec<_> =
        all.into_iter().map(source).filter(|(f, _)| !f.starts_with("tests/layout")).collect();
    let planted = "let all = [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::KHat];";
    assert!(listed(Path::new("nodes/studio/planted/src/lib.rs"), planted).is_some());
    assert_eq!(
        files.iter().filter_map(|(file, text)| listed(file, text)).collect::<Vec<_>>(),
        Vec::<String>::new()
    );
    assert_eq!(vague("pub struct Way {\n}\nenum Attempt {}\n"), ["Way"]);
    for (file, text) in files.iter().filter(|(file, _)| file.extension().is_some_and(|e| e == "rs")) {
        assert_eq!(vague(text), Vec::<&str>::new(), "{}", file.display());
    }
    let planted = "pub(crate) struct Row<'a> {\n".repeat(NAMESAKES + 1);
    assert_eq!(namesakes([planted.as_str()].into_iter()), [("Row", NAMESAKES + 1)]);
    let sources = files.iter().filter(|(f, _)| f.extension().is_some_and(|e| e == "rs"));
    assert_eq!(namesakes(sources.map(|(_, text)| text.as_str())), []);
    for (text, place) in ONCE {
        assert_eq!(repeated(text, place, &files), Vec::<String>::new());
        files.push(("nodes/studio/planted/assets/page.html".into(), text.to_owned()));
        assert_eq!(repeated(text, place, &files).len(), 1);
        files.pop();
    }
}

/// A limit that is far above the count holds nothing: it is lowered with what is deleted.
const SLACK: usize = 300;

#[test]
fn the_source_is_as_long_as_its_budget() {
    let names = ["lines of the laboratory", "lines of studio and command", "lines of tests"];
    let limits = [LABORATORY, STUDIO_AND_COMMAND, TESTS];
    let mut faults = Vec::new();
    for ((name, limit), count) in names.iter().zip(limits).zip(counted().0) {
        if count > limit {
            faults.push(format!("{name}: {count}, at most {limit}: delete, merge, or use a library"));
        } else if count + SLACK < limit {
            faults.push(format!("{name}: {count}; lower the limit of {limit} to it"));
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Names that `text`, the root of a library, makes public.
fn public_names(text: &str) -> usize {
    fn used(tree: &UseTree) -> usize {
        match tree {
            UseTree::Path(path) => used(&path.tree),
            UseTree::Group(group) => group.items.iter().map(used).sum(),
            _ => 1,
        }
    }
    let is_public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
    let names = |item: &Item| match item {
        Item::Use(item) if is_public(&item.vis) => used(&item.tree),
        Item::Fn(item) => usize::from(is_public(&item.vis)),
        Item::Struct(item) => usize::from(is_public(&item.vis)),
        Item::Mod(item) => usize::from(is_public(&item.vis)),
        _ => 0,
    };
    syn::parse_file(text).unwrap().items.iter().map(names).sum()
}

#[test]
fn the_library_has_at_most_40_public_names() {
    let names = public_names(&std::fs::read_to_string(top().join("nodes/grainlab/src/lib.rs")).unwrap());
    assert!((10..=40).contains(&names), "{names}");
    assert_eq!(public_names("pub use a::{b, c::D};\npub fn e() {}\nuse f::g;\nmod h;\n"), 3);
}

#[test]
fn blank_lines_comments_and_tests_do_not_count() {
    let rust = "//! A module.\n\nfn a() {\n    // why\n    b();\n}\n\n/* long\n comment */\n#[cfg(test)]\nmod tests {\n    fn t() {}\n}\n";
    assert_eq!((code(rust, "rs"), code(&without_tests(rust), "rs")), (7, 3));
    assert_eq!(code(&without_tests("#[cfg(test)]\nmod tests;\nfn a() {}\n"), "rs"), 1);
    assert_eq!(code("\"\"\"A module.\n\nMore.\n\"\"\"\n# why\nx = 1\n", "py"), 1);
    assert_eq!(code("<!-- why -->\n<p>text</p>\n", "html"), 1);
    assert_eq!(code("/* why */\na { b: c }\n", "css"), 1);
}

#[test]
fn comments_begin_with_the_thing_they_describe() {
    let faults = counted().1;
    assert!(
        faults.is_empty(),
        "begin with a noun or a verb, say at least three words:\n{}",
        faults.join("\n")
    );
}

#[test]
fn a_comment_that_begins_with_what_or_is_too_short_is_a_fault() {
    let lines = |text: &str| Vec::from_iter(faulty_comments(text).into_iter().map(|(line, _)| line));
    let text = "/// What is sought.\nfn a() {}\n/// Whatever\n// Its value.\n/// A value.\n/// What it is for.\nfn b() {}\n";
    assert_eq!(lines(text), [1]);
    assert_eq!(lines("// Its value.\nfn a() {}\n// The same, twice.\n"), [1, 3]);
    assert_eq!(lines("/// Its.\nfn a() {}\n/// A length.\nfn b() {}\n// Short.\n"), [1, 3]);
    assert_eq!(
        lines("// An error that is small beside others.\n/// A file that lies beside another.\n"),
        [1]
    );
}
