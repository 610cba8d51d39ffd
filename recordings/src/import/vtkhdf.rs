//! VTKHDF files of grains, as `grainlab bag export --format vtkhdf` and others write them: HDF5 with the layout of `vtkPolyData`.
//!
//! Read of `PointData`: `radius` (or `Radius`), and where they are `id`, `velocity`, `angular_velocity` and `position_unwrapped`; else
//! `Points`. Of `FieldData`: `cell`, `deformation`, `shear_modulus`, `poisson_ratio`, `density`, `friction`, `TimeValue`, `step`,
//! `time_step`. Contacts are those of the file of contacts beside it, or else found from positions.

use super::assemble::{self, GrainTable, ListedContact, ListedForce, Moment};
use super::error::ImportError;
use super::imported::Imported;
use super::settings::{ImportOptions, Known};
use super::text::Line;
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use hdf5_pure::{AttrValue, File, H5Element};

/// The first bytes of every HDF5 file.
pub(super) const MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The packing of a file of grains, with the file of its contacts if there is one.
///
/// # Errors
/// If a file is not VTKHDF, is damaged, or lacks a quantity.
pub fn packing(
    grains: Vec<u8>,
    contacts: Option<Vec<u8>>,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let file = Data::open(grains)?;
    if file.0.dataset("VTKHDF/CellData/pair").is_ok() {
        return Err(damaged("it holds contacts: give the file of the grains, which is read with it"));
    }
    let field = |name: &str| file.scalar(&format!("FieldData/{name}"));
    let matrix = |name: &str| -> Result<Option<Mat3>, ImportError> {
        match file.numbers::<f64>(&format!("FieldData/{name}"))? {
            Some(n) if n.len() != 9 => {
                Err(damaged(format!("{name} has {} numbers; it must have 9", n.len())))
            }
            numbers => Ok(numbers.map(|n| Mat3::from_row_slice(&n))),
        }
    };
    let known = Known {
        cell: matrix("cell")?,
        shear_modulus: field("shear_modulus")?,
        poisson_ratio: field("poisson_ratio")?,
        density: field("density")?,
        law: file.law()?,
        friction: field("friction")?,
    };
    let settings = known.complete(options)?;
    let state = Moment {
        step: match field("step")? {
            Some(step) if step < 0.0 || step.fract() != 0.0 => {
                return Err(damaged(format!("step is {step}")));
            }
            step => step.map_or(0, |s| s as u64),
        },
        time: field("TimeValue")?.unwrap_or(0.0),
        deformation: matrix("deformation")?.unwrap_or_else(Packing::no_reference),
        time_step: field("time_step")?.unwrap_or(0.0),
    };
    file.check_stated()?;
    let table = file.grains(options)?;
    file.check_points(&table, &settings.cell)?;
    let listed = contacts.map(|bytes| file.contacts_of(&Data::open(bytes)?)).transpose()?;
    assemble::packing(table, &settings, listed.as_deref(), state, "VTKHDF".into(), Vec::new())
}

/// An opened file.
struct Data(File);

fn damaged(problem: impl std::fmt::Display) -> ImportError {
    ImportError::Invalid(format!("HDF5: {problem}"))
}

impl Data {
    fn open(bytes: Vec<u8>) -> Result<Self, ImportError> {
        let file = File::from_bytes(bytes).map_err(damaged)?;
        let kind = file.group("VTKHDF").and_then(|group| group.attrs()).map_err(damaged)?;
        match kind.get("Type") {
            Some(AttrValue::AsciiString(kind) | AttrValue::String(kind)) if kind == "PolyData" => {
                Ok(Self(file))
            }
            other => Err(damaged(format!("the attribute Type of /VTKHDF is {other:?}; PolyData is read"))),
        }
    }

    /// The numbers of a dataset under `/VTKHDF`; `None` if it does not exist.
    fn numbers<T: H5Element>(&self, name: &str) -> Result<Option<Vec<T>>, ImportError> {
        match self.0.dataset(&format!("VTKHDF/{name}")) {
            Ok(set) => set.read::<T>().map(Some).map_err(|e| damaged(format!("{name}: {e}"))),
            Err(_) => Ok(None),
        }
    }

    fn scalar(&self, name: &str) -> Result<Option<f64>, ImportError> {
        match self.numbers::<f64>(name)?.as_deref() {
            None | Some([]) => Ok(None),
            Some([value]) => Ok(Some(*value)),
            Some(values) => Err(damaged(format!("{name} has {} numbers; it must have one", values.len()))),
        }
    }

    /// Refuses what a file states and no packing can have here.
    fn check_stated(&self) -> Result<(), ImportError> {
        let named = |name: &str| self.0.dataset(&format!("VTKHDF/FieldData/{name}"));
        if named("units").is_ok() {
            return Err(damaged(
                "FieldData/units is stated: lengths must be in m, and all else in SI units, without it",
            ));
        }
        if self.0.group("VTKHDF/Steps").is_ok() {
            return Err(damaged("it holds several steps (Steps): write each to a file of its own"));
        }
        let sides = self.numbers::<i64>("FieldData/pbc")?.unwrap_or_default();
        if sides.contains(&0) {
            return Err(damaged(format!(
                "FieldData/pbc is {sides:?}: the cell must be periodic along all edges"
            )));
        }
        Ok(())
    }

    /// Refuses points that are not the places of the grains in the cell.
    fn check_points(&self, table: &GrainTable, cell: &Cell) -> Result<(), ImportError> {
        let points = self.vectors("Points", table.positions.len())?.unwrap_or_default();
        for (k, (point, position)) in points.iter().zip(&table.positions).enumerate() {
            let off = assemble::apart_in_cell(cell, &(point - position));
            // Points may have single precision.
            let rounding = 1e-6 * (point.norm() + position.norm() + cell.matrix().amax());
            if assemble::is_beyond(off, rounding) {
                return Err(damaged(format!(
                    "Points and PointData/position_unwrapped of row {} are {off:.3e} m apart: which of them is right is not known",
                    k + 1
                )));
            }
        }
        Ok(())
    }

    /// The contacts of a file that belongs to this one of grains.
    fn contacts_of(&self, other: &Self) -> Result<Vec<ListedContact>, ImportError> {
        for name in ["step", "TimeValue", "friction", "shear_modulus", "poisson_ratio", "density", "cell"] {
            let of = |file: &Self| file.numbers::<f64>(&format!("FieldData/{name}"));
            if let (Some(own), Some(its)) = (of(self)?, of(other)?)
                && own != its
            {
                return Err(damaged(format!(
                    "{name} is {its:?} in the file of contacts and {own:?} in that of the grains"
                )));
            }
        }
        other.contacts()
    }

    fn vectors(&self, name: &str, count: usize) -> Result<Option<Vec<Vec3>>, ImportError> {
        let Some(numbers) = self.numbers::<f64>(name)? else { return Ok(None) };
        if numbers.len() != 3 * count {
            return Err(damaged(format!("{name} has {} numbers for {count} rows of three", numbers.len())));
        }
        Ok(Some(numbers.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect()))
    }

    fn column<T: H5Element>(&self, name: &str, count: usize) -> Result<Option<Vec<T>>, ImportError> {
        let found = self.numbers::<T>(name)?;
        match found {
            Some(values) if values.len() != count => {
                Err(damaged(format!("{name} has {} numbers for {count} rows", values.len())))
            }
            found => Ok(found),
        }
    }

    fn law(&self) -> Result<Option<ContactLaw>, ImportError> {
        let Ok(attributes) = self.0.group("grainlab").and_then(|group| group.attrs()) else {
            return Ok(None);
        };
        let name = match attributes.get("contact_law") {
            None => return Ok(None),
            Some(AttrValue::AsciiString(name) | AttrValue::String(name)) => name,
            Some(other) => return Err(damaged(format!("contact_law is {other:?}; it must be a name"))),
        };
        let parameters = match attributes.get("contact_law_parameters") {
            Some(AttrValue::F64Array(parameters)) => parameters.clone(),
            Some(AttrValue::F64(parameter)) => vec![*parameter],
            _ => Vec::new(),
        };
        ContactLaw::new(name, &parameters).map(Some).map_err(damaged)
    }

    fn grains(&self, options: &ImportOptions) -> Result<GrainTable, ImportError> {
        let radii = match self.numbers::<f64>("PointData/radius")? {
            None => self.numbers::<f64>("PointData/Radius")?,
            found => found,
        };
        let points =
            self.numbers::<f64>("Points")?.ok_or_else(|| damaged("there is no dataset /VTKHDF/Points"))?;
        let count = points.len() / 3;
        let stated = self.numbers::<i64>("NumberOfPoints")?.map(|n| n.iter().sum::<i64>());
        if let Some(stated) = stated.and_then(|n| usize::try_from(n).ok()).filter(|n| *n != count) {
            return Err(ImportError::count("grains", stated, count));
        }
        if let Some(radii) = radii.as_ref().filter(|radii| radii.len() != count) {
            return Err(damaged(format!("{} radii for {count} points", radii.len())));
        }
        let positions = match self.vectors("PointData/position_unwrapped", count)? {
            Some(held) => held,
            None => self.vectors("Points", count)?.unwrap_or_default(),
        };
        let zeros = || vec![Vec3::zeros(); count];
        let velocities = self.vectors("PointData/velocity", count)?.unwrap_or_else(zeros);
        let spins = self.vectors("PointData/angular_velocity", count)?.unwrap_or_else(zeros);
        let ids = self.column::<i64>("PointData/id", count)?.unwrap_or_else(|| (0..count as i64).collect());
        let whole =
            |id: i64| u32::try_from(id).map_err(|_| damaged(format!("id {id} is outside 0 to 4294967295")));
        let ids = ids.into_iter().map(whole).collect::<Result<Vec<u32>, _>>()?;
        let masses = self.column::<f64>("PointData/mass", count)?.unwrap_or_default();
        let mut table = GrainTable { masses, ..GrainTable::default() };
        for k in 0..count {
            // Rows take the place of lines in messages.
            let row = Line { number: k + 1, text: "" };
            let radius = table.radius(radii.as_ref().map(|radii| radii[k]), options)?;
            table.push(&row, ids[k], radius, [positions[k], velocities[k], spins[k]])?;
        }
        Ok(table)
    }

    fn contacts(&self) -> Result<Vec<ListedContact>, ImportError> {
        let need = |name: &str| damaged(format!("the file of contacts has no dataset CellData/{name}"));
        let pairs = self.numbers::<u32>("CellData/pair")?.ok_or_else(|| need("pair"))?;
        let count = pairs.len() / 2;
        let of =
            |name: &str| self.column::<f64>(&format!("CellData/{name}"), count)?.ok_or_else(|| need(name));
        let three = |name: &str| self.vectors(&format!("CellData/{name}"), count);
        let (overlaps, forces) = (of("overlap")?, of("normal_force")?);
        let normals = three("normal")?.ok_or_else(|| need("normal"))?;
        let tangential = three("tangential_force")?.ok_or_else(|| need("tangential_force"))?;
        let rolling = three("rolling_force")?;
        let contact = |k: usize| ListedContact {
            line: k + 1,
            ids: (pairs[2 * k], pairs[2 * k + 1]),
            normal: Some(-normals[k]),
            overlap: Some(overlaps[k]),
            force: ListedForce::Split { normal: forces[k], tangential: tangential[k] },
            rolling: rolling.as_ref().map_or_else(Vec3::zeros, |r| r[k]),
        };
        Ok((0..count).map(contact).collect())
    }
}
