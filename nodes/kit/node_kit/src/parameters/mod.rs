//! Parameters: declared by each node, set from the command line and from YAML files, checked before anything starts.

mod file;
mod set;
mod spec;
mod value;
mod yaml;

pub(crate) use set::coerce;
pub use set::{ParameterError, Parameters};
pub use spec::{ParameterSpec, Range};
pub use value::{FromParameter, IntoParameter, ParameterValue, parameter_text};
pub use yaml::parse_value;
