//! The trust boundary: what is good crosses it unchanged both ways, what is not is refused by name.

mod estimates;
mod lockstep;
mod packing;
mod results;
mod structure;
mod wave_speeds;
mod waveform;

use grainlab_msgs::boundary::BoundaryError;

/// A message, a fault put into it, and how the refusal must begin.
type Fault<M> = (fn(&mut M), &'static str);

/// Each fault, put into a good message, is refused with the text given.
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
