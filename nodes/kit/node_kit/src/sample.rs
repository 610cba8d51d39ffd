//! Samples and where they come from.

use grainlab_msgs::Guid;

/// One received sample, undecoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The serialized message with its 4-byte encapsulation header.
    pub body: Vec<u8>,
    /// Writer, sequence number and times.
    pub info: SampleInfo,
}

/// Writer, sequence number and times of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleInfo {
    /// Writer of the sample.
    pub writer: Guid,
    /// RTPS sequence number: 1, 2, 3, … for each writer; a missing number is a lost sample.
    pub sequence: i64,
    /// Source time of the writer, ns since 1970, if given.
    pub source_time: Option<u64>,
    /// Time of arrival in this process, ns since 1970.
    pub received: u64,
    /// The sample it refers to, if given: the request of an answer, the packing of a
    /// result. It is sent next to the body, as DDS-RPC relates a reply to its request.
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
    /// Writer of the sample.
    pub writer: Guid,
    /// RTPS sequence number of the sample.
    pub sequence: i64,
}
