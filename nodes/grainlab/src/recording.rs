//! Packings from recordings and from files of other programs.

use crate::{Error, State};
use grainlab_recordings::import::{self, ImportOptions};
use grainlab_recordings::{Messages, Selection};
use std::path::Path;

fn file(error: impl std::fmt::Display) -> Error {
    Error::File(error.to_string())
}

/// A recording: an MCAP file, or the directory of a run.
#[derive(Debug)]
pub struct Recording(grainlab_recordings::Recording);

/// Opens a recording.
///
/// # Errors
/// If it cannot be read. A damaged recording is opened.
pub fn open(path: impl AsRef<Path>) -> Result<Recording, Error> {
    grainlab_recordings::Recording::open(path.as_ref()).map(Recording).map_err(file)
}

impl Recording {
    /// Parts that could not be read, so far as it was read.
    pub fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    /// The packings of the topic `packing`, in the order of their recording.
    ///
    /// # Errors
    /// If the recording cannot be read. An invalid packing is an error of its own item; damage, by which packings may be
    /// missing, is one of the last item.
    pub fn packings(&self) -> Result<impl Iterator<Item = Result<State, Error>> + '_, Error> {
        let selection = Selection { topics: Some(vec!["packing".to_owned()]), ..Selection::default() };
        let messages: Messages = self.0.messages(&selection).map_err(file)?;
        let packings = messages.map(|message| Ok(import::recording::packing(&message).map_err(file)?.into()));
        let damage = || {
            let found = self.warnings().join("; ");
            (!found.is_empty()).then(|| Err(file(format!("packings may be missing: {found}"))))
        };
        Ok(packings.chain(std::iter::once_with(damage).flatten()))
    }
}

/// Packings of a file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The packings, at least one, in order.
    pub packings: Vec<State>,
    /// Parts of a recording that could not be read: packings may be missing if this is not empty.
    pub warnings: Vec<String>,
}

/// The packings of a file by LAMMPS, YADE, ASE, ParaView or another program, or of a recording.
///
/// # Errors
/// If the file is not a packing, contradicts itself, or lacks what `options` could give, such as the material.
pub fn load(path: impl AsRef<Path>, options: &ImportOptions) -> Result<Loaded, Error> {
    let found = import::load(path.as_ref(), options).map_err(file)?;
    let warnings = found.warnings.iter().map(ToString::to_string).collect();
    Ok(Loaded { packings: found.packings.into_iter().map(State::from).collect(), warnings })
}
