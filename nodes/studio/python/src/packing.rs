//! Packings as Python objects.

use crate::arrays::{copied, field, matrix, numbers, one, row, scalars, vectors};
use crate::parallel;
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3, contact_search};
use grainlab_msgs::boundary::{packing_header, packing_message};
use grainlab_msgs::{from_cdr, msg, to_cdr};
use grainlab_recordings::import::Imported;
use grainlab_viewer::{Film, Ground, Picture, Quantity, Size, View};
use numpy::{Ix1, Ix2, PyArray, PyArray1, PyArray2, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use std::sync::atomic::AtomicBool;

/// A packing of spheres in a periodic cell, which never changes. ``len(packing)`` is the number of grains n; m is that of contacts. SI units.
///
/// Arrays of a packing share its memory, without copies, and are read-only; each keeps the packing in memory. It can be pickled, without loss.
///
/// Made from arrays or lists: cell (3, 3) with its edge vectors as columns, positions (n, 3), radii (n,) or one, m; velocities (n, 3), m/s; shear modulus,
/// Pa; density, kg/m3. Contacts are those of overlapping spheres, with Hertz forces and without tangential forces. Raises ValueError for
/// wrong shapes, numbers that are not finite, and spheres that coincide.
///
/// >>> packing = grainlab.Packing(1e-3 * numpy.eye(3), centres, radii, friction=0.3)
/// >>> packing.contact_normals @ packing.stress
#[pyclass(name = "Packing", module = "grainlab", frozen)]
pub(crate) struct PyPacking {
    imported: Imported,
}

type Array<'py, T, D> = Bound<'py, PyArray<T, D>>;

impl PyPacking {
    pub(crate) fn new(packing: Packing, source: String, notes: Vec<String>, run_state: Vec<u8>) -> Self {
        let (header, step) = (packing_header(&packing), packing.step);
        Imported { packing, header, step, run_state, source, rounding: None, notes }.into()
    }

    pub(crate) fn imported(&self) -> &Imported {
        &self.imported
    }

    pub(crate) fn packing(&self) -> &Packing {
        &self.imported.packing
    }
}

impl From<Imported> for PyPacking {
    fn from(imported: Imported) -> Self {
        Self { imported }
    }
}

/// A packing from its bytes in a pickle.
#[pyfunction]
pub(crate) fn unpickled(bytes: &[u8], source: String, notes: Vec<String>) -> PyResult<PyPacking> {
    let message: msg::Packing = from_cdr(bytes).map_err(refused)?;
    let packing = Packing::try_from(&message).map_err(refused)?;
    Ok(PyPacking::new(packing, source, notes, message.run_state))
}

fn contacts_of<'a>(slf: &'a Bound<'_, PyPacking>) -> &'a [Contact] {
    &slf.get().packing().contacts
}

#[pymethods]
impl PyPacking {
    /// From arrays; the contacts are those of the positions, with the normal forces of the contact law.
    #[new]
    #[pyo3(signature = (cell, positions, radii, *, velocities=None, shear_modulus=Material::GLASS.shear_modulus,
        poisson_ratio=Material::GLASS.poisson_ratio, density=Material::GLASS.density, friction=0.0))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn from_arrays(
        cell: Bound<'_, PyAny>,
        positions: Bound<'_, PyAny>,
        radii: Bound<'_, PyAny>,
        velocities: Option<Bound<'_, PyAny>>,
        shear_modulus: f64,
        poisson_ratio: f64,
        density: f64,
        friction: f64,
    ) -> PyResult<Self> {
        let cell = numbers("cell", &cell, &[Some(3), Some(3)])?;
        let cell = Cell::new(Mat3::from_row_slice(&cell)).ok_or_else(|| {
            PyValueError::new_err("cell has no volume, or its edge vectors (columns) are left-handed")
        })?;
        let positions = triples("positions", &positions)?;
        let n = positions.len();
        let radii = match numbers("radii", &radii, &[]) {
            Ok(one) => vec![one[0]; n],
            Err(_) => numbers("radii", &radii, &[Some(n)])?,
        };
        let velocities = velocities.map(|v| triples("velocities", &v)).transpose()?;
        let grains = Packing {
            deformation: Packing::no_reference(),
            velocities: velocities.unwrap_or_else(|| vec![Vec3::zeros(); n]),
            material: Material { shear_modulus, poisson_ratio, density },
            friction,
            ..Packing::at_rest(cell, radii, positions)
        };
        let grains = grains.validated().map_err(refused)?;
        let contacts = contact_search::of_packing(&grains).map_err(refused)?;
        let packing = Packing { contacts, ..grains }.validated().map_err(refused)?;
        Ok(Self::new(packing, "arrays".to_owned(), Vec::new(), Vec::new()))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, imported) = (slf.py(), slf.get().imported());
        let bytes = to_cdr(&packing_message(&imported.packing, "", imported.run_state.clone()));
        let made = py.import("grainlab._grainlab")?.getattr("unpickled")?;
        (made, (PyBytes::new(py, &bytes), &imported.source, &imported.notes)).into_pyobject(py)
    }

    /// The packing as pixels: the bytes of a PNG.
    fn _png<'py>(slf: &Bound<'py, Self>, color: &str, size: &str) -> PyResult<Bound<'py, PyBytes>> {
        let known = Quantity::ALL.map(Quantity::name);
        let color = Quantity::ALL.into_iter().find(|quantity| quantity.name() == color);
        let color = color
            .ok_or_else(|| PyValueError::new_err(format!("color must be one of: {}", known.join(", "))))?;
        let size: Size = size.parse().map_err(refused)?;
        let (py, owner) = (slf.py(), slf.clone().unbind());
        let draw = move |_: &AtomicBool| Picture::new(&owner.get().view(), color, size, Ground::Light).png();
        Ok(PyBytes::new(py, &parallel::detach(py, draw)?.map_err(refused)?))
    }

    fn _repr_png_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyBytes>> {
        Self::_png(slf, Quantity::default().name(), "600x450")
    }

    fn __len__(&self) -> usize {
        self.packing().grains()
    }

    fn __repr__(&self) -> String {
        let p = self.packing();
        let (n, m, phi) = (p.grains(), p.contacts.len(), p.solid_fraction());
        format!("<grainlab.Packing: {n} grains, {m} contacts, phi {phi:.4}, step {}>", p.step)
    }

    /// Origin of the packing, as text.
    #[getter]
    fn source(&self) -> &str {
        &self.imported.source
    }

    /// Remarks of the reader of its file.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.imported.notes.clone()
    }

    /// Solver steps done.
    #[getter]
    fn step(&self) -> u64 {
        self.packing().step
    }

    /// Simulated time, s.
    #[getter]
    fn time(&self) -> f64 {
        self.packing().time
    }

    /// Volume of the spheres over that of the cell.
    #[getter]
    fn solid_fraction(&self) -> f64 {
        self.packing().solid_fraction()
    }

    /// Stress, Pa, shape (3, 3), positive in compression: a new array.
    #[getter]
    fn stress<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let stress = grainlab_core::stress::stress(self.packing()).tensor.matrix();
        matrix(py, 3, |i, j| stress[(i, j)])
    }

    /// Logarithmic strain, shape (3, 3), positive in extension, of the same origin as the deformation: a new array. None for a packing
    /// that has none.
    #[getter]
    fn strain<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let strain = self.packing().strain()?.matrix();
        Some(matrix(py, 3, |i, j| strain[(i, j)]))
    }

    /// Number of the phase of its scene, from 1; 0 for the packing that a run started from; None for a packing of no run.
    #[getter]
    fn phase(&self) -> Option<usize> {
        self.packing().path.as_ref().map(|path| path.phase)
    }

    /// True if the phase met its end conditions at this packing; one within a phase need not be at rest. None for a packing of no run.
    #[getter]
    fn end_of_phase(&self) -> Option<bool> {
        self.packing().path.as_ref().map(|path| path.end_of_phase)
    }

    /// Friction coefficient in force; may be infinite.
    #[getter]
    fn friction(&self) -> f64 {
        self.packing().friction
    }

    /// Shear modulus of the grains, Pa.
    #[getter]
    fn shear_modulus(&self) -> f64 {
        self.packing().material.shear_modulus
    }

    /// Poisson ratio of the grains.
    #[getter]
    fn poisson_ratio(&self) -> f64 {
        self.packing().material.poisson_ratio
    }

    /// Density of the grains, kg/m3.
    #[getter]
    fn density(&self) -> f64 {
        self.packing().material.density
    }

    /// Name of the contact law.
    #[getter]
    fn contact_law(&self) -> &'static str {
        self.packing().law.name()
    }

    /// Edge vectors of the cell as columns, m, (3, 3): a copy.
    #[getter]
    fn cell<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, 3, |i, j| self.packing().cell.matrix()[(i, j)])
    }

    /// Deformation gradient since the reference state, or since the first step of the run until a phase sets one,
    /// (3, 3): a copy. None for a packing that has neither.
    #[getter]
    fn deformation<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.packing().strain().map(|_| matrix(py, 3, |i, j| self.packing().deformation[(i, j)]))
    }

    /// Persistent ids, (n,).
    #[getter]
    fn ids<'py>(slf: &Bound<'py, Self>) -> Array<'py, u32, Ix1> {
        scalars(slf.clone().into_any(), &slf.get().packing().ids)
    }

    /// Radii of the grains, m, (n,).
    #[getter]
    fn radii<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix1> {
        scalars(slf.clone().into_any(), &slf.get().packing().radii)
    }

    /// Centres, unwrapped, m, (n, 3).
    #[getter]
    fn positions<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        vectors(slf.clone().into_any(), &slf.get().packing().positions)
    }

    /// Relative to the affine motion, m/s, (n, 3).
    #[getter]
    fn velocities<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        vectors(slf.clone().into_any(), &slf.get().packing().velocities)
    }

    /// rad/s, (n, 3).
    #[getter]
    fn angular_velocities<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        vectors(slf.clone().into_any(), &slf.get().packing().spins)
    }

    /// Centres folded into the cell, m, (n, 3): a copy.
    #[getter]
    fn wrapped_positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let cell = &self.packing().cell;
        let folded = |x: &Vec3| {
            let fractional = cell.fractional(x);
            cell.matrix() * fractional.map(|f| f - f.floor())
        };
        copied(py, self.packing().positions.iter().map(folded))
    }

    /// Index of the first grain i of each contact, (m,).
    #[getter]
    fn contact_first<'py>(slf: &Bound<'py, Self>) -> Array<'py, u32, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.i, one)
    }

    /// Index of the second grain j >= i, (m,).
    #[getter]
    fn contact_second<'py>(slf: &Bound<'py, Self>) -> Array<'py, u32, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.j, one)
    }

    /// Cell vectors added to j, (m, 3).
    #[getter]
    fn contact_images<'py>(slf: &Bound<'py, Self>) -> Array<'py, i8, Ix2> {
        field(slf.clone().into_any(), contacts_of(slf), |c| c.image.as_ptr(), row::<3>)
    }

    /// Unit vector from i to the image of j, (m, 3).
    #[getter]
    fn contact_normals<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        field(slf.clone().into_any(), contacts_of(slf), |c| c.normal.as_ptr(), row::<3>)
    }

    /// Full overlap, m, (m,).
    #[getter]
    fn contact_overlaps<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.overlap, one)
    }

    /// N, positive in compression, (m,).
    #[getter]
    fn contact_normal_forces<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.normal_force, one)
    }

    /// On i, N, (m, 3).
    #[getter]
    fn contact_tangential_forces<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        field(slf.clone().into_any(), contacts_of(slf), |c| c.tangential_force.as_ptr(), row::<3>)
    }

    /// From the centre of i to the image of j, m, (m, 3): a copy.
    #[getter]
    fn contact_branches<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let p = self.packing();
        copied(py, p.contacts.iter().map(|c| p.branch(c)))
    }

    /// True for each grain that carries no force, (n,): a copy.
    #[getter]
    fn rattlers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let carries = grainlab_core::non_rattlers(self.packing());
        let rattlers: Vec<bool> = carries.iter().map(|carries| !carries).collect();
        rattlers.to_pyarray(py)
    }
}

impl PyPacking {
    fn view(&self) -> View {
        View::new(self.packing(), self.__repr__().replace(['<', '>'], ""))
    }
}

/// A page that shows packings in three dimensions: HTML.
#[pyfunction]
pub(crate) fn page(py: Python<'_>, name: &str, packings: Vec<Py<PyPacking>>) -> PyResult<String> {
    let mut film = Film::default();
    packings.iter().for_each(|packing| film.push(packing.get().view()));
    let about = format!("{} of {} states", film.states().len(), film.count());
    py.detach(|| grainlab_viewer::page(name, &about, name, &film.states())).map_err(refused)
}

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn triples(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Vec<Vec3>> {
    let found = numbers(name, array, &[None, Some(3)])?;
    Ok(found.as_chunks::<3>().0.iter().map(|row| Vec3::from(*row)).collect())
}
