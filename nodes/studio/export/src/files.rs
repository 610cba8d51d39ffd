//! The files of one packing, or of a run, by format.

use crate::lammps_dump::{UNITS, lammps_dump, lammps_local};
use crate::{csv, extended_xyz, lammps_data, sidecar, vtp};
use clap::ValueEnum;
use grainlab_core::Packing;

/// A format of other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// CSV with a JSON sidecar, two files per packing
    Csv,
    /// LAMMPS dumps of grains and contacts, one frame per packing
    #[value(name = "lammps")]
    LammpsDump,
    /// LAMMPS data files, one per packing
    LammpsData,
    /// Extended XYZ, one frame per packing
    Xyz,
    /// VTK XML: grains and contacts of each packing, and a collection of all
    Vtk,
}

/// A part of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FilePart {
    /// Name of the file.
    pub name: String,
    /// Text that follows in it.
    pub content: String,
}

/// Writes the packings of a run one after the other.
#[derive(Debug)]
pub struct Exporter {
    format: ExportFormat,
    /// Time, s, and files of each packing so far.
    states: Vec<(f64, Vec<String>)>,
}

impl Exporter {
    /// Nothing is written yet.
    pub fn new(format: ExportFormat) -> Self {
        Self { format, states: Vec::new() }
    }

    /// True if the format has no place for resistance to rolling.
    pub fn loses_rolling(&self) -> bool {
        matches!(self.format, ExportFormat::LammpsDump | ExportFormat::LammpsData)
    }

    /// Parts that the next packing adds. Parts of the same name are parts of one file.
    pub fn next(&mut self, packing: &Packing) -> Vec<FilePart> {
        let n = self.states.len() + 1;
        let part = |name: String, content: String| FilePart { name, content };
        let parts = match self.format {
            ExportFormat::Csv => vec![
                part(format!("packing_{n}.csv"), csv(packing)),
                part(format!("packing_{n}.json"), sidecar(packing)),
            ],
            ExportFormat::LammpsDump => vec![
                part(
                    "packings.dump".into(),
                    if n == 1 { UNITS } else { "" }.to_owned() + &lammps_dump(packing),
                ),
                part("contacts.dump".into(), lammps_local(packing)),
            ],
            ExportFormat::LammpsData => vec![part(format!("packing_{n}.data"), lammps_data(packing))],
            ExportFormat::Xyz => vec![part("packings.xyz".into(), extended_xyz(packing))],
            ExportFormat::Vtk => vec![
                part(format!("grains_{n}.vtp"), vtp::grains(packing)),
                part(format!("contacts_{n}.vtp"), vtp::contacts(packing)),
            ],
        };
        self.states.push((packing.time, parts.iter().map(|p| p.name.clone()).collect()));
        parts
    }

    /// Parts that follow the last packing.
    pub fn finish(&self) -> Vec<FilePart> {
        if self.format != ExportFormat::Vtk {
            return Vec::new();
        }
        let collection = |name: &str, k: usize| {
            let states = self.states.iter().map(|(time, files)| (*time, files[k].as_str()));
            FilePart { name: name.to_owned(), content: vtp::pvd(states) }
        };
        vec![collection("grains.pvd", 0), collection("contacts.pvd", 1)]
    }
}
