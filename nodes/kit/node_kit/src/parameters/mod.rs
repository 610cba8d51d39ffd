//! Parameters: declared by each node, set from the command line and from YAML files, checked before anything starts.

mod file;
mod set;
mod spec;
mod value;
mod yaml;

pub use set::Parameters;
pub(crate) use set::coerce;
pub use spec::{ParameterSpec, Range};
pub use value::{FromParameter, IntoParameter, ParameterError, ParameterValue, parameter_text};
pub use yaml::parse_value;
