//! Name, hash and schema of a message type.

use crate::decode_error::DecodeError;
use serde::{Serialize, de::DeserializeOwned};

/// A ROS 2 message type.
pub trait Message: Serialize + DeserializeOwned + Send + 'static {
    /// Package, for example `grainlab_msgs`.
    const PACKAGE: &'static str;
    /// Name within the package, for example `Stress`.
    const NAME: &'static str;
    /// Full ROS name, for example `grainlab_msgs/msg/Stress`.
    const TYPE: &'static str;
    /// Type hash (REP-2016), `RIHS01_` and 64 hexadecimal digits.
    const HASH: &'static str;
    /// Fields, as in a type description.
    const FIELDS: &'static [FieldInfo];
    /// Schema text as rosbag2 writes it: the message file, then every message file that it depends on.
    const DEFINITION: &'static str;

    /// The message as CDR; see [`crate::to_cdr`].
    fn encoded(&self) -> Vec<u8>;

    /// Decodes a message; see [`crate::from_cdr`].
    fn decoded(bytes: &[u8]) -> Result<Self, DecodeError>;
}

/// The constants of a [`Message`] as a value: for programs that handle types by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TypeInfo {
    /// Value of [`Message::PACKAGE`].
    pub package: &'static str,
    /// Value of [`Message::NAME`].
    pub name: &'static str,
    /// Value of [`Message::TYPE`].
    pub type_name: &'static str,
    /// Value of [`Message::HASH`].
    pub hash: &'static str,
    /// Value of [`Message::FIELDS`].
    pub fields: &'static [FieldInfo],
    /// Value of [`Message::DEFINITION`].
    pub definition: &'static str,
}

impl TypeInfo {
    /// The information of the type `T`.
    pub const fn of<T: Message>() -> Self {
        Self {
            package: T::PACKAGE,
            name: T::NAME,
            type_name: T::TYPE,
            hash: T::HASH,
            fields: T::FIELDS,
            definition: T::DEFINITION,
        }
    }
}

/// A field in a type description, `type_description_interfaces/msg/FieldType` (REP-2016).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldInfo {
    /// Name of the field.
    pub name: &'static str,
    /// Number of its type: 1 for a message, 11 for `float64`, 17 for `string`, …; plus 48 for an array, 144 for a sequence.
    pub type_id: u8,
    /// Length of an array, else 0.
    pub capacity: u64,
    /// Full name of its type if that is a message, else empty.
    pub nested: &'static str,
}
