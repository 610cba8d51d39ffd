//! The actions of a launch file.

use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize};

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
    Group(Vec<Placed>),
    Include(Include),
    Executable(Executable),
    Node(Node),
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

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Argument {
    pub(super) name: String,
    pub(super) default: Option<Text>,
    description: Option<String>,
}

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
pub(super) struct Include {
    pub(super) file: String,
    #[serde(default, alias = "let")]
    pub(super) arg: Vec<Setting>,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
    /// The actions of the file, in the text that is kept with a run.
    pub(super) children: Option<Vec<Placed>>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Executable {
    pub(super) cmd: String,
    pub(super) name: Option<Text>,
    pub(super) output: Option<Text>,
    pub(super) respawn: Option<Text>,
    pub(super) on_exit: Option<Text>,
    #[serde(rename = "if")]
    pub(super) if_: Option<Text>,
    pub(super) unless: Option<Text>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Node {
    pub(super) pkg: Text,
    pub(super) exec: Text,
    pub(super) namespace: Option<Text>,
    pub(super) args: Option<Text>,
    #[serde(default)]
    pub(super) param: Vec<Parameter>,
    #[serde(default)]
    pub(super) remap: Vec<Remap>,
    pub(super) name: Option<Text>,
    pub(super) output: Option<Text>,
    pub(super) respawn: Option<Text>,
    pub(super) on_exit: Option<Text>,
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

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Remap {
    pub(super) from: Text,
    pub(super) to: Text,
}
