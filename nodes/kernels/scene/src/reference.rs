//! The reference of the format as a page of Markdown, written from the table of keys.

use crate::key::{DefaultValue, Domain, Key};
use crate::keys::{KEYS, KINDS};

const INTRODUCTION: &str = include_str!("reference/introduction.md");

/// The page: how scenes are written and changed, and every key with its unit, default and values.
pub fn reference() -> String {
    let mut page = format!("{INTRODUCTION}\n## Keys\n");
    let of_phase = |k: &Key| k.path.starts_with("phase.");
    let of_part = |k: &Key| k.path.matches('.').count() > 1;
    let top = |k: &Key| !k.path.contains('.');
    page += &section("The scene", |k| top(k));
    for (table, title) in [
        ("start.", "`[start]`: from a packing instead of a gas"),
        ("grains.", "`[grains]`"),
        ("material.", "`[material]`, glass by default"),
        ("contact.", "`[contact]`: the contact law"),
        ("numerics.", "`[numerics]`"),
    ] {
        page += &section(title, |k| k.path.starts_with(table));
    }
    for (kind, title) in std::iter::once(("", "Every phase")).chain(KINDS) {
        let own = |k: &Key| match k.kinds {
            [only] => *only == kind,
            _ => kind.is_empty(),
        };
        page += &section(title, |k| of_phase(k) && !of_part(k) && own(k));
    }
    for (table, title) in [
        ("phase.record.", "`record`: packings within a phase"),
        ("phase.until.", "`until`: the conditions that end a phase"),
    ] {
        page += &section(title, |k| k.path.starts_with(table));
    }
    page
}

/// A title with a table of these keys below it. Without keys it is the title alone.
fn section(title: &str, belongs: impl Fn(&Key) -> bool) -> String {
    let rows: Vec<String> = KEYS.iter().filter(|k| belongs(k)).map(|k| row(k)).collect();
    let head = if rows.is_empty() {
        ""
    } else {
        "\n| key | unit | default | values | meaning |\n|---|---|---|---|---|\n"
    };
    format!("\n### {title}\n{head}{}", rows.concat())
}

fn row(key: &Key) -> String {
    let values = match key.domain {
        Domain::Number(range) => range.to_string(),
        _ => key.requirement(),
    };
    let default = match key.default {
        DefaultValue::Required => "required".to_owned(),
        DefaultValue::Number(value) if value.abs() >= 1e5 => format!("{value:e}"),
        DefaultValue::Number(value) => value.to_string(),
        DefaultValue::Whole(value) => value.to_string(),
        DefaultValue::Flag(value) => value.to_string(),
        DefaultValue::Text("") => "empty".to_owned(),
        DefaultValue::Text(value) => format!("`{value:?}`"),
        DefaultValue::Words(words) => words.to_owned(),
    };
    let unit = if key.unit.is_empty() { "-" } else { key.unit };
    format!("| `{}` | {unit} | {default} | {values} | {} |\n", key.name(), key.meaning)
}
