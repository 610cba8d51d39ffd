//! LAMMPS data files of `atom_style sphere`, as written by `write_data`.
//!
//! It reads the box, `Atoms` (id, type, diameter, density, x, y, z; image flags are ignored) and
//! `Velocities` (id, v, ω), in SI units. Contacts are found from positions, unless a `dump local` with their forces is given
//! ([`ImportOptions::contact_forces`]). The format does not state boundaries: they are taken as periodic, with a note.

use std::collections::{BTreeMap, BTreeSet};

use grainlab_core::{Mat3, Vec3};

use super::assemble::{GrainTable, Moment};
use super::error::ImportError;
use super::imported::Imported;
use super::lammps_items::lammps_cell;
use super::lammps_local;
use super::settings::{ImportOptions, Known};
use super::stated;
use super::text::{Line, lines, shown};

/// The packing of a data file.
///
/// # Errors
/// If the text is invalid, has another style or unit or mixed densities, or settings are missing.
pub fn packing(text: &str, options: &ImportOptions) -> Result<Imported, ImportError> {
    let mut file = DataFile::default();
    let mut section = Section::Header;
    for line in lines(text) {
        // A section's name may be followed by a comment with the style.
        let (content, comment) = line.text.split_once('#').unwrap_or((line.text, ""));
        let words: Vec<&str> = content.split_whitespace().collect();
        if line.number == 1 {
            file.title(&line)?;
        } else if !words.is_empty() {
            section = file.read(section, &line, &words, comment.trim())?;
        }
    }
    file.finish(options)
}

/// Sections of what is no single sphere, which the header counts under the same names.
const NO_SPHERES: [&str; 8] =
    ["bonds", "angles", "dihedrals", "impropers", "ellipsoids", "lines", "triangles", "bodies"];

const SINGLE: &str = "grains must be single spheres without bonds";

/// The box: number of values, and the words after them.
const BOX: [(usize, &str); 8] = [
    (2, "xlo xhi"),
    (2, "ylo yhi"),
    (2, "zlo zhi"),
    (3, "xy xz yz"),
    (3, "avec"),
    (3, "bvec"),
    (3, "cvec"),
    (3, "abc origin"),
];

/// Counts that [`NO_SPHERES`] does not list: the words after the number.
const COUNTS: [&str; 11] = [
    "atoms",
    "atom types",
    "bond types",
    "angle types",
    "dihedral types",
    "improper types",
    "extra bond per atom",
    "extra angle per atom",
    "extra dihedral per atom",
    "extra improper per atom",
    "extra special per atom",
];

/// Splits a line of the header into its values and its name. Like LAMMPS, it ignores words after the name.
fn entry<'a, 'b>(
    mut forms: impl Iterator<Item = (usize, &'static str)>,
    words: &'b [&'a str],
) -> Option<(&'static str, &'b [&'a str])> {
    let is_of = |(values, name): &(usize, &str)| {
        let mut rest = words.iter().skip(*values);
        words.len() > *values && name.split(' ').all(|word| rest.next() == Some(&word))
    };
    let (values, name) = forms.find(is_of)?;
    Some((name, &words[..values]))
}

#[derive(Clone, Copy)]
enum Section {
    Header,
    Atoms,
    Velocities,
    Other,
}

impl Section {
    fn named(line: &Line<'_>, words: &[&str], style: &str) -> Result<Option<Self>, ImportError> {
        match *words {
            ["Atoms"] if matches!(style, "" | "sphere") => Ok(Some(Self::Atoms)),
            ["Atoms"] => {
                let what = format!("atom_style {style}");
                Err(ImportError::unsupported(line.number, what, "only spheres are (atom_style sphere)"))
            }
            ["Velocities"] => Ok(Some(Self::Velocities)),
            [name] if NO_SPHERES.contains(&name.to_lowercase().as_str()) => {
                Err(ImportError::unsupported(line.number, format!("the section {name}"), SINGLE))
            }
            ["Masses"] | [_, "Coeffs"] | [_, "Type", "Labels"] => Ok(Some(Self::Other)),
            _ => Ok(None),
        }
    }
}

#[derive(Default)]
struct DataFile {
    step: u64,
    /// Names of the lines of the header.
    named: BTreeSet<&'static str>,
    expected: Option<usize>,
    bounds: [Option<f64>; 3],
    tilt: [f64; 3],
    /// Edge vectors of a general triclinic box.
    edges: [Option<Vec3>; 3],
    grains: GrainTable,
    densities: Vec<f64>,
    motion: BTreeMap<u32, (usize, Vec3, Vec3)>,
    /// True if there is a section of velocities.
    states_motion: bool,
    unread: Vec<String>,
}

impl DataFile {
    /// `LAMMPS data file via write_data, version …, timestep = 100000, units = si`: read if present.
    fn title(&mut self, line: &Line<'_>) -> Result<(), ImportError> {
        let value = |key: &str| {
            line.text.split(',').find_map(|p| p.trim().strip_prefix(key)?.trim().strip_prefix('='))
        };
        if let Some(step) = value("timestep") {
            self.step = line.number("timestep", step)?;
        }
        value("units").map_or(Ok(()), |units| stated::lammps_units(line.number, units))
    }

    /// Reads a line that is not empty, and returns its section.
    fn read(
        &mut self,
        section: Section,
        line: &Line<'_>,
        words: &[&str],
        style: &str,
    ) -> Result<Section, ImportError> {
        if let Some(opened) = Section::named(line, words, style)? {
            self.states_motion |= matches!(opened, Section::Velocities);
            return Ok(opened);
        }
        let is_slip = ["atoms", "velocities", "masses"].contains(&words[0].to_lowercase().as_str());
        // LAMMPS writes the values that fixes keep under names of their users.
        let is_name =
            words[0].starts_with(char::is_alphabetic) && words.iter().all(|w| w.parse::<f64>().is_err());
        match section {
            Section::Header => self.header(line, words)?,
            _ if is_slip => return Err(unknown(line, words)),
            _ if entry(BOX.into_iter(), words).is_some() => {
                return Err(line.error("a line of the header is below a section: move it above all sections"));
            }
            Section::Atoms | Section::Velocities if is_name => {
                self.unread.push(format!("the section {} is not read", shown(&words.join(" "))));
                return Ok(Section::Other);
            }
            Section::Atoms => self.atom(line, words)?,
            Section::Velocities => self.velocity(line, words)?,
            Section::Other => {}
        }
        Ok(section)
    }

    fn header(&mut self, line: &Line<'_>, words: &[&str]) -> Result<(), ImportError> {
        if words.iter().all(|word| word.parse::<f64>().is_ok()) {
            let problem =
                "numbers without a name, as in `500 atoms` or `0 0.01 xlo xhi`: this is no LAMMPS data file";
            return Err(line.error(problem));
        }
        let counts = COUNTS.into_iter().chain(NO_SPHERES).map(|name| (1, name));
        let (name, values) =
            entry(BOX.into_iter().chain(counts), words).ok_or_else(|| unknown(line, words))?;
        if !self.named.insert(name) {
            return Err(line.error(format!("{name} occurs twice")));
        }
        match (name, values) {
            ("atoms", [n]) => self.expected = Some(line.number("number of atoms", n)?),
            ("xlo xhi", [lo, hi]) => self.bounds[0] = Some(edge(line, lo, hi)?),
            ("ylo yhi", [lo, hi]) => self.bounds[1] = Some(edge(line, lo, hi)?),
            ("zlo zhi", [lo, hi]) => self.bounds[2] = Some(edge(line, lo, hi)?),
            ("xy xz yz", [xy, xz, yz]) => self.tilt = line.vector("tilt", [xy, xz, yz])?.into(),
            ("avec", [x, y, z]) => self.edges[0] = Some(line.vector("edge vector", [x, y, z])?),
            ("bvec", [x, y, z]) => self.edges[1] = Some(line.vector("edge vector", [x, y, z])?),
            ("cvec", [x, y, z]) => self.edges[2] = Some(line.vector("edge vector", [x, y, z])?),
            (kind, [n]) => {
                let is_any = line.number::<u64>(kind, n)? > 0;
                if is_any && NO_SPHERES.contains(&kind) {
                    let what = format!("a packing with {n} {kind}");
                    return Err(ImportError::unsupported(line.number, what, SINGLE));
                }
            }
            // The place of the box is arbitrary.
            _ => {}
        }
        Ok(())
    }

    fn atom(&mut self, line: &Line<'_>, words: &[&str]) -> Result<(), ImportError> {
        let [id, kind, diameter, density, x, y, z] = match *words {
            [id, t, d, rho, x, y, z] => [id, t, d, rho, x, y, z],
            [id, t, d, rho, x, y, z, ref images @ ..] if images.len() == 3 => {
                images.iter().try_for_each(|flag| line.number::<i32>("an image flag", flag).map(|_| ()))?;
                [id, t, d, rho, x, y, z]
            }
            _ => {
                let problem = "an atom is id type diameter density x y z, and three image flags or none";
                return Err(line.error(format!("{problem}: 7 or 10 fields, not {}", words.len())));
            }
        };
        let stated = 0.5 * line.number::<f64>("diameter", diameter)?;
        self.grains.kinds.insert(kind.to_owned());
        self.densities.push(line.number("density", density)?);
        let position = line.vector("position", [x, y, z])?;
        self.grains.printed.note([x, y, z], 1.0);
        self.grains.push(line, line.id("id", id)?, stated, [position, Vec3::zeros(), Vec3::zeros()])
    }

    fn velocity(&mut self, line: &Line<'_>, words: &[&str]) -> Result<(), ImportError> {
        let [id, vx, vy, vz, wx, wy, wz] = *words else {
            return Err(
                line.error(format!("a velocity is id vx vy vz wx wy wz: 7 fields, not {}", words.len()))
            );
        };
        let (v, w) = (line.vector("velocity", [vx, vy, vz])?, line.vector("angular velocity", [wx, wy, wz])?);
        let id = line.id("id", id)?;
        match self.motion.insert(id, (line.number, v, w)) {
            Some((before, ..)) => Err(ImportError::twice(id, line.number, before)),
            None => Ok(()),
        }
    }

    fn finish(mut self, options: &ImportOptions) -> Result<Imported, ImportError> {
        let moving = self.motion.len();
        for (k, id) in self.grains.ids.iter().enumerate() {
            match self.motion.remove(id) {
                Some((_, v, w)) => (self.grains.velocities[k], self.grains.spins[k]) = (v, w),
                None if self.states_motion => {
                    let problem =
                        format!("{moving} velocities, but none of grain {id}: the file is incomplete");
                    return Err(ImportError::line(self.grains.lines[k], problem));
                }
                None => {}
            }
        }
        if let Some((id, (line, ..))) = self.motion.pop_first() {
            return Err(ImportError::unknown_id(line, id));
        }
        let found = self.grains.ids.len();
        if let Some(expected) = self.expected.filter(|n| *n != found) {
            return Err(ImportError::count("atoms", expected, found));
        }
        if self.edges.iter().any(Option::is_some) && self.bounds.iter().any(Option::is_some) {
            let problem = "the header has a box twice: xlo xhi and avec".to_owned();
            return Err(ImportError::line(1, problem));
        }
        let cell: Option<Mat3> = match (self.edges, self.bounds) {
            ([Some(a), Some(b), Some(c)], _) => Some(Mat3::from_columns(&[a, b, c])),
            (_, [Some(lx), Some(ly), Some(lz)]) => Some(lammps_cell([lx, ly, lz], self.tilt)),
            _ => None,
        };
        let density = self.densities.first().copied();
        if options.density.is_none() && self.densities.iter().any(|d| Some(*d) != density) {
            let reason = "all grains must be of one material: give --density to use one for all";
            return Err(ImportError::unsupported(1, "a mixture of densities", reason));
        }
        let mut settings = Known { cell, density, ..Known::default() }.complete(options)?;
        settings.notes.append(&mut self.unread);
        settings.notes.push(
            "a data file does not state its boundaries: the cell is taken as periodic in all directions"
                .to_owned(),
        );
        for k in 0..found {
            self.grains.radii[k] = self.grains.radius(Some(self.grains.radii[k]), options)?;
            self.grains
                .masses
                .push(4.0 / 3.0 * std::f64::consts::PI * self.densities[k] * self.grains.radii[k].powi(3));
        }
        let grains = self.grains.sorted_by_id();
        lammps_local::packing(grains, &settings, options, Moment::at(self.step), "LAMMPS data file".into())
    }
}

fn unknown(line: &Line<'_>, words: &[&str]) -> ImportError {
    line.error(format!(
        "{} is neither a line of the header, such as `500 atoms`, `0 0.01 xlo xhi` or `0 0 0 xy xz yz`, nor a section, such as \
         Atoms: write it as LAMMPS does, or remove it",
        shown(&words.join(" "))
    ))
}

fn edge(line: &Line<'_>, lo: &str, hi: &str) -> Result<f64, ImportError> {
    Ok(line.finite("upper bound", hi)? - line.finite("lower bound", lo)?)
}
