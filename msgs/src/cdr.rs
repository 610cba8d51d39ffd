//! Serialization: plain CDR (XCDR1) after a 4-byte encapsulation header, with alignment counted from byte 4.

use crate::decode_error::DecodeError;
use crate::message::Message;
use byteorder::{BigEndian, LittleEndian};

const LITTLE_ENDIAN: [u8; 2] = [0, 1];
const BIG_ENDIAN: [u8; 2] = [0, 0];
const HEADER: usize = 4;
/// Bytes that most messages fit into, so that their vector does not grow.
const USUAL: usize = 512;
/// RTPS pads a payload to four bytes.
const PADDING: usize = 3;

/// A message as CDR, little endian, with the encapsulation header `00 01 00 00`.
///
/// ```
/// use grainlab_msgs::{builtin_interfaces::Time, from_cdr, to_cdr};
/// let bytes = to_cdr(&Time { sec: 1, nanosec: 2 });
/// assert_eq!(bytes, [0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
/// assert_eq!(from_cdr::<Time>(&bytes).unwrap().nanosec, 2);
/// ```
pub fn to_cdr<T: Message>(message: &T) -> Vec<u8> {
    message.encoded()
}

/// Encodes a message. Each type calls this in an `impl` of its own: compiled in this crate, for speed, and once.
pub(crate) fn encode<T: Message>(message: &T) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(USUAL);
    bytes.extend([LITTLE_ENDIAN[0], LITTLE_ENDIAN[1], 0, 0]);
    // The encoder counts alignment from its start, which is byte 4. It fails on sequences of unknown length
    // and on writers that fail; generated types have no such sequences and a vector never fails.
    cdr_encoding::to_writer::<T, LittleEndian, _>(&mut bytes, message)
        .unwrap_or_else(|e| unreachable!("{} always encodes: {e}", T::TYPE));
    bytes
}

/// Decodes a message from `bytes` including the header. Never panics, and does not trust length prefixes:
/// memory is reserved only as elements arrive.
pub fn from_cdr<T: Message>(bytes: &[u8]) -> Result<T, DecodeError> {
    T::decoded(bytes)
}

pub(crate) fn decode<T: Message>(bytes: &[u8]) -> Result<T, DecodeError> {
    let fault = |problem: String| DecodeError { type_name: T::TYPE, problem };
    let length = bytes.len();
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(fault(format!("{length} bytes are too few for a CDR header of 4")));
    };
    // Bytes 2 and 3 are options: some writers store the number of padding bytes there.
    let found = [header[0], header[1]];
    let decoded = match found {
        LITTLE_ENDIAN => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        BIG_ENDIAN => cdr_encoding::from_bytes::<T, BigEndian>(body),
        _ => {
            let plain = "[00, 01] little endian or [00, 00] big endian";
            return Err(fault(format!("encapsulation {found:02x?} is not plain CDR ({plain})")));
        }
    };
    match decoded {
        Ok((message, used)) if body.len() - used <= PADDING => Ok(message),
        Ok((_, used)) => Err(fault(format!(
            "{} bytes follow the message (at most 3 of padding may; another type?)",
            body.len() - used
        ))),
        Err(cdr_encoding::Error::Eof) => {
            Err(fault(format!("the {length} bytes end within the message (truncated, or another type)")))
        }
        Err(e) => Err(fault(e.to_string())),
    }
}
