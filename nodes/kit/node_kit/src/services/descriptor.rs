//! Descriptions of parameters, as `describe_parameters` returns them.

use crate::parameters::{ParameterSpec, Range};
use ros2_client::ParameterValue;
use ros2_client::parameters::raw::{FloatingPointRange, IntegerRange, ParameterDescriptor};

/// The description of a declared parameter. A range that is not an interval stands in `additional_constraints`.
pub(super) fn descriptor(spec: &ParameterSpec) -> ParameterDescriptor {
    let range = match spec.range {
        Range::Any => None,
        range => Some(range.to_string()),
    };
    let fixed = spec.read_only.then(|| FIXED.to_owned());
    let mut told = ParameterDescriptor {
        r#type: ParameterValue::to_parameter_type_raw(&spec.default),
        description: spec.description.into(),
        additional_constraints: range.into_iter().chain(fixed).collect::<Vec<_>>().join("; "),
        read_only: spec.read_only,
        ..unknown(spec.name)
    };
    match spec.range {
        Range::Any | Range::Positive | Range::Choice(_) => {}
        Range::Integer { min, max } => {
            told.integer_range.push(IntegerRange { from_value: min, to_value: max, step: 0 });
        }
        Range::Double { min, max } => {
            told.floating_point_range.push(FloatingPointRange { from_value: min, to_value: max, step: 0.0 });
        }
    }
    told
}

/// The description of a name that the node does not declare: of no type.
pub(super) fn unknown(name: &str) -> ParameterDescriptor {
    ParameterDescriptor {
        name: name.into(),
        r#type: ParameterValue::to_parameter_type_raw(&ParameterValue::NotSet),
        description: String::new(),
        additional_constraints: String::new(),
        read_only: false,
        dynamic_typing: false,
        floating_point_range: Vec::new(),
        integer_range: Vec::new(),
    }
}

pub(super) const FIXED: &str =
    "read-only: what a run computes and records follows from the values at its start; start the node with -p";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_has_type_unit_range_and_the_reason_why_it_is_fixed() {
        let spec = ParameterSpec::new("lag", 10_i64, "requests ahead, 1")
            .within(Range::Integer { min: 0, max: 100 });
        let told = descriptor(&spec);
        assert_eq!((told.r#type, told.read_only, told.description.as_str()), (2, true, "requests ahead, 1"));
        assert_eq!((told.integer_range[0].from_value, told.integer_range[0].to_value), (0, 100));
        assert!(told.additional_constraints.contains("0 to 100"), "{}", told.additional_constraints);
        assert!(told.additional_constraints.contains("read-only"), "{}", told.additional_constraints);
        let free =
            descriptor(&ParameterSpec::new("wait", 0.1, "time, s").within(Range::Positive).changeable());
        assert!(!free.read_only && free.additional_constraints == "greater than 0 and finite");
    }
}
