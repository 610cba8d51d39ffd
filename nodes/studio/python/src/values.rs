//! Quantities and messages as Python objects.

use grainlab_any_message::{Array, Message, Value as Field};
use grainlab_command::in_memory::Results;
use grainlab_console::CsvText;
use grainlab_core::quantity::{Quantity, Shape, Value};
use grainlab_results::Printed;
use numpy::IntoPyArray;
use numpy::ndarray::Array2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// The quantities of a result as a dictionary: numbers, strings, `None`, and arrays with NaN for what is unknown.
pub(crate) fn quantities<'py, R>(
    py: Python<'py>,
    table: &[Quantity<R>],
    result: &R,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for quantity in table {
        let numbers = |values: Vec<Option<f64>>| -> PyResult<Bound<'py, PyAny>> {
            let values: Vec<f64> = values.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect();
            match (quantity.shape, values.len()) {
                (Shape::Stiffness(_), 36) => {
                    let rows = Array2::from_shape_fn((6, 6), |(i, j)| values[6 * i + j]);
                    Ok(rows.into_pyarray(py).into_any())
                }
                _ => Ok(values.into_pyarray(py).into_any()),
            }
        };
        let value = match (quantity.value)(result) {
            Value::Unknown => py.None().into_bound(py),
            Value::Number(x) => x.into_pyobject(py)?.into_any(),
            Value::Count(n) => n.into_pyobject(py)?.into_any(),
            Value::Flag(yes) => yes.into_pyobject(py)?.to_owned().into_any(),
            Value::Word(word) => word.into_pyobject(py)?.into_any(),
            Value::Text(text) => text.into_pyobject(py)?.into_any(),
            Value::Numbers(values) => numbers(values)?,
            Value::Counts(counts) => counts.into_pyarray(py).into_any(),
        };
        dict.set_item(quantity.key, value)?;
    }
    Ok(dict)
}

/// Results as CSV, with the columns `status` (ok, or unknown for a row without an answer) and `reason`.
pub(crate) fn csv<R: Printed>(results: &Results<R>) -> String {
    let header = R::table(&[]).header().to_vec();
    let mut text = CsvText::default();
    text.row(header.iter().map(String::as_str).chain(["status", "reason"]));
    for result in results {
        let (cells, is_without, reason) = match result {
            Ok((found, without)) => {
                (R::table(std::slice::from_ref(found)).rows().concat(), *without, found.warnings().join("; "))
            }
            Err(reason) => (vec![String::new(); header.len()], true, reason.clone()),
        };
        let status = if is_without { "unknown" } else { "ok" };
        text.row(cells.iter().map(String::as_str).chain([status, &reason]));
    }
    text.finish()
}

/// A message as a dictionary, its arrays of numbers as numpy arrays.
pub(crate) fn message<'py>(py: Python<'py>, message: &Message) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in message.fields() {
        dict.set_item(name, field(py, value)?)?;
    }
    Ok(dict)
}

fn field<'py>(py: Python<'py>, value: &Field) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Field::Bool(v) => v.into_pyobject(py)?.to_owned().into_any(),
        Field::I8(v) => v.into_pyobject(py)?.into_any(),
        Field::U8(v) => v.into_pyobject(py)?.into_any(),
        Field::I16(v) => v.into_pyobject(py)?.into_any(),
        Field::U16(v) => v.into_pyobject(py)?.into_any(),
        Field::I32(v) => v.into_pyobject(py)?.into_any(),
        Field::U32(v) => v.into_pyobject(py)?.into_any(),
        Field::I64(v) => v.into_pyobject(py)?.into_any(),
        Field::U64(v) => v.into_pyobject(py)?.into_any(),
        Field::F32(v) => v.into_pyobject(py)?.into_any(),
        Field::F64(v) => v.into_pyobject(py)?.into_any(),
        Field::Text(text) => text.into_pyobject(py)?.into_any(),
        Field::Message(inner) => message(py, inner)?.into_any(),
        Field::Array(array) => elements(py, array)?,
    })
}

fn elements<'py>(py: Python<'py>, array: &Array) -> PyResult<Bound<'py, PyAny>> {
    Ok(match array {
        Array::Bool(v) => v.clone().into_pyarray(py).into_any(),
        Array::I8(v) => v.clone().into_pyarray(py).into_any(),
        Array::U8(v) => v.clone().into_pyarray(py).into_any(),
        Array::I16(v) => v.clone().into_pyarray(py).into_any(),
        Array::U16(v) => v.clone().into_pyarray(py).into_any(),
        Array::I32(v) => v.clone().into_pyarray(py).into_any(),
        Array::U32(v) => v.clone().into_pyarray(py).into_any(),
        Array::I64(v) => v.clone().into_pyarray(py).into_any(),
        Array::U64(v) => v.clone().into_pyarray(py).into_any(),
        Array::F32(v) => v.clone().into_pyarray(py).into_any(),
        Array::F64(v) => v.clone().into_pyarray(py).into_any(),
        Array::Text(v) => PyList::new(py, v)?.into_any(),
        Array::Message(v) => {
            let list = PyList::empty(py);
            for inner in v {
                list.append(message(py, inner)?)?;
            }
            list.into_any()
        }
    })
}
