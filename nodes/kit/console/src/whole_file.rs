//! Files that are written whole or not at all.

use crate::failure::Failure;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

/// Writes a file under a temporary name beside it, and renames it. What is no file, such as a pipe or a device, is written to as it
/// is; a link stays one.
///
/// # Errors
/// If it cannot be written: an existing file is then unchanged, and the temporary one is removed.
pub fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, content);
    }
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let partial = partial(&target);
    let written = std::fs::write(&partial, content).and_then(|()| std::fs::rename(&partial, &target));
    written.inspect_err(|_| {
        let _ = std::fs::remove_file(&partial);
    })
}

/// Refuses a name that does not end as its format does, `extension` in small letters. A pipe or a device may have any name.
///
/// # Errors
/// Wrong usage, which names the flag and the path.
pub fn has_name_of(flag: &str, path: &Path, extension: &str) -> Result<(), Failure> {
    let is_other = path.metadata().is_ok_and(|found| !found.is_file());
    let fits = is_other || path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    let fault = || format!("{flag} {}: the file is {extension}: name it .{extension}", path.display());
    fits.then_some(()).ok_or_else(|| Failure::usage(fault()))
}

/// `x.csv.part` of `x.csv`.
fn partial(path: &Path) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, ToOwned::to_owned);
    name.push(".part");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_its_file_gets_the_content() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["page.html", "link.html"].map(|name| folder.path().join(name));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, "new").unwrap();
        assert!(link.is_symlink() && std::fs::read_to_string(&file).unwrap() == "new");
    }

    #[test]
    fn a_file_that_cannot_be_written_stays_as_it_was_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("x.csv");
        std::fs::write(&file, "old").unwrap();
        // A folder in the place of the temporary file.
        std::fs::create_dir(folder.path().join("x.csv.part")).unwrap();
        assert!(write_whole(&file, "new").is_err());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "old");
        assert!(write_whole(&folder.path().join("nowhere/x.csv"), "new").is_err());
        assert!(write_whole(folder.path(), "new").is_err(), "a folder cannot be replaced");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_name_of_another_format_is_refused_and_a_device_has_any_name() {
        let of = |path: &str| has_name_of("-o", Path::new(path), "html").map_err(|e| e.to_string());
        assert_eq!(of("a.pdf"), Err("-o a.pdf: the file is html: name it .html".to_owned()));
        assert!(of("html").is_err() && of("a.HTML").is_ok() && of("/dev/null").is_ok());
    }

    /// Every write to it fails, as on a full disk.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_to_as_it_is_and_its_error_is_told() {
        let error = write_whole(Path::new("/dev/full"), "some bytes").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(Path::new("/dev/full").exists() && !Path::new("/dev/full.part").exists());
    }
}
