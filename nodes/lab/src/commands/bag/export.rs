//! `grainlab bag export`.

use clap::ValueEnum;
use grainlab_console::Failure;
use grainlab_console::{print, say};
use grainlab_node_kit::Exit;
use grainlab_recordings::export::{csv, lammps_dump, sidecar};
use grainlab_recordings::import::{self, ImportOptions, Imported};
use std::fs::File;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  grainlab bag export recordings/runs/s2-1-1 --format lammps --out dumps
  grainlab bag export run.mcap --format csv --out tables

Writes every packing of the recording, in SI units. lammps: one file, packings.dump, with one frame per packing (grains
only), which OVITO opens. csv: packing_1.csv with grains and contacts and packing_1.json with cell and material, and so on;
`grainlab analyze` reads them back without loss. Existing files are not overwritten. Exit 3 if a part of the recording
could not be read.";

/// Arguments of `grainlab bag export`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    /// Folder of the new files, made if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Format of the new files
    #[arg(long, value_enum)]
    format: Format,
    /// Topic of the packings [default: packing]
    #[arg(long, value_name = "NAME")]
    topic: Option<String>,
}

/// File formats of packings.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// CSV with a JSON sidecar, two files per packing
    Csv,
    /// LAMMPS dump, one frame per packing
    Lammps,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    std::fs::create_dir_all(&args.out)
        .map_err(|e| Failure::failed(format!("{}: {e}", args.out.display())))?;
    let options = ImportOptions { topic: args.topic.clone(), ..ImportOptions::default() };
    let mut writer = Writer { format: args.format, folder: &args.out, packings: 0, dump: None };
    let mut failure = None;
    let warnings = import::each(&args.path, &options, &mut |imported| match writer.write(&imported) {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => {
            failure = Some(error);
            ControlFlow::Break(())
        }
    })
    .map_err(Failure::failed)?;
    if let Some(failure) = failure {
        return Err(failure);
    }
    print(&format!(
        "{} written to {}\n",
        grainlab_console::count(writer.packings, "packing"),
        args.out.display()
    ))?;
    warnings.iter().for_each(|w| say!("grainlab: {w}"));
    Ok(if warnings.is_empty() { Exit::Done } else { Exit::DataLoss })
}

/// Writes packings into a folder.
struct Writer<'a> {
    format: Format,
    folder: &'a Path,
    packings: u64,
    dump: Option<File>,
}

impl Writer<'_> {
    fn write(&mut self, imported: &Imported) -> Result<(), Failure> {
        self.packings += 1;
        let packing = &imported.packing;
        match self.format {
            Format::Csv => {
                let name = format!("packing_{}", self.packings);
                self.create(&format!("{name}.csv"), &csv(packing))?;
                self.create(&format!("{name}.json"), &sidecar(packing)).map(drop)
            }
            Format::Lammps => {
                let name = "packings.dump";
                let frame = lammps_dump(packing).map_err(Failure::failed)?;
                match &mut self.dump {
                    None => self.dump = Some(self.create(name, &frame)?),
                    Some(file) => file.write_all(frame.as_bytes()).map_err(|e| self.error(name, &e))?,
                }
                Ok(())
            }
        }
    }

    fn create(&self, name: &str, content: &str) -> Result<File, Failure> {
        let written = File::create_new(self.folder.join(name)).and_then(|mut file| {
            file.write_all(content.as_bytes())?;
            Ok(file)
        });
        written.map_err(|e| self.error(name, &e))
    }

    fn error(&self, name: &str, error: &std::io::Error) -> Failure {
        Failure::failed(format!("{}: {error}", self.folder.join(name).display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_recordings::import::load;

    const SIDECAR: &str = r#"{"G": 29e9, "nu": 0.2, "density": 2500, "mu_prep": 0.3, "box_L": [1, 1, 1]}"#;
    const GRAINS: &str = "p,1,0.1,0.1,0.1,0.11,0,0,0,0,0,0,0\np,2,0.1,0.1,0.3,0.11,0,0,0,0,0,0,0\n";

    fn args(path: PathBuf, out: PathBuf, format: Format) -> Args {
        Args { path, out, format, topic: None }
    }

    #[test]
    fn an_exported_packing_is_read_back_without_loss_and_no_file_is_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.csv");
        std::fs::write(&path, GRAINS).unwrap();
        std::fs::write(folder.path().join("two.json"), SIDECAR).unwrap();
        let packing = load(&path, &ImportOptions::default()).unwrap().packings.remove(0).packing;
        let out = folder.path().join("out");
        assert_eq!(run(&args(path.clone(), out.clone(), Format::Csv)).unwrap(), Exit::Done);
        let back = load(&out.join("packing_1.csv"), &ImportOptions::default()).unwrap();
        assert_eq!(back.packings[0].packing, packing);
        assert_eq!(run(&args(path.clone(), out.clone(), Format::Lammps)).unwrap(), Exit::Done);
        let dump = std::fs::read_to_string(out.join("packings.dump")).unwrap();
        assert_eq!(dump, lammps_dump(&packing).unwrap());
        assert!(run(&args(path, out, Format::Lammps)).unwrap_err().to_string().contains("packings.dump"));
    }
}
