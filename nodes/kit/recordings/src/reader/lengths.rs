//! Checks lengths within a record against the available bytes: `mcap::parse_record` allocates the stated
//! length of a text or a map before it reads it.

use std::collections::BTreeMap;

use mcap::records::op;

enum Part {
    Fixed(usize),
    /// A length of four bytes and that many bytes.
    Short,
    /// A length of eight bytes and that many bytes.
    Long,
    /// A length of four bytes and that many bytes of pairs of texts.
    Texts,
}

use Part::{Fixed, Long, Short, Texts};

fn layout(opcode: u8) -> &'static [Part] {
    match opcode {
        op::HEADER => &[Short, Short],
        op::FOOTER => &[Fixed(20)],
        op::SCHEMA => &[Fixed(2), Short, Short, Short],
        op::CHANNEL => &[Fixed(4), Short, Short, Texts],
        op::MESSAGE => &[Fixed(22)],
        op::CHUNK => &[Fixed(28), Short, Long],
        op::MESSAGE_INDEX => &[Fixed(2), Short],
        op::CHUNK_INDEX => &[Fixed(32), Short, Fixed(8), Short, Fixed(16)],
        op::ATTACHMENT => &[Fixed(16), Short, Short, Long, Fixed(4)],
        op::ATTACHMENT_INDEX => &[Fixed(40), Short, Short],
        op::STATISTICS => &[Fixed(42), Short],
        op::METADATA => &[Short, Texts],
        op::METADATA_INDEX => &[Fixed(16), Short],
        op::SUMMARY_OFFSET => &[Fixed(17)],
        op::DATA_END => &[Fixed(4)],
        _ => &[],
    }
}

/// True if all stated parts of the record lie within its body. More bytes may follow: the format lets later
/// versions append parts.
pub(super) fn fit(opcode: u8, body: &[u8]) -> bool {
    let mut rest = body;
    layout(opcode).iter().all(|part| take(&mut rest, part).is_some())
}

/// Returns the first key that a map of texts has twice, and the record with the last value of each key.
/// MCAP leaves open which value counts: the last one does here, as in the readers for Python and Go.
pub(super) fn repeated_key(opcode: u8, body: &[u8]) -> Option<(&[u8], Vec<u8>)> {
    let (mut rest, layout) = (body, layout(opcode));
    let map = layout.iter().position(|part| matches!(part, Texts))?;
    layout[..map].iter().try_for_each(|part| take(&mut rest, part))?;
    let before = &body[..body.len() - rest.len()];
    let (mut pairs, mut values, mut repeated) = (short(&mut rest)?, BTreeMap::new(), None);
    while !pairs.is_empty() {
        let (key, value) = (short(&mut pairs)?, short(&mut pairs)?);
        if values.insert(key, value).is_some() {
            repeated.get_or_insert(key);
        }
    }
    // The texts are parts of a record, which are shorter than its lengths allow.
    let with_length = |text: &[u8]| [&(text.len() as u32).to_le_bytes()[..], text].concat();
    let texts = values.into_iter().flat_map(|(key, value)| [key, value]);
    let pairs: Vec<u8> = texts.flat_map(with_length).collect();
    Some((repeated?, [before, &with_length(&pairs)].concat()))
}

fn take(rest: &mut &[u8], part: &Part) -> Option<()> {
    match part {
        Fixed(bytes) => *rest = rest.get(*bytes..)?,
        Short => {
            short(rest)?;
        }
        Long => {
            let (length, behind) = rest.split_first_chunk::<8>()?;
            *rest = behind.get(usize::try_from(u64::from_le_bytes(*length)).ok()?..)?;
        }
        Texts => {
            let mut pairs = short(rest)?;
            while !pairs.is_empty() {
                short(&mut pairs)?;
                short(&mut pairs)?;
            }
        }
    }
    Some(())
}

/// The bytes covered by a length of four bytes.
pub(super) fn short<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, behind) = rest.split_first_chunk::<4>()?;
    let (inside, behind) = behind.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    *rest = behind;
    Some(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(t: &str) -> Vec<u8> {
        [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat()
    }

    #[test]
    fn a_length_that_is_one_too_long_anywhere_in_a_metadata_record_is_noticed() {
        let pairs = [text("seed"), text("7")].concat();
        let body = [text("grainlab"), (pairs.len() as u32).to_le_bytes().to_vec(), pairs].concat();
        assert!(fit(op::METADATA, &body));
        for at in [0, 12, 16, 24] {
            for claim in [1, 1 << 30] {
                let mut wrong = body.clone();
                let length = u32::from_le_bytes(wrong[at..at + 4].try_into().unwrap()) + claim;
                wrong[at..at + 4].copy_from_slice(&length.to_le_bytes());
                assert!(!fit(op::METADATA, &wrong) || claim == 1 && at == 0, "{at} {claim}");
            }
        }
    }

    #[test]
    fn records_of_later_versions_may_be_longer_and_none_may_be_shorter() {
        assert!(fit(op::DATA_END, &[0; 4]) && fit(op::DATA_END, &[0; 9]) && !fit(op::DATA_END, &[0; 3]));
        assert!(fit(0x80, &[]), "a record that the format does not know is not looked into");
    }
}
