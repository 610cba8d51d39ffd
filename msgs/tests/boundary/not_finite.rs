//! Numbers that are not finite, in every field of every message.

use grainlab_msgs::boundary::BoundaryError;
use grainlab_msgs::{Message, from_cdr, to_cdr};
use std::fmt::Debug;

/// Each number of a valid message in turn becomes one that is not finite. It is refused, with the name of the field and the value in the
/// reason, except where the field is one of `unread` in this message.
pub(crate) fn refuses_non_finite<M: Message + Debug, T>(
    good: &M,
    unread: &[&str],
    convert: impl Fn(&M) -> Result<T, BoundaryError>,
) {
    let (bytes, plain) = (to_cdr(good), format!("{good:#?}"));
    let mut found = 0;
    // After the header of the encapsulation numbers are aligned.
    for at in (4..bytes.len() - 7).step_by(8) {
        for value in [f64::NAN, f64::INFINITY] {
            let mut spoilt = bytes.clone();
            spoilt[at..at + 8].copy_from_slice(&value.to_le_bytes());
            let Ok(message) = from_cdr::<M>(&spoilt) else { continue };
            let text = format!("{message:#?}");
            let changed: Vec<&str> =
                text.lines().zip(plain.lines()).filter(|(new, old)| new != old).map(|(new, _)| new).collect();
            let [line] = changed[..] else { continue };
            let (name, shown) =
                line.trim().trim_end_matches(',').split_once(": ").unwrap_or(("", line.trim()));
            if shown.trim_end_matches(',') != format!("{value:?}") || unread.contains(&name) {
                continue;
            }
            found += 1;
            let Err(reason) = convert(&message) else { panic!("{name} = {value} is accepted") };
            let reason = reason.to_string();
            // The components of a vector and of a symmetry have no name of their own.
            let is_named = reason.contains(name)
                || ["x", "y", "z"].contains(&name)
                || reason.contains("symmetry.moduli[");
            assert!(is_named && reason.contains(&format!("{value:?}")), "{name} = {value}: {reason}");
        }
    }
    assert!(found > 2, "the message has numbers");
}
