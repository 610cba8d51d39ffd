//! Errors of parameters.

use std::path::PathBuf;

/// Errors of parameters. The process then ends with [`crate::Exit::Usage`].
#[derive(Debug, thiserror::Error)]
pub enum ParameterError {
    /// A name that the node does not declare.
    #[error("{origin}: node {node} has no parameter {name:?}; it has: {known}")]
    Unknown {
        /// Where it was set: the command line or a file.
        origin: String,
        /// The node's name.
        node: String,
        /// The unknown name.
        name: String,
        /// What is declared, comma separated.
        known: String,
    },
    /// A value of the wrong type.
    #[error("{origin}: parameter {name:?} is of type {expected}, but {value} is of type {found}{hint}")]
    Type {
        /// Where it was set.
        origin: String,
        /// The parameter.
        name: String,
        /// The declared type.
        expected: &'static str,
        /// The type found.
        found: &'static str,
        /// The value found.
        value: String,
        /// How to correct it, if not obvious.
        hint: &'static str,
    },
    /// A value outside the declared range.
    #[error("{origin}: parameter {name:?} = {value} is out of range: {range}")]
    OutOfRange {
        /// Where it was set.
        origin: String,
        /// The parameter.
        name: String,
        /// The value found.
        value: String,
        /// The allowed range in words.
        range: String,
    },
    /// `-p other:name:=value` for a node that is not this one.
    #[error(
        "-p {prefix}:{name}: this process runs node {node}, so the value would be ignored; remove the prefix or correct it"
    )]
    OtherNode {
        /// The prefix given.
        prefix: String,
        /// The parameter.
        name: String,
        /// This node.
        node: String,
    },
    /// No key of a parameter file is for this node.
    #[error("{}: no key is for node {node}, so the file would be ignored; its keys: {keys}", path.display())]
    NoMatchingKey {
        /// The file.
        path: PathBuf,
        /// This node, fully qualified.
        node: String,
        /// The keys the file has.
        keys: String,
    },
    /// A parameter file without the structure of ROS 2.
    #[error("{}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error and its place.
        reason: String,
    },
    /// The text is not YAML, or the YAML is not a parameter value.
    #[error("{origin}: parameter {name:?}: {reason}")]
    Value {
        /// Where it was set.
        origin: String,
        /// The parameter.
        name: String,
        /// The error.
        reason: String,
    },
}
