//! Files that are written whole or not at all.

use crate::failure::Failure;
use crate::input;
use std::ffi::OsString;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::os::fd::AsRawFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// Writes the file that a user named: under a temporary name in the same folder, which is then renamed. A pipe or a device is written
/// directly; a link stays a link.
///
/// # Errors
/// Returns wrong usage for a file that this process has read, and an error if the file cannot be written. An existing file is then
/// unchanged, and the temporary file is removed.
pub fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, content).map_err(Failure::at(path));
    }
    refuse_input(path)?;
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    replace(&target, content.as_ref(), |_| Ok(())).map_err(Failure::at(path))
}

/// Refuses an output in the place of an input: a file that this process has read, under this name or another one.
///
/// # Errors
/// Wrong usage, which names the output and the input.
pub fn refuse_input(output: &Path) -> Result<(), Failure> {
    let Some(input) = input::read_as(output) else { return Ok(()) };
    let name = if input == output { String::new() } else { format!(" (as {})", input.display()) };
    Err(Failure::usage(format!(
        "{}: the command reads this file{name}, and would replace it by its output: name another output",
        output.display()
    )))
}

/// Writes a file of a directory that grainlab keeps, such as a run. It is synced to the device under a temporary name, and renamed.
///
/// A link in the place of either name is replaced, never followed: whoever put the link there cannot choose the file that is written.
///
/// # Errors
/// Returns an error if the file cannot be written. An existing file is then unchanged, and the temporary file is removed.
pub fn replace_whole(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    replace(path, content.as_ref(), File::sync_all)
}

fn replace(path: &Path, content: &[u8], sync: impl FnOnce(&File) -> io::Result<()>) -> io::Result<()> {
    let partial = partial(path);
    match std::fs::remove_file(&partial) {
        // A killed process left it.
        Ok(()) => {}
        Err(e) if e.kind() == io::ErrorKind::NotFound => {}
        Err(e) => return Err(e),
    }
    // Fails if anything has the name, links included (O_EXCL).
    let mut file = File::create_new(&partial)?;
    let written =
        file.write_all(content).and_then(|()| sync(&file)).and_then(|()| std::fs::rename(&partial, path));
    written.inspect_err(|_| {
        let _ = std::fs::remove_file(&partial);
    })
}

/// Opens a file of a directory that grainlab keeps, and creates the file if there is none. What is written is appended.
///
/// # Errors
/// Returns an error if the file cannot be opened, is a link, or is no regular file.
pub fn append_to(path: &Path) -> io::Result<File> {
    let no_file = || refused("it is a pipe, a device or a directory, not a file: remove it");
    let mut options = OpenOptions::new();
    // Opening a pipe without a reader would wait for one.
    let opened =
        options.create(true).append(true).custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK).open(path);
    let file = opened.map_err(|e| match e.raw_os_error() {
        Some(libc::ENXIO | libc::EISDIR) => no_file(),
        _ => unless_link(path, e),
    })?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(no_file()) }
}

/// Opens a file in a folder that grainlab keeps below a directory, such as the logs of a run, and creates what does not exist. What is
/// written is appended.
///
/// # Errors
/// Returns an error, which names the path, if the file cannot be opened, or the folder or the file is a link.
pub fn append_in(folder: &Path, name: &str) -> io::Result<File> {
    let named = |path: &Path, e: io::Error| io::Error::new(e.kind(), format!("{}: {e}", path.display()));
    std::fs::create_dir_all(folder).map_err(|e| named(folder, e))?;
    let flags = libc::O_DIRECTORY | libc::O_NOFOLLOW;
    let opened = OpenOptions::new().read(true).custom_flags(flags).open(folder);
    let opened = opened.map_err(|e| named(folder, unless_link(folder, e)))?;
    // The folder that was opened, whatever has its name by now.
    let inside = Path::new("/proc/self/fd").join(opened.as_raw_fd().to_string());
    append_to(&inside.join(name)).map_err(|e| named(&folder.join(name), e))
}

/// The error of an open that does not follow links.
fn unless_link(path: &Path, error: io::Error) -> io::Error {
    let is_link = matches!(error.raw_os_error(), Some(libc::ELOOP | libc::ENOTDIR)) && path.is_symlink();
    if is_link { refused("it is a link, which is not followed here: remove it") } else { error }
}

fn refused(problem: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem)
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

/// Returns the temporary name of a file, `.x.csv.grainlab-part` of `x.csv`: a name that no user gives to a file.
fn partial(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".grainlab-part");
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

    #[cfg(unix)]
    #[test]
    fn no_link_in_a_directory_of_grainlab_leads_a_write_elsewhere() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let precious = || std::fs::read_to_string(path("precious")).unwrap();
        std::fs::write(path("precious"), "old").unwrap();
        for link in ["summary.json", ".summary.json.grainlab-part", ".page.html.grainlab-part", "servo.log"] {
            symlink(path("precious"), path(link)).unwrap();
        }
        replace_whole(&path("summary.json"), "new").unwrap();
        write_whole(&path("page.html"), "new").unwrap();
        assert!(append_to(&path("servo.log")).unwrap_err().to_string().contains("it is a link"));
        std::fs::create_dir(path("elsewhere")).unwrap();
        symlink(path("elsewhere"), path("logs")).unwrap();
        let refused = |folder: &Path, link: &str| {
            let error = append_in(folder, "servo.log").unwrap_err().to_string();
            assert!(error.starts_with(&format!("{}: it is a link", path(link).display())), "{error}");
        };
        refused(&path("logs"), "logs");
        refused(folder.path(), "servo.log");
        assert_eq!(std::fs::read_dir(path("elsewhere")).unwrap().count(), 0);
        append_in(&path("run/logs"), "servo.log").unwrap().write_all(b"said").unwrap();
        assert_eq!(std::fs::read_to_string(path("run/logs/servo.log")).unwrap(), "said");
        assert_eq!(precious(), "old");
        for written in ["summary.json", "page.html"] {
            assert!(!path(written).is_symlink(), "{written}");
            assert_eq!(std::fs::read_to_string(path(written)).unwrap(), "new");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_in_the_place_of_a_file_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("servo.log");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        // With a reader, the pipe could be opened.
        for reader in [None, Some(OpenOptions::new().read(true).write(true).open(&pipe).unwrap())] {
            let error = append_to(&pipe).unwrap_err().to_string();
            assert!(error.contains("it is a pipe"), "{error}");
            drop(reader);
        }
    }

    #[test]
    fn a_temporary_file_that_a_killed_process_left_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(".x.csv.grainlab-part"), "ha").unwrap();
        write_whole(&folder.path().join("x.csv"), "whole").unwrap();
        assert_eq!(std::fs::read_to_string(folder.path().join("x.csv")).unwrap(), "whole");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn no_output_replaces_an_input_whatever_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let [table, link, other] = ["h.csv", "link.csv", "other.csv"].map(path);
        for file in [&table, &other] {
            std::fs::write(file, "measured").unwrap();
        }
        std::os::unix::fs::symlink(&table, &link).unwrap();
        std::fs::hard_link(&table, path("hard.csv")).unwrap();
        input::text(&table, input::SETTINGS).unwrap();
        for output in [table.clone(), link, path("hard.csv"), folder.path().join(".").join("h.csv")] {
            let refused = write_whole(&output, "draws").unwrap_err();
            assert_eq!(refused.exit, grainlab_msgs::Exit::Usage);
            assert!(refused.to_string().starts_with(&output.display().to_string()), "{refused}");
            assert!(refused.to_string().contains("the command reads this file"), "{refused}");
        }
        assert_eq!(std::fs::read_to_string(&table).unwrap(), "measured");
        write_whole(&other, "new").unwrap();
        // An input that was removed is no longer there to be replaced.
        std::fs::remove_file(&table).unwrap();
        write_whole(&table, "new").unwrap();
    }

    #[test]
    fn a_file_of_the_user_is_not_taken_for_a_temporary_one() {
        let folder = tempfile::tempdir().unwrap();
        let download = folder.path().join("x.csv.part");
        std::fs::write(&download, "half of a download").unwrap();
        write_whole(&folder.path().join("x.csv"), "new").unwrap();
        assert_eq!(std::fs::read_to_string(&download).unwrap(), "half of a download");
    }

    #[test]
    fn a_file_that_cannot_be_written_stays_as_it_was_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("x.csv");
        std::fs::write(&file, "old").unwrap();
        // A folder in the place of the temporary file.
        std::fs::create_dir(folder.path().join(".x.csv.grainlab-part")).unwrap();
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
        let error = write_whole(Path::new("/dev/full"), "some bytes").unwrap_err().to_string();
        assert!(error.contains("No space left"), "{error}");
        assert!(Path::new("/dev/full").exists() && !Path::new("/dev/.full.grainlab-part").exists());
    }
}
