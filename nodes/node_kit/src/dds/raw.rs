//! Adapter that passes samples through RustDDS as bytes, without decoding or encoding.

use rustdds::RepresentationIdentifier;
use rustdds::bytes::Bytes;
use rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter};
use std::convert::Infallible;

/// Bytes of the encapsulation header: representation identifier and options.
pub(super) const HEADER: usize = 4;
/// Plain CDR, little endian: the only representation we write.
pub(super) const CDR_LE: [u8; 2] = [0, 1];

/// A received sample: header and payload.
pub(super) struct RawBody(pub(super) Vec<u8>);

/// A sample to send: the payload behind the header.
pub(super) struct RawPayload(pub(super) Bytes);

/// The adapter between RustDDS and bytes.
pub(super) struct RawAdapter;

/// Restores the header that RustDDS removed, so that a body has all bytes of the sample.
#[derive(Clone)]
pub(super) struct KeepBytes;

impl<'de> Decode<'de, RawBody> for KeepBytes {
    type Error = Infallible;

    fn decode_bytes(
        self,
        payload: &'de [u8],
        encoding: RepresentationIdentifier,
    ) -> Result<RawBody, Infallible> {
        let representation =
            ENCODINGS.iter().position(|known| *known == encoding).map_or(CDR_LE, |i| IDENTIFIERS[i]);
        let mut body = Vec::with_capacity(HEADER + payload.len());
        body.extend_from_slice(&representation);
        body.extend_from_slice(&[0, 0]);
        body.extend_from_slice(payload);
        Ok(RawBody(body))
    }
}

/// Representations taken as they are, and their identifiers on the wire; RustDDS hides the bytes of its constants.
static ENCODINGS: [RepresentationIdentifier; 4] = [
    RepresentationIdentifier::CDR_LE,
    RepresentationIdentifier::CDR_BE,
    RepresentationIdentifier::PL_CDR_LE,
    RepresentationIdentifier::PL_CDR_BE,
];
const IDENTIFIERS: [[u8; 2]; 4] = [CDR_LE, [0, 0], [0, 3], [0, 2]];

impl DeserializerAdapter<RawBody> for RawAdapter {
    type Error = Infallible;
    type Decoded = RawBody;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &ENCODINGS
    }

    fn transform_decoded(decoded: RawBody) -> RawBody {
        decoded
    }
}

impl DefaultDecoder<RawBody> for RawAdapter {
    type Decoder = KeepBytes;
    const DECODER: KeepBytes = KeepBytes;
}

impl SerializerAdapter<RawPayload> for RawAdapter {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(value: &RawPayload) -> Result<Bytes, Infallible> {
        Ok(value.0.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_comes_back_with_the_header_it_travelled_with() {
        for (encoding, header) in [
            (RepresentationIdentifier::CDR_LE, [0, 1, 0, 0]),
            (RepresentationIdentifier::CDR_BE, [0, 0, 0, 0]),
        ] {
            let Ok(body) = KeepBytes.decode_bytes(&[7, 8], encoding);
            assert_eq!(body.0[..4], header);
            assert_eq!(body.0[4..], [7, 8]);
        }
    }
}
