//! The end of a recording, and what follows it in its file.

use mcap::MAGIC;
use mcap::records::{Footer, Record, op};

use super::records::{FRAME, Records};

/// Bytes of the body of a footer.
const FOOTER: usize = 20;

/// Returns the footer and its position, if the file is complete.
pub(super) fn footer(bytes: &[u8]) -> Result<(Footer, usize), String> {
    let at = bytes
        .strip_suffix(MAGIC)
        .and_then(|b| b.len().checked_sub(FRAME + FOOTER))
        .ok_or("the end magic is missing")?;
    match Records::at(bytes, at as u64).map(|r| (r.opcode, r.parse())) {
        Some((op::FOOTER, Ok(Record::Footer(footer)))) => Ok((footer, at)),
        _ => Err("there is no footer before the end magic".into()),
    }
}

/// Returns the byte at which the summary begins, or the footer if there is no summary; 0 if the file is incomplete.
pub(super) fn summary(bytes: &[u8]) -> usize {
    match footer(bytes) {
        Ok((Footer { summary_start: 0, .. }, at)) => at,
        Ok((footer, at)) => usize::try_from(footer.summary_start).map_or(at, |start| start.min(at)),
        Err(_) => 0,
    }
}

/// Returns the length of the recording at the beginning of `bytes` by its frames alone, if other bytes follow its end.
pub(super) fn length_of_first(bytes: &[u8]) -> Option<usize> {
    let mut ended = false;
    let footer = Records::new(bytes, MAGIC.len()).map_while(Result::ok).find(|record| {
        ended |= record.opcode == op::DATA_END;
        ended && record.opcode == op::FOOTER && record.body.len() == FOOTER
    })?;
    let rest = &bytes[footer.end()..];
    let length = footer.end() + if rest.starts_with(MAGIC) { MAGIC.len() } else { 0 };
    // The end magic of a damaged file may be altered or cut off.
    (rest.len() > MAGIC.len()).then_some(length)
}

/// Describes the bytes of a file from byte `at` on, which follow the end of its recording.
pub(super) fn following(bytes: &[u8], at: usize) -> String {
    if bytes[at..].starts_with(MAGIC) {
        return format!(
            "another recording begins here, behind the end of the first one, and is not read: split the file, the first {at} \
             bytes by `head -c {at}` and the others by `tail -c +{}`",
            at + 1
        );
    }
    format!(
        "{} follow the end of the recording and are not read",
        grainlab_console::count(bytes.len() - at, "byte")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_two_recordings_ends_where_the_other_begins() {
        let mut writer = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
        writer.finish().unwrap();
        let one = writer.into_inner().into_inner();
        assert_eq!(length_of_first(&one), None);
        assert_eq!(length_of_first(&one[..one.len() - 1]), None, "cut off");
        let two = [&one[..], &one].concat();
        assert_eq!(length_of_first(&two), Some(one.len()));
        assert!(following(&two, one.len()).contains(&format!("`tail -c +{}`", one.len() + 1)));
        let more = [&one[..], &[0; 2]].concat();
        assert_eq!(length_of_first(&more), Some(one.len()));
        assert_eq!(following(&more, one.len()), "2 bytes follow the end of the recording and are not read");
    }
}
