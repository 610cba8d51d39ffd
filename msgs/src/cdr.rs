//! Bytes on the wire: plain CDR (XCDR1) behind a 4-byte encapsulation header, alignment counted from byte 4.

use crate::message::Message;
use byteorder::{BigEndian, LittleEndian};

const LITTLE_ENDIAN: [u8; 2] = [0, 1];
const BIG_ENDIAN: [u8; 2] = [0, 0];
const HEADER: usize = 4;
/// RTPS pads a payload to four bytes.
const PADDING: usize = 3;

/// Why bytes are not a message.
#[derive(Debug, thiserror::Error)]
pub enum DecodeError {
    /// Not even a header.
    #[error("{type_name}: {length} bytes are too few for a CDR header of 4")]
    NoHeader {
        /// Type that was wanted.
        type_name: &'static str,
        /// Bytes there were.
        length: usize,
    },
    /// Not plain CDR.
    #[error(
        "{type_name}: encapsulation {found:02x?} is not plain CDR ([00, 01] little endian or [00, 00] big endian)"
    )]
    Encapsulation {
        /// Type that was wanted.
        type_name: &'static str,
        /// First two bytes.
        found: [u8; 2],
    },
    /// The bytes end within the message: cut off, or a length prefix that cannot be true, or another type.
    #[error("{type_name}: the {length} bytes end within the message (truncated, or another type)")]
    Truncated {
        /// Type that was wanted.
        type_name: &'static str,
        /// Bytes there were.
        length: usize,
    },
    /// A value that its type does not allow.
    #[error("{type_name}: {reason}")]
    Value {
        /// Type that was wanted.
        type_name: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Bytes after the message.
    #[error("{type_name}: {extra} bytes follow the message (at most 3 of padding may; another type?)")]
    Trailing {
        /// Type that was wanted.
        type_name: &'static str,
        /// How many.
        extra: usize,
    },
}

/// A message as CDR, little endian, with the encapsulation header `00 01 00 00`.
///
/// ```
/// use grainlab_msgs::{builtin_interfaces::Time, from_cdr, to_cdr};
/// let bytes = to_cdr(&Time { sec: 1, nanosec: 2 });
/// assert_eq!(bytes, [0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
/// assert_eq!(from_cdr::<Time>(&bytes).unwrap().nanosec, 2);
/// ```
pub fn to_cdr<T: Message>(message: &T) -> Vec<u8> {
    let mut bytes = vec![LITTLE_ENDIAN[0], LITTLE_ENDIAN[1], 0, 0];
    // The encoder counts alignment from where it starts, which is byte 4. It fails on sequences of unknown length and on
    // writers that fail; a generated type has none of the former and a vector never does the latter.
    cdr_encoding::to_writer::<T, LittleEndian, _>(&mut bytes, message)
        .unwrap_or_else(|e| unreachable!("{} always encodes: {e}", T::TYPE));
    bytes
}

/// The message that `bytes`, header included, hold. Never panics, and takes no length prefix at its word: memory is
/// reserved only as elements arrive.
pub fn from_cdr<T: Message>(bytes: &[u8]) -> Result<T, DecodeError> {
    let type_name = T::TYPE;
    let length = bytes.len();
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(DecodeError::NoHeader { type_name, length });
    };
    // Bytes 2 and 3 are options: some writers put the count of padding bytes there.
    let found = [header[0], header[1]];
    let decoded = match found {
        LITTLE_ENDIAN => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        BIG_ENDIAN => cdr_encoding::from_bytes::<T, BigEndian>(body),
        _ => return Err(DecodeError::Encapsulation { type_name, found }),
    };
    match decoded {
        Ok((message, used)) if body.len() - used <= PADDING => Ok(message),
        Ok((_, used)) => Err(DecodeError::Trailing { type_name, extra: body.len() - used }),
        Err(cdr_encoding::Error::Eof) => Err(DecodeError::Truncated { type_name, length }),
        Err(e) => Err(DecodeError::Value { type_name, reason: e.to_string() }),
    }
}
