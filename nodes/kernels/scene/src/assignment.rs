//! `KEY=VALUE`, as on a command line.

use crate::fault::SceneError;
use crate::key::Domain;
use crate::keys::KEYS;
use toml::{Table, Value};

/// The table of an assignment such as `phase.rest.drag=1e3`: keys as in a scene, with a phase given by its
/// name, and a value as in a scene, except that the quotes of a text may be omitted.
///
/// ```
/// let table = grainlab_scene::assignment("grains.count=500").unwrap();
/// assert_eq!(table["grains"]["count"].as_integer(), Some(500));
/// ```
pub fn assignment(text: &str) -> Result<Table, SceneError> {
    let fault = |message: &'static str| move || SceneError::one(text, message);
    let (key, value) =
        text.split_once('=').ok_or_else(fault("is not KEY=VALUE, such as grains.count=500"))?;
    let parts = split(key.trim()).ok_or_else(fault("has no key before the =, or an empty part in it"))?;
    let mut value = read(&parts, value.trim());
    let mut parts = parts.into_iter().rev();
    let last = parts.next().unwrap_or_default();
    let mut table = Table::from_iter([(last, value)]);
    for part in parts {
        value = Value::Table(table);
        table = Table::from_iter([(part, value)]);
    }
    Ok(table)
}

/// The parts of a key between its dots; a part in quotes may contain dots.
fn split(key: &str) -> Option<Vec<String>> {
    let (mut parts, mut quoted) = (vec![String::new()], None);
    for c in key.chars() {
        match (c, quoted) {
            (c, Some(quote)) if c == quote => quoted = None,
            ('"' | '\'', None) => quoted = Some(c),
            ('.', None) => parts.push(String::new()),
            (c, _) => parts.last_mut()?.push(c),
        }
    }
    parts.iter().all(|p| !p.trim().is_empty()).then_some(parts)
}

/// A value in TOML. Invalid TOML is a text, as is every value of a key that takes text.
fn read(key: &[String], value: &str) -> Value {
    let path = match key {
        [phase, _, rest @ ..] if phase == "phase" => format!("phase.{}", rest.join(".")),
        key => key.join("."),
    };
    let is_text = KEYS.iter().any(|k| k.path == path && matches!(k.domain, Domain::Text));
    let quoted = value.starts_with(['"', '\'']);
    let parsed = || format!("v = {value}").parse::<Table>().ok()?.remove("v");
    if is_text && !quoted {
        return value.into();
    }
    parsed().unwrap_or_else(|| value.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_values_are_those_of_a_scene() {
        let of = |text| assignment(text).map(|t| t.to_string());
        assert_eq!(of("friction=0.2").unwrap().trim(), "friction = 0.2");
        assert_eq!(of("name=005").unwrap().trim(), "name = \"005\"");
        assert_eq!(of("name=500").unwrap().trim(), "name = \"500\"");
        assert_eq!(
            of("numerics.tangential=incremental").unwrap(),
            "[numerics]\ntangential = \"incremental\"\n"
        );
        let nested = assignment("phase.\"load-0.5kPa\".until={ hold = 1.0 }").unwrap();
        assert_eq!(nested["phase"]["load-0.5kPa"]["until"]["hold"].as_float(), Some(1.0));
        assert_eq!(
            assignment("phase.settle-*.drag=1e3").unwrap()["phase"]["settle-*"]["drag"].as_float(),
            Some(1e3)
        );
        for wrong in ["friction", "=1", "a..b=1", ""] {
            assert!(assignment(wrong).is_err(), "{wrong}");
        }
    }
}
