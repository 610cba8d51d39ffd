//! The list of message types.

use crate::generated::TYPES;
use crate::message::TypeInfo;

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
