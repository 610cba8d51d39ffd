//! The actions of a launch file.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// A launch file.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) launch: Vec<Placed>,
}

/// An action with its line in the file.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub(super) struct Placed {
    pub(super) entry: Entry,
    #[serde(skip)]
    pub(super) line: u64,
}

impl<'de> Deserialize<'de> for Placed {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let found = serde_saphyr::Spanned::<Entry>::deserialize(from)?;
        Ok(Self { line: found.referenced.line(), entry: found.value })
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Entry {
    Arg(Argument),
    Let(Setting),
    SetEnv(Setting),
    #[serde(alias = "push-ros-namespace")]
    PushRosNamespace(Namespace),
    SetParameter(Setting),
    SetRemap(Remap),
    Group(Group),
    Include(Include),
    Executable(Program),
    Node(Program),
}

/// A text, number or truth value, or a list of them as YAML.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub(super) struct Text(pub(super) String);

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        match serde_json::Value::deserialize(from)? {
            serde_json::Value::String(text) => Ok(Self(text)),
            serde_json::Value::Object(_) => {
                Err(D::Error::custom("a text, a number or true or false is expected"))
            }
            other => Ok(Self(other.to_string())),
        }
    }
}

/// The conditions of an action.
pub(super) type Condition<'a> = (&'a Option<Text>, &'a Option<Text>);

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Argument {
    pub(super) name: String,
    pub(super) default: Option<Text>,
    #[serde(default)]
    pub(super) choice: Vec<Choice>,
    description: Option<String>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Choice {
    pub(super) value: Text,
}

/// A name with its value.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Setting {
    pub(super) name: String,
    pub(super) value: Text,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Namespace {
    pub(super) namespace: Text,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Remap {
    pub(super) from: Text,
    pub(super) to: Text,
}

/// Actions that run in a scope of their own, unless `scoped` is false.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub(super) struct Group {
    pub(super) children: Vec<Placed>,
    /// The file that it is included from.
    #[serde(skip)]
    pub(super) file: Option<String>,
    pub(super) scoped: Option<Text>,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
}

impl Serialize for Group {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, to)
    }
}

/// A list, or a mapping with `children`.
impl<'de> Deserialize<'de> for Group {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Group;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a list of actions, or a mapping with children")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Group, A::Error> {
                let children = Vec::deserialize(SeqAccessDeserializer::new(seq))?;
                Ok(Group { children, ..Group::default() })
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Group, A::Error> {
                Group::deserialize(MapAccessDeserializer::new(map))
            }
        }
        from.deserialize_any(Either)
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Include {
    pub(super) file: String,
    #[serde(default, alias = "let")]
    pub(super) arg: Vec<Setting>,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
}

/// A process: an executable by its `cmd`, or a node by `pkg` and `exec`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Program {
    pub(super) cmd: Option<String>,
    pub(super) pkg: Option<Text>,
    pub(super) exec: Option<Text>,
    pub(super) namespace: Option<Text>,
    pub(super) args: Option<Text>,
    pub(super) ros_args: Option<Text>,
    pub(super) param: Vec<Parameter>,
    pub(super) remap: Vec<Remap>,
    pub(super) name: Option<Text>,
    pub(super) output: Option<Text>,
    pub(super) respawn: Option<Text>,
    pub(super) on_exit: Option<Text>,
    pub(super) env: Vec<Setting>,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
}

/// A parameter with its value, or a file of parameters.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Parameter {
    pub(super) name: Option<String>,
    pub(super) value: Option<Text>,
    pub(super) from: Option<Text>,
}
