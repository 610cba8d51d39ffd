//! A packing of 500 grains made, and its stiffness probed, by LAMMPS; the sidecar also holds a sparse direct solve.

use crate::samples::ordered;
use flate2::read::GzDecoder;
use grains::packing::Contact;
use grains::{Cell, Mat3, Material, Packing, Vec3};
use micro::{Analysis, Settings, analyse};
use nalgebra::Matrix6;
use serde_json::Value;
use std::fs;
use std::io::Read;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/golden/reference");

fn sidecar() -> Value {
    serde_json::from_str(&fs::read_to_string(format!("{FOLDER}/ref_packing_500.json")).unwrap()).unwrap()
}

fn matrix(value: &Value) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| value[i][j].as_f64().unwrap())
}

/// Rows `p,id,x,y,z,radius,mass,v…,w…` and `c,i,j,nx,ny,nz,delta,fn,ftx,fty,ftz`, with n from j to i and the force on i.
fn reference() -> Packing {
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
            };
            p.contacts.push(ordered(contact));
        }
    }
    p.contacts.sort_by_key(|c| (c.i, c.j, c.image));
    p.validated().unwrap()
}

fn analysis() -> Analysis {
    analyse(&reference(), &Settings::default()).unwrap()
}

#[test]
fn coordination_rattlers_and_fabric_are_those_of_the_reference() {
    let (a, json) = (analysis(), sidecar());
    let f = &a.fabric;
    assert_eq!((f.grains, f.contacts, f.rattlers), (500, 1277, 24));
    assert_eq!(f.k, 5.108);
    assert_eq!(f.z, 5.361344537815126);
    assert!((a.solid_fraction / json["phi"].as_f64().unwrap() - 1.0).abs() < 1e-14);
    for i in 0..3 {
        for j in 0..3 {
            // Normals are unit to 1e-16 and averaged over 1277 contacts.
            let expected = json["fabric_tensor"][i][j].as_f64().unwrap();
            assert!((f.contact_fabric.matrix()[(i, j)] - expected).abs() < 1e-14);
            let expected = json["stress_from_contacts"][i][j].as_f64().unwrap();
            // The sidecar's shears are asymmetric by 1e-3 Pa where torques do not quite balance.
            assert!((a.stress.tensor.matrix()[(i, j)] - expected).abs() < 1e-8 * a.pressure);
        }
    }
    assert!((f.mobilised - json["mobilised_fraction_gt_0p999"].as_f64().unwrap()).abs() < 1e-14);
    // The sidecar averages net forces over all 500 grains, ours over the 476 that carry; the rattlers' own are tiny.
    let unbalanced = json["unbalanced_mean"].as_f64().unwrap() * 500.0 / 476.0;
    assert!((a.unbalanced.unwrap() / unbalanced - 1.0).abs() < 1e-2);
}

/// The direct solve adds 1e-11 of the mean stiffness to its diagonal and refines five times; 1e-9 is far above what
/// either leaves.
#[test]
fn stiffness_is_that_of_a_sparse_direct_solve() {
    let m = analysis().moduli.unwrap();
    let json = sidecar();
    let affine = matrix(&json["C_affine_matrix_Pa"]);
    let error = (m.affine.0 - affine).amax() / affine[(0, 0)];
    assert!(error < 1e-12, "affine: {error:e}");
    let relaxed = matrix(&json["C_relaxed_matrix_Pa_stiffness_matrix_mu_inf"]);
    let error = (m.stiffness.0 - relaxed).amax() / relaxed[(0, 0)];
    assert!(error < 1e-9, "relaxed: {error:e}");
}

/// A probe of 1e-7 with the whole nonlinear code: it sees terms of the order of the pressure (0.1 MPa) too, and its
/// raw rows are in the order xx yy zz xy xz yz.
#[test]
fn stiffness_is_within_a_permille_of_an_explicit_probe_by_lammps() {
    let m = analysis().moduli.unwrap();
    let json = sidecar();
    let rows = ["xx", "yy", "zz", "yz", "xz", "xy"];
    let raw = Matrix6::from_fn(|i, j| {
        let order = [0, 1, 2, 5, 4, 3];
        json["lammps_static_moduli"]["raw"][rows[j]]["1e-7"][order[i]].as_f64().unwrap()
    });
    let c11 = m.stiffness.0[(0, 0)];
    let error = (m.stiffness.0 - raw).amax() / c11;
    assert!(error < 1e-3, "{error:e}\n{}\n{raw}", m.stiffness.0);
}
