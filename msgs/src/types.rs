//! The message types, which the build writes from the message files (`generator/main.rs`), and the list of them.

use crate::message::TypeInfo;

include!(concat!(env!("OUT_DIR"), "/types.rs"));

impl TypeInfo {
    /// The type with this full ROS name, if it is a type of this project or a standard one in use.
    ///
    /// ```
    /// let clock = grainlab_msgs::TypeInfo::by_name("rosgraph_msgs/msg/Clock").unwrap();
    /// assert!(clock.hash.starts_with("RIHS01_692f7a66"));
    /// ```
    pub fn by_name(type_name: &str) -> Option<&'static Self> {
        Self::all().iter().find(|t| t.type_name == type_name)
    }

    /// Every known type, sorted by name.
    pub const fn all() -> &'static [Self] {
        TYPES
    }
}
