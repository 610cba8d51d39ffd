//! External files: regular files of bounded size.
//!
//! A device may be endless, a pipe may block, and a few bytes of gzip may decompress to gigabytes: none of
//! them may exhaust the memory or block a command.
//!
//! What was opened here is remembered, so that no output of the same command replaces it.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, ErrorKind, Read, Stdin};
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use flate2::bufread::GzDecoder;

/// Maximum size of scenes, launch files, parameters and calibrations, bytes.
pub const SETTINGS: u64 = 1 << 20;

/// Maximum size of tables and packings as text, bytes, decompressed.
pub const TEXT: u64 = 4 << 30;

/// First bytes of gzip.
pub const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Maximum compression ratio of a text. Numbers compress to a third, zeros to a thousandth.
const RATIO: u64 = 64;

/// Decompressed size that is always accepted, bytes.
const SMALL: u64 = 16 << 20;

/// Paths of the files that this process has opened, by device and inode: a file may have several names.
static OPENED: Mutex<BTreeMap<[u64; 2], PathBuf>> = Mutex::new(BTreeMap::new());

fn identity(file: &Metadata) -> [u64; 2] {
    [file.dev(), file.ino()]
}

fn remember(path: &Path, file: &Metadata) {
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    opened.insert(identity(file), path.to_owned());
}

/// Returns the path by which this process has read the file at `path`, under whatever name; `None` if it has not read the file.
pub(crate) fn read_as(path: &Path) -> Option<PathBuf> {
    let wanted = identity(&fs::metadata(path).ok()?);
    let opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    let input = opened.get(&wanted)?;
    // The inode of an input that was removed since may be given to a new file.
    fs::metadata(input).is_ok_and(|there| identity(&there) == wanted).then(|| input.clone())
}

/// Returns the standard input, which is remembered as an input where a shell has opened a file for it.
pub fn standard() -> Stdin {
    let path = Path::new("/dev/stdin");
    if let Some(file) = fs::metadata(path).ok().filter(Metadata::is_file) {
        remember(path, &file);
    }
    io::stdin()
}

/// Opens a regular file; returns its size (bytes), too.
///
/// # Errors
/// If it cannot be opened, or is a directory, a pipe or a device: those are refused before they are opened.
pub fn open(path: &Path) -> io::Result<(File, u64)> {
    let metadata = fs::metadata(path)?;
    let kind = metadata.file_type();
    let what = if kind.is_file() {
        remember(path, &metadata);
        return Ok((File::open(path)?, metadata.len()));
    } else if kind.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "it is a directory, not a file"));
    } else if kind.is_fifo() {
        "a pipe"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    };
    let problem = format!("it is {what}, not a file: write its content to a file first");
    Err(io::Error::new(ErrorKind::InvalidInput, problem))
}

/// The content of a regular file of at most `most` bytes.
///
/// # Errors
/// As [`open`], or if it is larger.
pub fn bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let (file, size) = open(path)?;
    let too_large = || {
        let problem = format!("it has more than {most} bytes, the maximum for such files");
        io::Error::new(ErrorKind::FileTooLarge, problem)
    };
    if size > most {
        return Err(too_large());
    }
    let mut content = Vec::with_capacity(size as usize);
    // The stated size may be wrong, for example in /proc.
    file.take(most + 1).read_to_end(&mut content)?;
    if content.len() as u64 > most { Err(too_large()) } else { Ok(content) }
}

/// The text of a regular file of at most `most` bytes.
///
/// # Errors
/// As [`bytes`], or if it is not UTF-8.
pub fn text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(bytes(path, most)?).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        io::Error::new(ErrorKind::InvalidData, format!("it is not text: byte {at} is not UTF-8"))
    })
}

/// Decompresses gzip: at most 64 times the compressed size, or 16 MiB if that is more.
///
/// # Errors
/// If it is truncated, damaged, followed by other bytes, or decompresses to more.
pub fn gunzip(compressed: &[u8]) -> io::Result<Vec<u8>> {
    let most = (compressed.len() as u64).saturating_mul(RATIO).clamp(SMALL, TEXT);
    let (mut content, mut rest) = (Vec::new(), compressed);
    // A file may have several members, one after the other.
    loop {
        let mut member = GzDecoder::new(rest);
        let room = most + 1 - content.len() as u64;
        member.by_ref().take(room).read_to_end(&mut content).map_err(|e| match e.kind() {
            ErrorKind::UnexpectedEof => {
                let problem = format!(
                    "the compressed file is cut off after {} bytes of text: copy it again",
                    content.len()
                );
                io::Error::new(e.kind(), problem)
            }
            kind => io::Error::new(kind, format!("the compressed file is damaged: {e}")),
        })?;
        rest = member.into_inner();
        if rest.is_empty() || content.len() as u64 > most {
            break;
        }
        if !rest.starts_with(&MAGIC) {
            let problem = format!(
                "its compressed text ends at byte {} and {} other bytes follow: copy it again, or cut them off",
                compressed.len() - rest.len(),
                rest.len()
            );
            return Err(io::Error::new(ErrorKind::InvalidData, problem));
        }
    }
    if content.len() as u64 > most {
        let problem = format!(
            "its {} compressed bytes decompress to more than {most} bytes, the maximum for a table: unpack it first",
            compressed.len()
        );
        return Err(io::Error::new(ErrorKind::FileTooLarge, problem));
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    #[test]
    fn devices_pipes_and_directories_are_refused_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for (path, word) in
            [(Path::new("/dev/zero"), "device"), (folder.path(), "directory"), (&pipe, "pipe")]
        {
            let error = text(path, SETTINGS).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }

    #[test]
    fn a_file_is_read_up_to_the_limit_and_not_beyond() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "twelve bytes").unwrap();
        assert_eq!(text(&path, 12).unwrap(), "twelve bytes");
        assert_eq!(text(&path, 11).unwrap_err().kind(), ErrorKind::FileTooLarge);
        // The system reports size 0 for these.
        assert_eq!(bytes(Path::new("/proc/self/maps"), 10).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    #[test]
    fn a_few_bytes_are_not_decompressed_to_a_gigabyte() {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        let zeros = vec![b'0'; 1 << 20];
        (0..64).for_each(|_| encoder.write_all(&zeros).unwrap());
        let compressed = encoder.finish().unwrap();
        let error = gunzip(&compressed).unwrap_err().to_string();
        assert!(error.contains("compressed bytes"), "{error}");
        assert!(gunzip(&compressed[..compressed.len() / 9]).unwrap_err().to_string().contains("cut off"));
    }

    #[test]
    fn members_of_gzip_are_one_text_and_other_bytes_after_them_are_refused() {
        let member = |text: &[u8]| {
            let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(text).unwrap();
            encoder.finish().unwrap()
        };
        let whole = [member(b""), member(b"one "), member(b"two")].concat();
        assert_eq!(gunzip(&whole).unwrap(), b"one two");
        for more in [&b"\0"[..], b"an HTML page"] {
            let error = gunzip(&[&whole, more].concat()).unwrap_err().to_string();
            let place = format!("ends at byte {} and {} other bytes follow", whole.len(), more.len());
            assert!(error.contains(&place), "{error}");
        }
    }
}
