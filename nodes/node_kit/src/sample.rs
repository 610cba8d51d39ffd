//! Samples and their writers.

use std::fmt;
use std::str::FromStr;

/// The 16-byte RTPS GUID of one writer: 12 bytes of participant, 4 of entity. Unique among all processes.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WriterId(pub [u8; 16]);

impl WriterId {
    /// Stands for every writer of a participant: its entity is zero.
    pub fn of_participant(participant: [u8; 12]) -> Self {
        let mut id = [0; 16];
        id[..12].copy_from_slice(&participant);
        Self(id)
    }

    /// The GUID prefix: the 12 bytes that all endpoints of one process share.
    pub fn participant(&self) -> [u8; 12] {
        let mut prefix = [0; 12];
        prefix.copy_from_slice(&self.0[..12]);
        prefix
    }
}

/// 32 hexadecimal digits.
impl fmt::Display for WriterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for WriterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "WriterId({self})")
    }
}

/// The text is not a writer id.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a writer id: 32 hexadecimal digits")]
pub struct WriterIdError(pub String);

impl FromStr for WriterId {
    type Err = WriterIdError;

    fn from_str(text: &str) -> Result<Self, WriterIdError> {
        let error = || WriterIdError(text.into());
        if text.len() != 32 || !text.is_ascii() {
            return Err(error());
        }
        let mut bytes = [0; 16];
        for (i, byte) in bytes.iter_mut().enumerate() {
            *byte = u8::from_str_radix(&text[2 * i..2 * i + 2], 16).map_err(|_| error())?;
        }
        Ok(WriterId(bytes))
    }
}

/// One received sample, undecoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The serialized message with its 4-byte encapsulation header.
    pub body: Vec<u8>,
    /// Its writer, sequence number and times.
    pub info: SampleInfo,
}

/// Writer, sequence number and times of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleInfo {
    /// The writer.
    pub writer: WriterId,
    /// RTPS sequence number: 1, 2, 3, … for each writer; a missing number is a lost sample.
    pub sequence: i64,
    /// Source time of the writer, ns since 1970, if given.
    pub source_time: Option<u64>,
    /// Time of arrival in this process, ns since 1970.
    pub received: u64,
    /// The sample it refers to, if given: the request of an answer, the packing of a
    /// result. It is sent beside the body, as DDS-RPC relates a reply to its request.
    pub about: Option<SampleId>,
}

impl SampleInfo {
    /// The identity of this sample, for samples that refer to it.
    pub fn id(&self) -> SampleId {
        SampleId { writer: self.writer, sequence: self.sequence }
    }

    /// The sample that a result computed from this one refers to: the one this sample refers to, or else this one.
    pub fn origin(&self) -> SampleId {
        self.about.unwrap_or_else(|| self.id())
    }
}

/// One sample of one writer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SampleId {
    /// The writer.
    pub writer: WriterId,
    /// Its RTPS sequence number.
    pub sequence: i64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writer_ids_read_back_from_their_hexadecimal_form() {
        let id = WriterId(std::array::from_fn(|i| (i * 17) as u8));
        assert_eq!(id.to_string(), "00112233445566778899aabbccddeeff");
        assert_eq!(id.to_string().parse(), Ok(id));
        for bad in ["", "0011", "zz112233445566778899aabbccddeeff", "é0112233445566778899aabbccddeef"] {
            assert!(bad.parse::<WriterId>().is_err(), "{bad}");
        }
    }
}
