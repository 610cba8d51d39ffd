//! Merging one table over another.

use crate::fault::Fault;
use crate::keys::{CONTACT_KEYS, KEYS};
use crate::nearest::{hint, nearest};
use crate::reader::kind;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Removes a key of the base.
const UNSET: &str = "unset";

/// Merges `over` over a scene. The faults are changes of keys that the scene lacks.
pub(crate) fn overlay(scene: &mut Table, mut over: Table) -> Vec<Fault> {
    let mut faults = Vec::new();
    let (removed, appended) = (over.remove("remove"), over.remove("append"));
    if let Some(names) = removed {
        remove(path(scene), names, &mut faults);
    }
    if matches!(over.get("phase"), Some(Value::Table(_)))
        && let Some(Value::Table(changes)) = over.remove("phase")
    {
        // A friction of every phase leaves nothing to that of the scene.
        if changes.get("*").is_some_and(|change| change.get("friction").is_some()) {
            scene.remove("friction");
        }
        changes.into_iter().for_each(|(name, change)| change_phase(path(scene), &name, change, &mut faults));
    }
    merge(scene, over, "", &mut faults);
    if let Some(phases) = appended {
        append(path(scene), phases, &mut faults);
    }
    faults
}

/// The phases of a scene or a cycle. A value that is not an array is reported when the scene is read.
fn path(table: &mut Table) -> Option<&mut Vec<Value>> {
    table.get_mut("phase").and_then(Value::as_array_mut)
}

fn merge(table: &mut Table, over: Table, place: &str, faults: &mut Vec<Fault>) {
    for (key, value) in over {
        let place = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
        match (table.get_mut(&key), value) {
            (Some(_), Value::String(word)) if word == UNSET => {
                table.remove(&key);
            }
            (None, Value::String(word)) if word == UNSET => {
                let hint =
                    nearest(&key, table.keys().map(String::as_str)).map(|k| hint(&k)).unwrap_or_default();
                faults.push(Fault { place, message: format!("is unset, but there is none{hint}") });
            }
            // The control of a component is a single value.
            (Some(Value::Table(under)), Value::Table(over)) if !is_component(&place) => {
                merge(under, over, &place, faults);
            }
            (_, value) => {
                table.insert(key, value);
            }
        }
    }
}

fn is_component(place: &str) -> bool {
    place.rsplit('.').nth(1) == Some("control")
}

fn retain(change: &mut Table, place: &str, has: &mut dyn FnMut(&str, &Value) -> bool) {
    change.retain(|key, value| match value {
        Value::Table(inner) if !place.ends_with("control.") => {
            retain(inner, &format!("{place}{key}."), has);
            !inner.is_empty()
        }
        value => has(&format!("{place}{key}"), value),
    });
}

/// True if a phase states a key, or its kind takes it. A condition has no default, so that only a phase that states it has it.
fn has(phase: &Table, path: &str, value: &Value) -> bool {
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    let mut rest = rest.split_terminator('.');
    let is_stated = phase.get(first).and_then(|v| rest.try_fold(v, |v, part| v.get(part))).is_some();
    if is_stated || value.as_str() == Some(UNSET) {
        return is_stated;
    }
    let word = |key| phase.get(key).and_then(Value::as_str).unwrap_or_default();
    let is_hard = word("kind") == "gas" && word("method") != "soft";
    let path = if is_component(path) { "control" } else { path };
    KEYS.iter().filter(|k| k.path.strip_prefix("phase.") == Some(path)).any(|k| {
        let is_lacked = k.is_condition() || is_hard && CONTACT_KEYS.iter().any(|c| c.path == k.path);
        k.kinds.contains(&word("kind")) && !is_lacked
    })
}

fn change_phase(phases: Option<&mut Vec<Value>>, pattern: &str, change: Value, faults: &mut Vec<Fault>) {
    let place = format!("phase.{pattern}");
    let Value::Table(change) = change else {
        let message = format!("is {}; it must be a table of keys of this phase", kind(&change));
        faults.push(Fault { place, message });
        return;
    };
    let mut none = Vec::new();
    let phases = phases.unwrap_or(&mut none);
    let known = names(phases);
    match known.iter().filter(|name| matches(pattern, name)).count() {
        0 => faults.push(Fault { place, message: unknown(pattern, &known) }),
        _ if pattern.contains('*') => {
            let mut reached: BTreeMap<String, bool> = BTreeMap::new();
            each(phases, pattern, &mut |phase| {
                let mut own = change.clone();
                retain(&mut own, "", &mut |key, value| {
                    let has = has(phase, key, value);
                    *reached.entry(key.to_owned()).or_default() |= has;
                    has
                });
                merge(phase, own, &place, faults);
            });
            for (key, _) in reached.into_iter().filter(|(_, has)| !has) {
                let known: Vec<&str> = KEYS.iter().filter_map(|k| k.path.strip_prefix("phase.")).collect();
                let meant = nearest(&key, known.iter().copied()).filter(|_| !known.contains(&&*key));
                let hint = meant.map(|k| hint(&k)).unwrap_or_default();
                let message = format!("no phase of this pattern has the key{hint}; to add it, name a phase");
                faults.push(Fault { place: format!("{place}.{key}"), message });
            }
        }
        1 => each(phases, pattern, &mut |phase| merge(phase, change.clone(), &place, faults)),
        found => {
            let message = format!("{found} phases have this name; {pattern}* means all of them");
            faults.push(Fault { place, message });
        }
    }
}

fn remove(phases: Option<&mut Vec<Value>>, removed: Value, faults: &mut Vec<Fault>) {
    let patterns: Option<Vec<&str>> = removed.as_array().and_then(|a| a.iter().map(Value::as_str).collect());
    let (Some(patterns), Some(phases)) = (patterns, phases) else {
        let message =
            format!("is {}; it must be names of phases of a base, as in [\"rest\"]", kind(&removed));
        faults.push(Fault { place: "remove".into(), message });
        return;
    };
    for pattern in patterns {
        let known = names(phases);
        if known.iter().any(|name| matches(pattern, name)) {
            leave_out(phases, pattern);
        } else {
            faults.push(Fault { place: "remove".into(), message: unknown(pattern, &known) });
        }
    }
}

fn leave_out(phases: &mut Vec<Value>, pattern: &str) {
    phases.retain(|p| p.as_table().is_none_or(|t| !matches(pattern, name_of(t))));
    for body in phases.iter_mut().filter_map(|p| path(p.as_table_mut()?)) {
        leave_out(body, pattern);
    }
}

fn append(phases: Option<&mut Vec<Value>>, added: Value, faults: &mut Vec<Fault>) {
    let (Value::Array(added), Some(phases)) = (added, phases) else {
        let message = "must be an array of tables over a base, one per phase: [[append]]".into();
        faults.push(Fault { place: "append".into(), message });
        return;
    };
    // Phases added after the same phase keep their order.
    let mut last: Vec<(String, String)> = Vec::new();
    for (i, mut entry) in added.into_iter().enumerate() {
        let after = entry.as_table_mut().and_then(|t| t.remove("after"));
        let Some(after) = after else {
            phases.push(entry);
            continue;
        };
        let place = format!("append[{i}].after");
        let Some(after) = after.as_str() else {
            let message = format!("is {after}; it must be the name of a phase, in quotes");
            faults.push(Fault { place, message });
            continue;
        };
        let name = entry.as_table().map(|t| name_of(t).to_owned()).unwrap_or_default();
        let behind = last.iter().rev().find(|(a, _)| a == after).map_or(after, |(_, name)| name).to_owned();
        if insert(phases, &behind, entry) {
            last.push((after.to_owned(), name));
        } else {
            faults.push(Fault { place, message: unknown(after, &names(phases)) });
        }
    }
}

/// Inserts a phase after the first one of this name, at any depth.
fn insert(phases: &mut Vec<Value>, behind: &str, phase: Value) -> bool {
    if let Some(at) = phases.iter().position(|p| p.as_table().is_some_and(|t| name_of(t) == behind)) {
        phases.insert(at + 1, phase);
        return true;
    }
    phases.iter_mut().filter_map(|p| path(p.as_table_mut()?)).any(|body| insert(body, behind, phase.clone()))
}

/// The names of all phases, including those of cycles.
fn names(phases: &[Value]) -> Vec<String> {
    let own_and_inner = |table: &Table| {
        let body = table.get("phase").and_then(Value::as_array);
        [vec![name_of(table).to_owned()], body.map_or_else(Vec::new, |body| names(body))].concat()
    };
    phases.iter().filter_map(Value::as_table).flat_map(own_and_inner).collect()
}

/// Visits the phases whose name matches the pattern, in cycles too.
fn each(phases: &mut [Value], pattern: &str, visit: &mut dyn FnMut(&mut Table)) {
    for table in phases.iter_mut().filter_map(Value::as_table_mut) {
        if matches(pattern, name_of(table)) {
            visit(table);
        }
        if let Some(body) = path(table) {
            each(body, pattern, visit);
        }
    }
}

/// The name of a phase; its kind if it has no name.
pub(crate) fn name_of(table: &Table) -> &str {
    table.get("name").or(table.get("kind")).and_then(Value::as_str).unwrap_or_default()
}

/// True if a name matches a pattern, in which `*` matches any letters.
fn matches(pattern: &str, name: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(mut name) = name.strip_prefix(start) else { return false };
    let (middle, end) = rest.rsplit_once('*').unwrap_or(("", rest));
    for part in middle.split('*') {
        let Some(at) = name.find(part) else { return false };
        name = &name[at + part.len()..];
    }
    name.ends_with(end)
}

fn unknown(name: &str, known: &[String]) -> String {
    let hint = nearest(name, known.iter().map(String::as_str)).map(|k| hint(&k)).unwrap_or_default();
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    format!("no phase is named {name:?}{hint}; there are: {known}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_matches_any_letters() {
        let fits = |pattern, names: [&str; 3]| names.map(|name| matches(pattern, name));
        assert_eq!(fits("load-*", ["load-50kPa", "load-", "unload-50kPa"]), [true, true, false]);
        assert_eq!(fits("*load*Pa", ["unload-50kPa", "load-50kPb", "settle"]), [true, false, false]);
        assert_eq!(fits("*", ["gas", "", "rest"]), [true; 3]);
        assert_eq!(fits("a*a", ["a", "aa", "aba"]), [false, true, true]);
    }
}
