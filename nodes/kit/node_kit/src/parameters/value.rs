//! Values of parameters, which are those of ros2-client. No node declares an array of bytes.

pub use ros2_client::ParameterValue;

/// Why a parameter or a parameter file is refused. The process then ends with [`crate::Exit::Usage`].
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ParameterError(pub(super) String);

pub(crate) fn type_name(value: &ParameterValue) -> &'static str {
    match value {
        ParameterValue::NotSet => "nothing",
        ParameterValue::Boolean(_) => "bool",
        ParameterValue::Integer(_) => "integer",
        ParameterValue::Double(_) => "double",
        ParameterValue::String(_) => "string",
        ParameterValue::ByteArray(_) => "byte array",
        ParameterValue::BooleanArray(_) => "bool array",
        ParameterValue::IntegerArray(_) => "integer array",
        ParameterValue::DoubleArray(_) => "double array",
        ParameterValue::StringArray(_) => "string array",
    }
}

/// A Rust type that a parameter is declared by.
pub trait IntoParameter {
    /// Converts it to a value.
    fn into_parameter(self) -> ParameterValue;
}

/// A Rust type that a parameter can be read as.
pub trait FromParameter: Sized {
    /// The value, if it is of this type.
    fn from_parameter(value: &ParameterValue) -> Option<Self>;
}

impl IntoParameter for &str {
    fn into_parameter(self) -> ParameterValue {
        ParameterValue::String(self.into())
    }
}

macro_rules! parameter_types {
    ($($variant:ident => $type:ty),* $(,)?) => {
        $(
            impl IntoParameter for $type {
                fn into_parameter(self) -> ParameterValue {
                    ParameterValue::$variant(self)
                }
            }

            impl FromParameter for $type {
                fn from_parameter(value: &ParameterValue) -> Option<Self> {
                    if let ParameterValue::$variant(v) = value { Some(v.clone()) } else { None }
                }
            }
        )*

        /// A value as text; texts are in quotes.
        pub fn parameter_text(value: &ParameterValue) -> String {
            match value {
                $(ParameterValue::$variant(v) => format!("{v:?}"),)*
                other => format!("{other:?}"),
            }
        }
    };
}

parameter_types! {
    Boolean => bool,
    Integer => i64,
    Double => f64,
    String => String,
    BooleanArray => Vec<bool>,
    IntegerArray => Vec<i64>,
    DoubleArray => Vec<f64>,
    StringArray => Vec<String>,
}
