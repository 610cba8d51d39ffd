//! The packing of 500 grains from LAMMPS, and its sidecar.

use crate::samples::ordered;
use flate2::read::GzDecoder;
use grainlab_core::Contact;
use grainlab_core::{Cell, Mat3, Material, Packing, Vec3};
use nalgebra::Matrix6;
use serde_json::Value;
use std::fs;
use std::io::Read;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/golden/reference");

pub(crate) fn sidecar() -> Value {
    serde_json::from_str(&fs::read_to_string(format!("{FOLDER}/ref_packing_500.json")).unwrap()).unwrap()
}

pub(crate) fn matrix(value: &Value) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| value[i][j].as_f64().unwrap())
}

/// The reference packing: rows `p,id,x,y,z,radius,mass,v…,w…` and `c,i,j,nx,ny,nz,delta,fn,ftx,fty,ftz`, with n from j to i and the force on i.
pub(crate) fn reference() -> Packing {
    let json = sidecar();
    let file = fs::File::open(format!("{FOLDER}/ref_packing_500.csv.gz")).unwrap();
    let mut text = String::new();
    GzDecoder::new(file).read_to_string(&mut text).unwrap();
    let edge = Vec3::from_fn(|k, _| json["box_L"][k].as_f64().unwrap());
    let number = |name: &str| json[name].as_f64().unwrap();
    let mut p = Packing {
        step: 0,
        time: 0.0,
        cell: Cell::new(Mat3::from_diagonal(&edge)).unwrap(),
        deformation: Mat3::identity(),
        ids: Vec::new(),
        radii: Vec::new(),
        positions: Vec::new(),
        velocities: Vec::new(),
        spins: Vec::new(),
        contacts: Vec::new(),
        material: Material {
            shear_modulus: number("G"),
            poisson_ratio: number("nu"),
            density: number("density"),
        },
        law: Default::default(),
        friction: number("mu_prep"),
        time_step: 0.0,
    };
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        let (kind, rest) = line.split_once(',').unwrap();
        let v: Vec<f64> = rest.split(',').map(|s| s.parse().unwrap()).collect();
        if kind == "p" {
            assert_eq!(v[0] as usize, p.ids.len() + 1);
            p.ids.push(v[0] as u32);
            p.positions.push(Vec3::new(v[1], v[2], v[3]));
            p.radii.push(v[4]);
            p.velocities.push(Vec3::new(v[6], v[7], v[8]));
            p.spins.push(Vec3::new(v[9], v[10], v[11]));
        } else {
            let (i, j) = (v[0] as usize - 1, v[1] as usize - 1);
            let apart = (p.positions[j] - p.positions[i]).component_div(&edge);
            let contact = Contact {
                i: i as u32,
                j: j as u32,
                image: [0, 1, 2].map(|k| -apart[k].round() as i8),
                overlap: v[5],
                normal: -Vec3::new(v[2], v[3], v[4]),
                normal_force: v[6],
                tangential_force: Vec3::new(v[7], v[8], v[9]),
                rolling_force: Vec3::zeros(),
            };
            p.contacts.push(ordered(contact));
        }
    }
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
