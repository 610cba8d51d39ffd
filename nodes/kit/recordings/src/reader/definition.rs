//! The definition that a recording has of a type of this program.

use std::borrow::Cow;
use std::sync::Arc;

use grainlab_any_message::{Comparison, Mapping, Schema};
use grainlab_msgs::TypeInfo;

/// Relation of the messages of a channel to the type of this name in this program. The definition in the recording decides, since
/// copies may keep a hash of another version; the hash counts where there is no definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StoredDefinition {
    /// This program has no type of the name.
    Unknown,
    /// The type of this program.
    Same,
    /// Fields of this program, and another hash in the metadata of the channel.
    OtherHash,
    /// Fields are read by their names: their order or their number differs.
    Mapped(Arc<Mapping>),
    /// Another type: why its messages are not read.
    Refused(String),
}

impl StoredDefinition {
    pub(crate) fn of(ros_type: &str, encoding: &str, definition: &str, hash: &str) -> Self {
        let Some(info) = TypeInfo::by_name(ros_type) else { return Self::Unknown };
        if definition.trim().is_empty() || encoding != "ros2msg" {
            return match hash {
                "" => Self::Refused("the recording has neither its definition (ros2msg) nor its hash".into()),
                hash if hash == info.hash => Self::Same,
                hash => Self::Refused(format!("its hash is {hash}, not {}", info.hash)),
            };
        }
        let same = if hash.is_empty() || hash == info.hash { Self::Same } else { Self::OtherHash };
        if definition == info.definition {
            return same;
        }
        let parsed = |text| Schema::parse(ros_type, text).map_err(|e| e.to_string());
        match (parsed(definition), parsed(info.definition)) {
            (Ok(stored), Ok(own)) => match stored.compare(&own) {
                Comparison::Same => same,
                Comparison::Mapped(mapping) => Self::Mapped(Arc::new(mapping)),
                Comparison::Differs(faults) => Self::Refused(faults.join("; ")),
            },
            (Err(problem), _) | (_, Err(problem)) => Self::Refused(problem),
        }
    }

    /// In a word: `same`, `mapped`, `refused`, or `unknown`.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Same | Self::OtherHash => "same",
            Self::Mapped(_) => "mapped",
            Self::Refused(_) => "refused",
        }
    }

    /// Returns a note to the user, in a line; `None` if the type is that of this program or of an earlier version, or unknown to it.
    pub fn note(&self) -> Option<String> {
        match self {
            Self::Unknown | Self::Same => None,
            Self::Mapped(mapping) if mapping.notes().is_empty() => None,
            Self::OtherHash => Some(
                "its definition is that of this program, but its hash is another one: the definition counts"
                    .into(),
            ),
            Self::Mapped(mapping) => Some(format!(
                "its definition differs from that of this program and is read by the names of its fields: {}",
                mapping.notes().join("; ")
            )),
            Self::Refused(why) => {
                Some(format!("its definition differs from that of this program: {why}; not read"))
            }
        }
    }

    /// The bytes of a message as those of the type of this program.
    pub(super) fn own<'a>(&self, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, String> {
        match self {
            Self::Unknown | Self::Same | Self::OtherHash => Ok(Cow::Borrowed(bytes)),
            Self::Mapped(mapping) => mapping.apply(bytes).map(Cow::Owned).map_err(|e| e.to_string()),
            Self::Refused(_) => Err(self.note().unwrap_or_default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of the fields of the type itself: where each begins and ends, its type and its name.
    fn fields(definition: &str) -> Vec<(usize, usize, &str, &str)> {
        let mut found = Vec::new();
        let mut at = 0;
        for line in definition.split_inclusive('\n') {
            if line.starts_with("====") {
                break;
            }
            let code = line.split('#').next().unwrap_or_default();
            if let [kind, name, ..] = code.split_whitespace().collect::<Vec<_>>()[..]
                && !code.contains('=')
            {
                found.push((at, at + line.len(), kind, name));
            }
            at += line.len();
        }
        found
    }

    fn word(info: &TypeInfo, definition: &str) -> &'static str {
        StoredDefinition::of(info.type_name, "ros2msg", definition, info.hash).word()
    }

    #[test]
    fn a_field_of_any_type_that_is_renamed_retyped_removed_added_or_moved_is_never_read_by_position() {
        let mut cases = 0;
        for info in TypeInfo::all() {
            let text = info.definition;
            assert_eq!(word(info, text), "same", "{}", info.type_name);
            let all = fields(text);
            assert_eq!(all.len(), info.fields.len(), "{}", info.type_name);
            for (n, (from, to, kind, name)) in all.iter().copied().enumerate() {
                let with = |line: &str| format!("{}{line}{}", &text[..from], &text[to..]);
                let other = if kind == "float32" { "float64" } else { "float32" };
                for (changed, expected) in [
                    (with(&format!("{kind} another_{name}\n")), "refused"),
                    (with(&format!("{other} {name}\n")), "refused"),
                    // A list may have been added later.
                    (with(""), if kind.ends_with("[]") { "mapped" } else { "refused" }),
                    (with(&format!("{kind} {name}\nint16 another_{name}\n")), "mapped"),
                ] {
                    assert_eq!(word(info, &changed), expected, "{}, {name}: {changed}", info.type_name);
                    cases += 1;
                }
                if let Some((start, end, ..)) = all.get(n + 1) {
                    let (own, next) = (&text[from..to], &text[*start..*end]);
                    let changed =
                        format!("{}{next}{}{own}{}", &text[..from], &text[to..*start], &text[*end..]);
                    assert_eq!(word(info, &changed), "mapped", "{}, {name}", info.type_name);
                    cases += 1;
                }
            }
        }
        assert!(cases > 1000, "{cases}");
    }

    #[test]
    fn the_definition_decides_and_the_hash_where_there_is_none() {
        let info = TypeInfo::by_name("rosgraph_msgs/msg/Clock").unwrap();
        let of =
            |encoding, definition, hash| StoredDefinition::of(info.type_name, encoding, definition, hash);
        assert_eq!(of("ros2msg", info.definition, ""), StoredDefinition::Same);
        assert_eq!(of("ros2msg", info.definition, "RIHS01_00"), StoredDefinition::OtherHash);
        assert_eq!(of("", "", info.hash), StoredDefinition::Same);
        assert_eq!(of("ros2idl", "module m {};", info.hash), StoredDefinition::Same);
        for (encoding, definition, hash) in [
            ("", "", ""),
            ("", "", "RIHS01_00"),
            ("ros2idl", "module m {};", ""),
            ("ros2msg", "uint8 x[", info.hash),
        ] {
            let found = of(encoding, definition, hash);
            assert!(matches!(found, StoredDefinition::Refused(_)), "{encoding:?} {definition:?}: {found:?}");
        }
        assert_eq!(StoredDefinition::of("a_msgs/msg/B", "", "", ""), StoredDefinition::Unknown);
    }
}
