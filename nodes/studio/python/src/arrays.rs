//! Views of Rust memory as numpy arrays: read-only, without copies, valid as long as their owner, which they keep.

use grainlab_core::Vec3;
use numpy::ndarray::{Array2, ArrayView, Dimension, ShapeBuilder};
use numpy::{AllowTypeChange, Element, IntoPyArray, PyArray, PyArray2, PyArrayLikeDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Numbers of this shape, of any type, in an array, a list or alone; `None` is any length, and NaN what is masked.
pub(crate) fn numbers(name: &str, value: &Bound<'_, PyAny>, shape: &[Option<usize>]) -> PyResult<Vec<f64>> {
    let read = || -> PyResult<PyArrayLikeDyn<'_, f64, AllowTypeChange>> {
        let filled = value.py().import("numpy.ma")?.call_method1("filled", (value, f64::NAN))?;
        filled.extract()
    };
    let array = read().map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    let array = array.as_array();
    let found = array.shape();
    if found.len() != shape.len() || found.iter().zip(shape).any(|(n, of)| of.is_some_and(|of| of != *n)) {
        let words: Vec<String> = shape.iter().map(|n| n.map_or("n".to_owned(), |n| n.to_string())).collect();
        let message = format!("{name} has shape {found:?}; it must be ({})", words.join(", "));
        return Err(PyValueError::new_err(message));
    }
    Ok(array.iter().copied().collect())
}

/// A read-only array over `first` and the elements after it. Strides count elements of `T`.
///
/// # Safety
/// Every element of the shape is inside memory that `owner` keeps, unchanged, as long as it is referred to.
unsafe fn view<'py, T: Element, D: Dimension>(
    first: *const T,
    shape: impl Into<numpy::ndarray::StrideShape<D>>,
    owner: Bound<'py, PyAny>,
) -> Bound<'py, PyArray<T, D>> {
    // SAFETY: as required of the caller; the array is made read-only before anybody sees it.
    let array = unsafe { PyArray::borrow_from_array(&ArrayView::from_shape_ptr(shape, first), owner) };
    array.readwrite().make_nonwriteable();
    array
}

/// Numbers, shape `(n,)`.
pub(crate) fn scalars<'py, T: Element>(
    owner: Bound<'py, PyAny>,
    values: &[T],
) -> Bound<'py, PyArray<T, numpy::Ix1>> {
    // SAFETY: the slice is inside the owner.
    unsafe { view(values.as_ptr(), values.len(), owner) }
}

/// Vectors, shape `(n, 3)`.
pub(crate) fn vectors<'py>(owner: Bound<'py, PyAny>, values: &[Vec3]) -> Bound<'py, PyArray2<f64>> {
    // A vector of nalgebra is an array of its three components.
    const { assert!(size_of::<Vec3>() == 3 * size_of::<f64>()) };
    // SAFETY: the slice is inside the owner.
    unsafe { view(values.as_ptr().cast::<f64>(), (values.len(), 3), owner) }
}

/// One field of every element of `records`: `width` numbers from `field` of the first one on; shape `(n,)` for a width of 1
/// in `D = Ix1`, else `(n, width)`.
pub(crate) fn field<'py, R, T: Element, D: Dimension>(
    owner: Bound<'py, PyAny>,
    records: &[R],
    field: impl Fn(&R) -> *const T,
    shape: impl Fn(usize, usize) -> (D, D),
) -> Bound<'py, PyArray<T, D>> {
    let stride = const {
        assert!(size_of::<R>().is_multiple_of(size_of::<T>()), "a stride is a whole number of elements");
        size_of::<R>() / size_of::<T>()
    };
    let first = records.first().map_or(std::ptr::NonNull::<T>::dangling().as_ptr().cast_const(), field);
    let (dims, strides) = shape(records.len(), stride);
    // SAFETY: the records are inside the owner, and the field is inside each record. No element is read if there is none.
    unsafe { view(first, dims.strides(strides), owner) }
}

/// Shape and strides of a field with one number.
pub(crate) fn one(n: usize, stride: usize) -> (numpy::Ix1, numpy::Ix1) {
    (numpy::Ix1(n), numpy::Ix1(stride))
}

/// Shape and strides of a field with `W` numbers.
pub(crate) fn row<const W: usize>(n: usize, stride: usize) -> (numpy::Ix2, numpy::Ix2) {
    (numpy::Ix2(n, W), numpy::Ix2(stride, 1))
}

/// Vectors, shape `(n, 3)`: a new array.
pub(crate) fn copied<'py>(
    py: Python<'py>,
    vectors: impl ExactSizeIterator<Item = Vec3>,
) -> Bound<'py, PyArray2<f64>> {
    let mut array = Array2::zeros((vectors.len(), 3));
    for (mut row, vector) in array.rows_mut().into_iter().zip(vectors) {
        (row[0], row[1], row[2]) = (vector.x, vector.y, vector.z);
    }
    array.into_pyarray(py)
}

/// A square matrix: a new array.
pub(crate) fn matrix<'py>(
    py: Python<'py>,
    size: usize,
    entry: impl Fn(usize, usize) -> f64,
) -> Bound<'py, PyArray2<f64>> {
    Array2::from_shape_fn((size, size), |(i, j)| entry(i, j)).into_pyarray(py)
}
