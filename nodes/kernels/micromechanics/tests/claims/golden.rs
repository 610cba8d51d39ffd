//! The packing of 500 grains from LAMMPS, and its sidecar.

use grainlab_core::Packing;
use grainlab_testkit::golden;
use nalgebra::Matrix6;
use serde_json::Value;

pub(crate) fn sidecar() -> Value {
    golden::json("reference/ref_packing_500.json")
}

pub(crate) fn matrix(value: &Value) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| value[i][j].as_f64().unwrap())
}

/// The reference packing, each contact with i ≤ j, in order.
pub(crate) fn reference() -> Packing {
    let mut p = golden::packing("reference/ref_packing_500");
    p.contacts = p.contacts.into_iter().map(|c| c.named(c.i, c.j, c.image)).collect();
    p.contacts.sort_by_key(|c| (c.i, c.j, c.image));
    p.validated().unwrap()
}

/// Columns for LAMMPS's strains of +`amplitude` (spelled as in the sidecar), Pa, Voigt order. Its raw rows
/// are in the order xx yy zz xy xz yz.
pub(crate) fn lammps(amplitude: &str) -> Matrix6<f64> {
    let columns = ["xx", "yy", "zz", "yz", "xz", "xy"];
    let order = [0, 1, 2, 5, 4, 3];
    let raw = &sidecar()["lammps_static_moduli"]["raw"];
    Matrix6::from_fn(|i, j| raw[columns[j]][amplitude][order[i]].as_f64().unwrap())
}
