//! The conversion at the boundary: valid data are unchanged in both directions, invalid data are refused by
//! name.

mod estimates;
mod lockstep;
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
