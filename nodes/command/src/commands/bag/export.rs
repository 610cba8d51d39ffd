//! `grainlab bag export`.

use crate::commands::packings::import as import_flags;
use clap::ValueEnum;
use grainlab_console::{Failure, print, say, worse};
use grainlab_core::{Packing, StrainOrigin};
use grainlab_export::{ExportFormat, Exporter, FilePart};
use grainlab_node_kit::Exit;
use grainlab_recordings::import::{self, ImportError, Imported};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  grainlab bag export recordings/runs/s2-1-1 --format vtk --out paraview      # open grains.pvd and contacts.pvd
  grainlab bag export run.mcap --format csv --out tables
  grainlab bag export packing.data --contact-forces forces.dump --shear-modulus 29e9 --poisson 0.2 --friction 0.3 \
      --format csv --out tables

Writes every packing of a recording, or of a file of any format that `grainlab analyze` reads, in SI units:
  csv          packing_1.csv with grains and contacts, packing_1.json with cell and material, ...: no loss
  lammps       packings.dump and contacts.dump, one frame per packing
  lammps-data  packing_1.data, ...: grains
  xyz          packings.xyz, extended XYZ, one frame per packing: grains
  vtk          grains_1.vtp and contacts_1.vtp, ..., and the collections grains.pvd and contacts.pvd
`grainlab analyze` reads csv, lammps, lammps-data and xyz back. In vtk, contacts are lines between centres, with their forces. In files for LAMMPS, ids count from 1: those of the packing, or one more if it has an id 0. A strain since the first step of
a run, in which no phase has set a reference state, is left out. Data that PATH lacks are given as to
`grainlab analyze`. Existing files are not overwritten. Exit 3 if a part of the recording could not be read, 4 if grains overlap by more
than a tenth of a diameter.";

/// Arguments of `grainlab bag export`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Run directory, MCAP file, or a file of any format that `grainlab analyze` reads
    #[arg(value_name = "PATH")]
    path: PathBuf,
    /// Folder of the new files, made if it does not exist
    #[arg(long, short, alias = "output", value_name = "DIR")]
    out: PathBuf,
    /// Format of the new files
    #[arg(long, value_enum)]
    format: ExportFormat,
    #[command(flatten)]
    import: import_flags::Args,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    std::fs::create_dir_all(&args.out).map_err(Failure::at(&args.out))?;
    let options = args.import.options()?;
    let mut writer = Writer::new(args.format, &args.path, &args.out);
    let (mut failure, mut exit) = (None, Exit::Done);
    let warnings = import::each(&args.path, &options, &mut |imported| match writer.write(&imported) {
        Ok(notes) => {
            // The notes have the fault.
            exit = worse(exit, imported.exit());
            notes.iter().for_each(|note| say!("grainlab: {note}"));
            ControlFlow::Continue(())
        }
        Err(error) => {
            failure = Some(error);
            ControlFlow::Break(())
        }
    })
    .map_err(ImportError::failure)?;
    if let Some(failure) = failure.or_else(|| writer.finish().err()) {
        writer.remove();
        return Err(failure);
    }
    print(&format!(
        "{} written to {}\n",
        grainlab_console::count(writer.packings, "packing"),
        args.out.display()
    ))?;
    warnings.iter().for_each(|w| say!("grainlab: {w}"));
    Ok(worse(exit, if warnings.is_empty() { Exit::Done } else { Exit::DataLoss }))
}

/// Writes packings in a format of the command into a folder, made if it does not exist; notes on them.
///
/// # Errors
/// A format that does not exist, and files that exist or cannot be written; then none is left.
pub fn export(format: &str, folder: &Path, packings: &[&Imported]) -> Result<Vec<String>, Failure> {
    let format = ExportFormat::from_str(format, false).map_err(|_| {
        let known = ExportFormat::value_variants().iter().filter_map(ValueEnum::to_possible_value);
        let known: Vec<String> = known.map(|value| value.get_name().to_owned()).collect();
        Failure::usage(format!("no format {format:?}; there are: {}", known.join(", ")))
    })?;
    std::fs::create_dir_all(folder).map_err(Failure::at(folder))?;
    let mut writer = Writer::new(format, Path::new("packing"), folder);
    let written: Result<Vec<_>, _> = packings.iter().map(|packing| writer.write(packing)).collect();
    let written = written.and_then(|notes| writer.finish().map(|()| notes.concat()));
    written.inspect_err(|_| writer.remove())
}

struct Writer<'a> {
    exporter: Exporter,
    path: &'a Path,
    folder: &'a Path,
    packings: u64,
    /// The files made so far, which further parts extend.
    made: BTreeSet<String>,
    /// True once the strain of a packing was left out, and a line has said so.
    strain_is_left_out: bool,
}

/// The packing without a strain since the first step of its run: in a file it would be that since a reference state.
fn referred(imported: &Imported) -> Cow<'_, Packing> {
    let packing = &imported.packing;
    match &packing.path {
        Some(path) if path.strain_origin != StrainOrigin::Reference => {
            Cow::Owned(Packing { deformation: Packing::no_reference(), ..packing.clone() })
        }
        _ => Cow::Borrowed(packing),
    }
}

impl<'a> Writer<'a> {
    fn new(format: ExportFormat, path: &'a Path, folder: &'a Path) -> Self {
        let exporter = Exporter::new(format);
        Self { exporter, path, folder, packings: 0, made: BTreeSet::new(), strain_is_left_out: false }
    }

    fn write(&mut self, imported: &Imported) -> Result<Vec<String>, Failure> {
        let source = self.path.display();
        let mut notes: Vec<String> = imported.notes.iter().map(|note| format!("{source}: {note}")).collect();
        if self.packings == 0 && imported.packing.law.rolling.is_some() && self.exporter.loses_rolling() {
            notes.push(format!(
                "{source}: contacts resist rolling, and files for LAMMPS have neither this law nor its forces"
            ));
        }
        let packing = referred(imported);
        if !self.strain_is_left_out && matches!(packing, Cow::Owned(_)) {
            self.strain_is_left_out = true;
            notes.push(format!(
                "{source}, from step {}: the strain is left out: no phase of the run has set a reference state",
                imported.step
            ));
        }
        let parts = self.exporter.next(&packing);
        self.packings += 1;
        parts.iter().try_for_each(|part| self.append(part)).map(|()| notes)
    }

    fn finish(&mut self) -> Result<(), Failure> {
        self.exporter.finish().iter().try_for_each(|part| self.append(part))
    }

    fn append(&mut self, part: &FilePart) -> Result<(), Failure> {
        let path = self.folder.join(&part.name);
        let failed = |e: std::io::Error| Failure::failed(format!("{}: {e}", path.display()));
        let mut file = if self.made.contains(&part.name) {
            File::options().append(true).open(&path).map_err(failed)?
        } else {
            let file = File::create_new(&path).map_err(failed)?;
            self.made.insert(part.name.clone());
            file
        };
        file.write_all(part.content.as_bytes()).map_err(failed)
    }

    /// Removes what was written: part of an export cannot be told from the whole, and would keep it from being repeated.
    fn remove(&self) {
        for name in &self.made {
            let _ = std::fs::remove_file(self.folder.join(name));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_export::lammps_dump;
    use grainlab_recordings::import::{ImportOptions, load};

    const SIDECAR: &str = r#"{"G": 29e9, "nu": 0.2, "density": 2500, "mu_prep": 0.3, "box_L": [1, 1, 1]}"#;
    const GRAINS: &str = "p,1,0.1,0.1,0.1,0.11,0,0,0,0,0,0,0\np,2,0.1,0.1,0.3,0.11,0,0,0,0,0,0,0\n";

    fn args(path: PathBuf, out: PathBuf, format: ExportFormat) -> Args {
        let import = import_flags::Args::default();
        Args { path, out, format: format.to_owned(), import }
    }

    #[test]
    fn an_exported_packing_is_read_back_without_loss_and_no_file_is_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.csv");
        std::fs::write(&path, GRAINS).unwrap();
        std::fs::write(folder.path().join("two.json"), SIDECAR).unwrap();
        let packing = load(&path, &ImportOptions::default()).unwrap().packings.remove(0).packing;
        let out = folder.path().join("out");
        assert_eq!(run(&args(path.clone(), out.clone(), ExportFormat::Csv)).unwrap(), Exit::Done);
        let back = load(&out.join("packing_1.csv"), &ImportOptions::default()).unwrap();
        assert_eq!(back.packings[0].packing, packing);
        assert_eq!(run(&args(path.clone(), out.clone(), ExportFormat::LammpsDump)).unwrap(), Exit::Done);
        let dump = std::fs::read_to_string(out.join("packings.dump")).unwrap();
        assert_eq!(dump, format!("ITEM: UNITS\nsi\n{}", lammps_dump(&packing)));
        assert!(
            run(&args(path, out, ExportFormat::LammpsDump))
                .unwrap_err()
                .to_string()
                .contains("packings.dump")
        );
    }

    #[test]
    fn a_strain_that_counts_from_no_reference_state_is_not_exported() {
        let text = "base = 'demo'\nname = 'few'\ngrains.count = 20";
        let scene = grainlab_scene::Scene::parse(text).unwrap();
        let run = grainlab_experiment::Simulation::new(scene).unwrap();
        let packing = run.packing().unwrap();
        let imported = |path| Imported {
            header: grainlab_msgs::boundary::packing_header(&packing),
            packing: Packing { path, ..packing.clone() },
            step: 0,
            run_state: Vec::new(),
            source: String::new(),
            rounding: None,
            notes: Vec::new(),
        };
        assert!(packing.strain().is_some());
        assert_eq!(referred(&imported(packing.path.clone())).strain(), None);
        // A file without a run states what its strain counts from.
        assert_eq!(referred(&imported(None)).strain(), packing.strain());
    }

    #[test]
    fn an_export_that_fails_leaves_the_files_of_others_and_none_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.csv");
        std::fs::write(&path, GRAINS).unwrap();
        std::fs::write(folder.path().join("two.json"), SIDECAR).unwrap();
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        // The second file of the export is there already.
        std::fs::write(out.join("packing_1.json"), "of another").unwrap();
        let error = run(&args(path, out.clone(), ExportFormat::Csv)).unwrap_err();
        assert!(error.to_string().contains("packing_1.json"), "{error}");
        let left: Vec<_> = std::fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name()).collect();
        assert_eq!(left, ["packing_1.json"]);
        assert_eq!(std::fs::read_to_string(out.join("packing_1.json")).unwrap(), "of another");
    }
}
