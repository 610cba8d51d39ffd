//! The canonical text of a scene: every key in a fixed order, with defaults, without base.

use toml::Value;

pub(crate) type Entries = Vec<(&'static str, Entry)>;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Entry {
    /// Written as TOML.
    Value(String),
    Table(Entries),
    /// An array of tables, each with its own heading.
    Tables(Vec<Entries>),
    /// An array of tables on one line.
    Inline(Vec<Entries>),
}

/// A number, with as many digits as are needed to read the same bits.
pub(crate) fn number(value: f64) -> Entry {
    Entry::Value(format!("{value:?}"))
}

pub(crate) fn numbers(values: &[f64]) -> Entry {
    Entry::Value(format!("[{}]", values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ")))
}

pub(crate) fn text(value: &str) -> Entry {
    Entry::Value(Value::from(value).to_string())
}

/// A scene as text: values first, then tables, then arrays of tables.
pub(crate) fn write(entries: &Entries) -> String {
    let mut out = String::new();
    body(entries, "", true, &mut out);
    out
}

/// Writes the table at `path`. Tables at the top have their own sections, deeper ones are on one line.
fn body(entries: &Entries, path: &str, top: bool, out: &mut String) {
    for (name, entry) in entries {
        match entry {
            Entry::Value(value) => *out += &format!("{name} = {value}\n"),
            Entry::Table(table) if !top => *out += &format!("{name} = {}\n", inline(table)),
            Entry::Inline(tables) => *out += &format!("{name} = {}\n", row(tables)),
            _ => {}
        }
    }
    for (name, entry) in entries {
        if let (Entry::Table(table), true) = (entry, top) {
            *out += &format!("\n[{name}]\n");
            body(table, name, false, out);
        }
    }
    for (name, entry) in entries {
        if let Entry::Tables(tables) = entry {
            let path = if path.is_empty() { (*name).to_owned() } else { format!("{path}.{name}") };
            for table in tables {
                *out += &format!("\n[[{path}]]\n");
                body(table, &path, false, out);
            }
        }
    }
}

fn inline(entries: &Entries) -> String {
    let value = |entry: &Entry| match entry {
        Entry::Value(value) => value.clone(),
        Entry::Table(table) => inline(table),
        Entry::Tables(tables) | Entry::Inline(tables) => row(tables),
    };
    let items: Vec<String> =
        entries.iter().map(|(name, entry)| format!("{name} = {}", value(entry))).collect();
    if items.is_empty() { "{}".into() } else { format!("{{ {} }}", items.join(", ")) }
}

fn row(tables: &[Entries]) -> String {
    format!("[{}]", tables.iter().map(inline).collect::<Vec<_>>().join(", "))
}
