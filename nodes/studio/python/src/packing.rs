//! Packings as Python objects.

use crate::arrays::{copied, field, matrix, one, row, scalars, vectors};
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};
use grainlab_experiment::PathPosition;
use grainlab_recordings::import::{Imported, contacts};
use numpy::{Ix1, Ix2, PyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A packing, which never changes: the arrays refer to its memory.
#[pyclass(name = "Packing", module = "grainlab", frozen)]
pub(crate) struct PyPacking {
    packing: Packing,
    source: String,
    notes: Vec<String>,
    /// On the loading path of its run.
    position: Option<PathPosition>,
}

type Array<'py, T, D> = Bound<'py, PyArray<T, D>>;

impl PyPacking {
    pub(crate) fn new(packing: Packing, source: String, notes: Vec<String>) -> Self {
        Self { packing, source, notes, position: None }
    }

    /// This packing with the run state of its run.
    pub(crate) fn at(self, run_state: &[u8]) -> Self {
        Self { position: PathPosition::of(run_state), ..self }
    }

    pub(crate) fn position(&self) -> Option<PathPosition> {
        self.position
    }

    pub(crate) fn packing(&self) -> &Packing {
        &self.packing
    }
}

impl From<Imported> for PyPacking {
    fn from(imported: Imported) -> Self {
        Self::new(imported.packing, imported.source, imported.notes).at(&imported.run_state)
    }
}

fn contacts_of<'a>(slf: &'a Bound<'_, PyPacking>) -> &'a [Contact] {
    &slf.get().packing.contacts
}

#[pymethods]
impl PyPacking {
    /// From arrays; the contacts are those of the positions, with the normal forces of the contact law.
    #[new]
    #[pyo3(signature = (cell, positions, radii, *, velocities=None, shear_modulus=Material::GLASS.shear_modulus,
        poisson_ratio=Material::GLASS.poisson_ratio, density=Material::GLASS.density, friction=0.0))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn from_arrays(
        cell: PyReadonlyArray2<'_, f64>,
        positions: PyReadonlyArray2<'_, f64>,
        radii: PyReadonlyArray1<'_, f64>,
        velocities: Option<PyReadonlyArray2<'_, f64>>,
        shear_modulus: f64,
        poisson_ratio: f64,
        density: f64,
        friction: f64,
    ) -> PyResult<Self> {
        let cell = cell.as_array();
        if cell.dim() != (3, 3) {
            return Err(PyValueError::new_err(format!("cell has shape {:?}; it must be (3, 3)", cell.dim())));
        }
        let cell = Cell::new(Mat3::from_fn(|i, j| cell[(i, j)])).ok_or_else(|| {
            PyValueError::new_err("cell has no volume, or its edge vectors (columns) are left-handed")
        })?;
        let positions = triples("positions", &positions)?;
        let radii: Vec<f64> = radii.as_array().iter().copied().collect();
        let n = radii.len();
        let velocities = velocities.map(|v| triples("velocities", &v)).transpose()?;
        let grains = Packing {
            step: 0,
            time: 0.0,
            cell,
            deformation: Packing::no_reference(),
            ids: (0..n as u32).collect(),
            radii,
            positions,
            velocities: velocities.unwrap_or_else(|| vec![Vec3::zeros(); n]),
            spins: vec![Vec3::zeros(); n],
            contacts: Vec::new(),
            material: Material { shear_modulus, poisson_ratio, density },
            law: ContactLaw::default(),
            friction,
            time_step: 0.0,
        };
        let grains = grains.validated().map_err(refused)?;
        let force = |radius: f64, overlap: f64| grains.law.normal_force(&grains.material, radius, overlap);
        let found = contacts::find(&grains.cell, &grains.positions, &grains.radii, force);
        let contacts = found.map_err(refused)?;
        let packing = Packing { contacts, ..grains }.validated().map_err(refused)?;
        Ok(Self::new(packing, "arrays".to_owned(), Vec::new()))
    }

    fn __len__(&self) -> usize {
        self.packing.grains()
    }

    fn __repr__(&self) -> String {
        let p = &self.packing;
        let (n, m, phi) = (p.grains(), p.contacts.len(), p.solid_fraction());
        format!("<grainlab.Packing: {n} grains, {m} contacts, phi {phi:.4}, step {}>", p.step)
    }

    #[getter]
    fn source(&self) -> &str {
        &self.source
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    #[getter]
    fn step(&self) -> u64 {
        self.packing.step
    }

    #[getter]
    fn time(&self) -> f64 {
        self.packing.time
    }

    #[getter]
    fn solid_fraction(&self) -> f64 {
        self.packing.solid_fraction()
    }

    #[getter]
    fn friction(&self) -> f64 {
        self.packing.friction
    }

    #[getter]
    fn shear_modulus(&self) -> f64 {
        self.packing.material.shear_modulus
    }

    #[getter]
    fn poisson_ratio(&self) -> f64 {
        self.packing.material.poisson_ratio
    }

    #[getter]
    fn density(&self) -> f64 {
        self.packing.material.density
    }

    #[getter]
    fn contact_law(&self) -> &'static str {
        self.packing.law.name()
    }

    #[getter]
    fn cell<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, 3, |i, j| self.packing.cell.matrix()[(i, j)])
    }

    #[getter]
    fn deformation<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.packing.strain().map(|_| matrix(py, 3, |i, j| self.packing.deformation[(i, j)]))
    }

    #[getter]
    fn ids<'py>(slf: &Bound<'py, Self>) -> Array<'py, u32, Ix1> {
        scalars(slf.clone().into_any(), &slf.get().packing.ids)
    }

    #[getter]
    fn radii<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix1> {
        scalars(slf.clone().into_any(), &slf.get().packing.radii)
    }

    #[getter]
    fn positions<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        vectors(slf.clone().into_any(), &slf.get().packing.positions)
    }

    #[getter]
    fn velocities<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        vectors(slf.clone().into_any(), &slf.get().packing.velocities)
    }

    #[getter]
    fn angular_velocities<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        vectors(slf.clone().into_any(), &slf.get().packing.spins)
    }

    /// Positions folded into the cell: a copy.
    #[getter]
    fn wrapped_positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let cell = &self.packing.cell;
        let folded = |x: &Vec3| {
            let fractional = cell.fractional(x);
            cell.matrix() * fractional.map(|f| f - f.floor())
        };
        copied(py, self.packing.positions.iter().map(folded))
    }

    #[getter]
    fn contact_first<'py>(slf: &Bound<'py, Self>) -> Array<'py, u32, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.i, one)
    }

    #[getter]
    fn contact_second<'py>(slf: &Bound<'py, Self>) -> Array<'py, u32, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.j, one)
    }

    #[getter]
    fn contact_images<'py>(slf: &Bound<'py, Self>) -> Array<'py, i8, Ix2> {
        field(slf.clone().into_any(), contacts_of(slf), |c| c.image.as_ptr(), row::<3>)
    }

    #[getter]
    fn contact_normals<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        field(slf.clone().into_any(), contacts_of(slf), |c| c.normal.as_ptr(), row::<3>)
    }

    #[getter]
    fn contact_overlaps<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.overlap, one)
    }

    #[getter]
    fn contact_normal_forces<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix1> {
        field(slf.clone().into_any(), contacts_of(slf), |c| &raw const c.normal_force, one)
    }

    #[getter]
    fn contact_tangential_forces<'py>(slf: &Bound<'py, Self>) -> Array<'py, f64, Ix2> {
        field(slf.clone().into_any(), contacts_of(slf), |c| c.tangential_force.as_ptr(), row::<3>)
    }

    /// From the centre of the first grain to that of the image of the second: a copy.
    #[getter]
    fn contact_branches<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let p = &self.packing;
        copied(py, p.contacts.iter().map(|c| p.branch(c)))
    }

    /// True for each grain that carries no force.
    #[getter]
    fn rattlers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let carries = grainlab_core::non_rattlers(&self.packing);
        let rattlers: Vec<bool> = carries.iter().map(|carries| !carries).collect();
        rattlers.to_pyarray(py)
    }
}

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn triples(name: &str, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vec3>> {
    let array = array.as_array();
    if array.ncols() != 3 {
        let message = format!("{name} has shape {:?}; it must be (n, 3)", array.dim());
        return Err(PyValueError::new_err(message));
    }
    Ok(array.rows().into_iter().map(|r| Vec3::new(r[0], r[1], r[2])).collect())
}
