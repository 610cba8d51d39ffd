//! The conversion at the boundary: valid data are unchanged in both directions, invalid data are refused by
//! name.

mod estimates;
mod lockstep;
mod not_finite;
mod packing;
mod results;
mod structure;
mod wave_speeds;
mod waveform;

use grainlab_msgs::boundary::BoundaryError;

/// A valid message, a change that makes it invalid, and the start of the error.
type Fault<M> = (fn(&mut M), &'static str);

/// Each change of a valid message is refused with the given text.
fn refuses<M: Clone, T>(good: &M, faults: &[Fault<M>], convert: impl Fn(&M) -> Result<T, BoundaryError>) {
    assert!(convert(good).is_ok(), "the message to be spoilt is good");
    for (fault, text) in faults {
        let mut message = good.clone();
        fault(&mut message);
        match convert(&message) {
            Ok(_) => panic!("accepted, but {text} was expected"),
            Err(e) => assert!(e.to_string().starts_with(text), "{e}\n is not: {text}"),
        }
    }
}

/// Each of these values of a field of a valid message is refused, with the path of the field and the value in the reason.
macro_rules! refuses_values {
    ($good:expr, $convert:expr, $type:literal, $message:ident: $($field:expr => $value:expr),+ $(,)?) => {
        $({
            let field = stringify!($field).trim_start_matches(concat!(stringify!($message), "."));
            let text = format!(concat!($type, ".{} = {:?} is refused"), field, $value);
            $crate::refuses_value($good, |$message| $field = $value, &text, $convert);
        })+
    };
}
pub(crate) use refuses_values;

/// A message with this fault is refused. A reason leaves out the index of the only value of an optional field.
fn refuses_value<M: Clone, T>(
    good: &M,
    fault: fn(&mut M),
    text: &str,
    convert: impl Fn(&M) -> Result<T, BoundaryError>,
) {
    let mut message = good.clone();
    fault(&mut message);
    let error = convert(&message).err().unwrap_or_else(|| panic!("accepted, but {text} was expected"));
    let plain = |text: &str| text.replace("[0]", "");
    assert!(plain(&error.to_string()).starts_with(&plain(text)), "{error}\n is not: {text}");
}
