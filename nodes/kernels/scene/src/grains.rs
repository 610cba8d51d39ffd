//! Number and sizes of the grains in the text.

use crate::canonical::{Entries, Entry, number};
use crate::key::Interval;
use crate::keys;
use crate::reader::{Reader, as_number};
use crate::sizes::{Sizes, Species};
use toml::{Table, Value};

/// Largest diameter over smallest: the grid of the neighbour search is as wide as the largest diameter.
const LARGEST_RATIO: f64 = 20.0;

pub(crate) fn read(r: &mut Reader<'_>) -> (u32, Sizes) {
    let listed = r.get(&keys::DIAMETER).and_then(counts);
    let unwhole = r.get(&keys::DIAMETER).and_then(unwhole).map(|count| {
        format!(
            "has the count {count}; a count is a whole number, written without a decimal point or exponent"
        )
    });
    let too_many = listed.filter(|sum| *sum > keys::MOST_GRAINS);
    let too_many = too_many
        .map(|sum| format!("has counts that sum to {sum} grains; a run has at most {}", keys::MOST_GRAINS));
    let count = match unwhole.or(too_many) {
        Some(message) => {
            r.get(&keys::GRAIN_COUNT);
            r.fault("diameter", message);
            1
        }
        None => r.whole(&keys::GRAIN_COUNT, listed),
    };
    if let Some(sum) = listed.filter(|sum| r.is_sound() && *sum != count) {
        r.fault("count", format!("is {count}, but the counts in diameter sum to {sum}"));
    }
    let sizes = sizes(r);
    if sizes.ratio() > LARGEST_RATIO {
        let message = format!(
            "reaches over a factor of {:.1}; at most {LARGEST_RATIO} can be simulated",
            sizes.ratio()
        );
        r.fault("diameter", message);
    }
    (count as u32, sizes)
}

/// The sum of the counts in a list of diameters, if it has counts.
fn counts(value: &Value) -> Option<u64> {
    let entries = value.as_array()?.iter().map(Value::as_table);
    let counts = entries.map(|t| u64::try_from(t?.get("count")?.as_integer()?).ok());
    counts
        .collect::<Option<Vec<_>>>()
        .filter(|c| !c.is_empty())
        .map(|c| c.iter().fold(0u64, |a, b| a.saturating_add(*b)))
}

/// The first count in a list of diameters that is no whole number.
fn unwhole(value: &Value) -> Option<String> {
    let counts = value.as_array()?.iter().filter_map(|entry| entry.as_table()?.get("count"));
    counts.filter(|count| count.as_integer().is_none()).map(Value::to_string).next()
}

fn sizes(r: &mut Reader<'_>) -> Sizes {
    let value = r.get(&keys::DIAMETER);
    let found = value.and_then(|value| match value {
        Value::Table(table) => law(table),
        Value::Array(entries) => mixture(entries),
        value => length(value).map(Sizes::Equal),
    });
    let Some(sizes) = found else {
        r.refuse(&keys::DIAMETER, value);
        return Sizes::Equal(1.0);
    };
    r.keep(&keys::DIAMETER, entry(&sizes));
    sizes
}

/// A length above 0, m.
fn length(value: &Value) -> Option<f64> {
    as_number(value).filter(|v| Interval::POSITIVE.contains(*v))
}

/// The values of exactly these keys.
fn pair(table: &Table, keys: [&str; 2]) -> Option<[f64; 2]> {
    let of = |key| table.get(key).and_then(length);
    (table.len() == 2).then_some(())?;
    Some([of(keys[0])?, of(keys[1])?])
}

fn law(table: &Table) -> Option<Sizes> {
    let uniform = pair(table, ["min", "max"]).filter(|[min, max]| min < max);
    let lognormal = pair(table, ["median", "spread"]);
    uniform
        .map(|[min, max]| Sizes::Uniform { min, max })
        .or(lognormal.map(|[median, spread]| Sizes::Lognormal { median, spread }))
}

fn mixture(entries: &[Value]) -> Option<Sizes> {
    let tables: Option<Vec<&Table>> = entries.iter().map(Value::as_table).collect();
    let tables = tables.filter(|t| !t.is_empty())?;
    let of = |weight: &str| -> Option<Vec<[f64; 2]>> {
        tables.iter().map(|t| pair(t, ["diameter", weight])).collect()
    };
    let pairs = of("share").or_else(|| of("count"))?;
    let sum: f64 = pairs.iter().map(|[_, weight]| weight).sum();
    // Shares are read again as they were written.
    let sum = if (sum - 1.0).abs() < 1e-12 { 1.0 } else { sum };
    let species = pairs.iter().map(|[diameter, weight]| Species { diameter: *diameter, share: weight / sum });
    Some(Sizes::Mixture(species.collect()))
}

fn entry(sizes: &Sizes) -> Entry {
    let table = |pairs: [(&'static str, f64); 2]| -> Entries {
        pairs.map(|(name, value)| (name, number(value))).to_vec()
    };
    match sizes {
        Sizes::Equal(diameter) | Sizes::OfPacking { mean: diameter } => number(*diameter),
        Sizes::Uniform { min, max } => Entry::Table(table([("min", *min), ("max", *max)])),
        Sizes::Lognormal { median, spread } => {
            Entry::Table(table([("median", *median), ("spread", *spread)]))
        }
        Sizes::Mixture(species) => Entry::Inline(
            species.iter().map(|s| table([("diameter", s.diameter), ("share", s.share)])).collect(),
        ),
    }
}
