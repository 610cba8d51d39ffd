//! Packings as rows of text with a sidecar, also for the tests of the stiffness.

use flate2::read::GzDecoder;
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};
use serde_json::Value;
use std::io::Read;

/// Contacts are in the order of the rows. Values that the sidecar lacks are those of a packing without a history. Rows `p,id,x,y,z,radius,mass,v…,w…` and `c,i,j,nx,ny,nz,delta,fn,ftx,fty,ftz`, with n from j to i and the force on i.
pub(crate) fn read(folder: &str, name: &str) -> Packing {
    let json = std::fs::read_to_string(format!("{folder}/{name}.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    let mut text = String::new();
    let file = std::fs::File::open(format!("{folder}/{name}.csv.gz")).unwrap();
    GzDecoder::new(file).read_to_string(&mut text).unwrap();
    let number = |key: &str| json[key].as_f64().unwrap();
    let matrix =
        |key: &str| json[key].is_array().then(|| Mat3::from_fn(|i, j| json[key][i][j].as_f64().unwrap()));
    let edges = || Mat3::from_diagonal(&Vec3::from_fn(|k, _| json["box_L"][k].as_f64().unwrap()));
    let cell = Cell::new(matrix("cell").unwrap_or_else(edges)).unwrap();
    let (shear_modulus, poisson_ratio, density) = (number("G"), number("nu"), number("density"));
    let mut p = Packing {
        step: json["step"].as_u64().unwrap_or(0),
        time: json["time"].as_f64().unwrap_or(0.0),
        deformation: matrix("deformation").unwrap_or_else(Mat3::identity),
        material: Material { shear_modulus, poisson_ratio, density },
        friction: number("mu_prep"),
        time_step: json["time_step"].as_f64().unwrap_or(0.0),
        ..Packing::at_rest(cell, Vec::new(), Vec::new())
    };
    let rows: Vec<(&str, Vec<f64>)> = text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .map(|line| {
            let (kind, rest) = line.split_once(',').unwrap();
            (kind, rest.split(',').map(|s| s.parse().unwrap()).collect())
        })
        .collect();
    for (_, v) in rows.iter().filter(|(kind, _)| *kind == "p") {
        p.ids.push(v[0] as u32);
        p.positions.push(Vec3::new(v[1], v[2], v[3]));
        p.radii.push(v[4]);
        p.velocities.push(Vec3::new(v[6], v[7], v[8]));
        p.spins.push(Vec3::new(v[9], v[10], v[11]));
    }
    let index: std::collections::BTreeMap<u32, usize> =
        p.ids.iter().enumerate().map(|(k, id)| (*id, k)).collect();
    for (_, v) in rows.iter().filter(|(kind, _)| *kind == "c") {
        let (i, j) = (index[&(v[0] as u32)], index[&(v[1] as u32)]);
        let apart = p.cell.fractional(&(p.positions[j] - p.positions[i]));
        let normal = -Vec3::new(v[2], v[3], v[4]);
        // The periodic image whose branch vector is parallel to the normal.
        let branch = p.cell.fractional(&(normal * (p.radii[i] + p.radii[j] - v[5])));
        let image = [0, 1, 2].map(|k| (branch[k] - apart[k]).round() as i8);
        let pressed = Contact::pressed([i as u32, j as u32], image, normal, v[5], v[6]);
        p.contacts.push(Contact { tangential_force: Vec3::new(v[7], v[8], v[9]), ..pressed });
    }
    p
}
