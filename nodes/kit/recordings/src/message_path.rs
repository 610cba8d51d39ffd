//! `--msg-path` of commands.

use crate::definitions::Definitions;
use crate::reader::Recording;
use grainlab_console::{Failure, say};
use std::path::{Path, PathBuf};

/// Folders with message files on the command line.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct MessagePath {
    /// Folder with message files, package/msg/Type.msg; may be repeated
    #[arg(long, value_name = "DIR")]
    msg_path: Vec<PathBuf>,
}

impl MessagePath {
    /// True if a folder is given.
    pub fn is_given(&self) -> bool {
        !self.msg_path.is_empty()
    }

    /// The definitions in the folders, and those of this program.
    ///
    /// # Errors
    /// If a folder does not exist.
    pub fn definitions(&self) -> Result<Definitions, Failure> {
        if let Some(folder) = self.msg_path.iter().find(|folder| !folder.is_dir()) {
            return Err(Failure::usage(format!("--msg-path {}: there is no such folder", folder.display())));
        }
        Ok(Definitions::with_folders(&self.msg_path))
    }

    /// Opens a recording, and gives topics without a definition those found here, which it says; returns their names, too.
    ///
    /// # Errors
    /// If a folder does not exist, or the recording cannot be read.
    pub fn open(&self, path: &Path) -> Result<(Recording, Vec<String>), Failure> {
        let definitions = self.definitions()?;
        let mut recording = Recording::open(path).map_err(Failure::failed)?;
        let defined = recording.define(&definitions);
        for (topic, type_name) in &defined {
            let from = definitions.place(type_name);
            say!("grainlab: {topic}: the recording has no definition of {type_name}; {from} is used");
        }
        Ok((recording, defined.into_iter().map(|(topic, _)| topic).collect()))
    }
}
