//! Values of parameters as text, YAML and JSON.

use grainlab_console::Failure;
use grainlab_node_kit::{ParameterValue, parse_value};
use serde_json::{Value, json};

/// A value from a command line, as YAML: `0.5`, `true`, `[1, 2]`, `text`.
pub(super) fn parse(text: &str) -> Result<ParameterValue, Failure> {
    parse_value(text).map_err(|reason| Failure::usage(format!("value {text:?}: {reason}")))
}

/// As JSON; numbers that are not finite become text.
pub(super) fn to_json(value: &ParameterValue) -> Value {
    let number = |v: &f64| if v.is_finite() { json!(v) } else { json!(v.to_string()) };
    match value {
        ParameterValue::NotSet => Value::Null,
        ParameterValue::Boolean(v) => json!(v),
        ParameterValue::Integer(v) => json!(v),
        ParameterValue::Double(v) => number(v),
        ParameterValue::String(v) => json!(v),
        ParameterValue::ByteArray(v) => json!(v),
        ParameterValue::BooleanArray(v) => json!(v),
        ParameterValue::IntegerArray(v) => json!(v),
        ParameterValue::DoubleArray(v) => Value::Array(v.iter().map(number).collect()),
        ParameterValue::StringArray(v) => json!(v),
    }
}

/// As a value of a parameter file. Doubles have a point and the sign of an exponent: YAML 1.1 reads `1e-7` and `1.0e7` as texts.
pub(super) fn to_yaml(value: &ParameterValue) -> String {
    let number = |v: &f64| match v {
        v if v.is_nan() => ".nan".to_owned(),
        v if v.is_infinite() => if *v > 0.0 { ".inf" } else { "-.inf" }.to_owned(),
        v => match format!("{v:?}").split_once('e') {
            None => format!("{v:?}"),
            Some((digits, exponent)) => {
                let point = if digits.contains('.') { "" } else { ".0" };
                let sign = if exponent.starts_with('-') { "" } else { "+" };
                format!("{digits}{point}e{sign}{exponent}")
            }
        },
    };
    match value {
        ParameterValue::Double(v) => number(v),
        ParameterValue::DoubleArray(v) => {
            format!("[{}]", v.iter().map(number).collect::<Vec<_>>().join(", "))
        }
        // Text and lists of JSON are YAML, too.
        other => to_json(other).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_survive_a_parameter_file() {
        for value in [
            ParameterValue::Boolean(true),
            ParameterValue::Integer(-3),
            ParameterValue::Double(2.0),
            ParameterValue::Double(f64::INFINITY),
            ParameterValue::String("no: \"true\"".into()),
            ParameterValue::String("true".into()),
            ParameterValue::DoubleArray(vec![1.0, 0.5]),
            ParameterValue::StringArray(vec!["a".into()]),
        ] {
            assert_eq!(parse(&to_yaml(&value)).unwrap(), value, "{}", to_yaml(&value));
        }
    }

    #[test]
    fn doubles_with_an_exponent_are_numbers_for_yaml_1_1_too() {
        let texts = [
            (1e-7, "1.0e-7"),
            (-2.5e-9, "-2.5e-9"),
            (1e22, "1.0e+22"),
            (0.5, "0.5"),
            (7e10, "70000000000.0"),
        ];
        for (number, text) in texts {
            let value = ParameterValue::Double(number);
            assert_eq!((to_yaml(&value).as_str(), parse(text).unwrap()), (text, value));
        }
    }
}
