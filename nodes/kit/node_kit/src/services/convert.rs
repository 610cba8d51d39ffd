//! Values of parameters between this crate and ros2-client.

use crate::parameters::ParameterValue as Ours;
use ros2_client::ParameterValue as Theirs;

/// The value as ros2-client has it.
pub(super) fn to_ros(value: &Ours) -> Theirs {
    match value.clone() {
        Ours::Bool(v) => Theirs::Boolean(v),
        Ours::Integer(v) => Theirs::Integer(v),
        Ours::Double(v) => Theirs::Double(v),
        Ours::String(v) => Theirs::String(v),
        Ours::BoolArray(v) => Theirs::BooleanArray(v),
        Ours::IntegerArray(v) => Theirs::IntegerArray(v),
        Ours::DoubleArray(v) => Theirs::DoubleArray(v),
        Ours::StringArray(v) => Theirs::StringArray(v),
    }
}

/// The value as this crate has it; `None` for a deletion and for byte arrays, which no node declares.
pub(super) fn from_ros(value: &Theirs) -> Option<Ours> {
    Some(match value.clone() {
        Theirs::Boolean(v) => Ours::Bool(v),
        Theirs::Integer(v) => Ours::Integer(v),
        Theirs::Double(v) => Ours::Double(v),
        Theirs::String(v) => Ours::String(v),
        Theirs::BooleanArray(v) => Ours::BoolArray(v),
        Theirs::IntegerArray(v) => Ours::IntegerArray(v),
        Theirs::DoubleArray(v) => Ours::DoubleArray(v),
        Theirs::StringArray(v) => Ours::StringArray(v),
        Theirs::NotSet | Theirs::ByteArray(_) => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_of_value_comes_back_unchanged() {
        for value in [
            Ours::Bool(true),
            Ours::Integer(-3),
            Ours::Double(0.25),
            Ours::String("demo".into()),
            Ours::BoolArray(vec![true, false]),
            Ours::IntegerArray(vec![1, 2]),
            Ours::DoubleArray(vec![0.1]),
            Ours::StringArray(vec!["a".into()]),
        ] {
            assert_eq!(from_ros(&to_ros(&value)), Some(value));
        }
        assert_eq!(from_ros(&Theirs::NotSet), None);
    }
}
