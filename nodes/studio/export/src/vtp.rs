//! Writes VTK XML files, which ParaView and PyVista open: grains as points, contacts as lines, and a collection of the
//! states of a run.

use crate::lammps_dump::coordination;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use grainlab_core::{Contact, Mat3, Packing, Vec3};
use std::fmt::Write as _;

/// A collection (`.pvd`): the time of each state, s, and its file.
pub(crate) fn pvd<'a>(states: impl Iterator<Item = (f64, &'a str)>) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, file) in states {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{file}\"/>");
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// The grains as points folded into the cell: radius, id, mass, velocities, number of contacts, position as held. Lengths in m, m/s,
/// rad/s, kg. The images of contacts refer to `position_unwrapped`, the position as held.
pub(crate) fn grains(packing: &Packing) -> String {
    let mass = |radius: &f64| packing.material.sphere_mass(*radius);
    file(packing, &folded(packing), 1, |data| {
        data.floats("radius", 1, packing.radii.iter().copied());
        data.array(UNSIGNED, "id", 1, packing.ids.iter().map(|id| id.to_le_bytes()));
        data.floats("mass", 1, packing.radii.iter().map(mass));
        data.vectors("velocity", &packing.velocities);
        data.vectors("angular_velocity", &packing.spins);
        data.array(UNSIGNED, "contacts", 1, coordination(packing).into_iter().map(u32::to_le_bytes));
        data.vectors("position_unwrapped", &packing.positions);
    })
}

/// The contacts as lines between centres, from the folded centre of the first grain along the branch vector. `pair` has ids. Forces in
/// N, overlap in m; the normal points from the first grain to the second one, and the tangential force acts on the first one.
/// `mobilisation` is the tangential force over friction times normal force.
pub(crate) fn contacts(packing: &Packing) -> String {
    let (list, folded) = (&packing.contacts, folded(packing));
    let ends = |c: &Contact| {
        let first = folded[c.i as usize];
        [first, first + packing.branch(c)]
    };
    let ends: Vec<Vec3> = list.iter().flat_map(ends).collect();
    let limited = packing.friction > 0.0 && packing.friction.is_finite();
    let mobilised = |c: &Contact| match limited {
        true => c.tangential_force.norm() / (packing.friction * c.normal_force),
        false => 0.0,
    };
    file(packing, &ends, 2, |data| {
        let ids = list.iter().flat_map(|c| [c.i, c.j]).map(|index| packing.ids[index as usize]);
        data.array(UNSIGNED, "pair", 2, ids.map(u32::to_le_bytes));
        data.array(
            "Int32",
            "image",
            3,
            list.iter().flat_map(|c| c.image).map(|n| i32::from(n).to_le_bytes()),
        );
        data.floats("overlap", 1, list.iter().map(|c| c.overlap));
        data.floats("normal_force", 1, list.iter().map(|c| c.normal_force));
        data.vectors("normal", list.iter().map(|c| &c.normal));
        data.vectors("tangential_force", list.iter().map(|c| &c.tangential_force));
        data.floats("mobilisation", 1, list.iter().map(mobilised));
        if packing.law.rolling.is_some() {
            data.vectors("rolling_force", list.iter().map(|c| &c.rolling_force));
        }
    })
}

/// Positions folded into the cell, m.
fn folded(packing: &Packing) -> Vec<Vec3> {
    let cell = &packing.cell;
    let fold = |x: &Vec3| x - cell.matrix() * cell.fractional(x).map(f64::floor);
    packing.positions.iter().map(fold).collect()
}

/// A file (`.vtp`) of points and cells, which have `each` consecutive points; `data` adds the arrays of the grains or contacts.
fn file(packing: &Packing, points: &[Vec3], each: usize, data: impl FnOnce(&mut Arrays)) -> String {
    let mut text = Arrays(String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n",
    ));
    // Of the whole packing: SI units, matrices row by row, the edge vectors of the cell as columns.
    let rows = |m: &Mat3| m.transpose().as_slice().to_vec();
    for (name, numbers) in [
        ("TimeValue", vec![packing.time]),
        ("step", vec![packing.step as f64]),
        ("cell", rows(packing.cell.matrix())),
        ("deformation", rows(&packing.deformation)),
        ("shear_modulus", vec![packing.material.shear_modulus]),
        ("poisson_ratio", vec![packing.material.poisson_ratio]),
        ("density", vec![packing.material.density]),
        ("friction", vec![packing.friction]),
        ("time_step", vec![packing.time_step]),
    ] {
        // A field has rows of any number, so that its numbers are its tuples.
        let tuples = format!(" NumberOfTuples=\"{}\"", numbers.len());
        text.tuples(FLOAT, name, 1, &tuples, numbers.into_iter().map(f64::to_le_bytes));
    }
    let (n, cells) = (points.len(), points.len() / each);
    let (kind, place, vertices, lines) =
        if each == 1 { ("Verts", "PointData", cells, 0) } else { ("Lines", "CellData", 0, cells) };
    text.0 += &format!(
        "</FieldData>\n<Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"{vertices}\" NumberOfLines=\"{lines}\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<{place}>\n"
    );
    data(&mut text);
    text.0 += &format!("</{place}>\n<Points>\n");
    text.vectors("Points", points);
    text.0 += &format!("</Points>\n<{kind}>\n");
    text.array("Int64", "connectivity", 1, (0..n as i64).map(i64::to_le_bytes));
    text.array("Int64", "offsets", 1, (1..=cells).map(|k| ((k * each) as i64).to_le_bytes()));
    text.0 + &format!("</{kind}>\n</Piece>\n</PolyData>\n</VTKFile>\n")
}

const FLOAT: &str = "Float64";
const UNSIGNED: &str = "UInt32";

/// The text of a file, to which arrays are added.
struct Arrays(String);

impl Arrays {
    fn floats(&mut self, name: &str, components: usize, values: impl Iterator<Item = f64>) {
        self.array(FLOAT, name, components, values.map(f64::to_le_bytes));
    }

    fn vectors<'a>(&mut self, name: &str, values: impl IntoIterator<Item = &'a Vec3>) {
        self.floats(name, 3, values.into_iter().flatten().copied());
    }

    fn array<const N: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) {
        self.tuples(kind, name, components, "", values);
    }

    /// Adds an array as Base64 of the number of bytes and of the bytes; `tuples` is its attribute of this name.
    fn tuples<const N: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        tuples: &str,
        values: impl Iterator<Item = [u8; N]>,
    ) {
        let content: Vec<u8> = values.flatten().collect();
        let header = (content.len() as u64).to_le_bytes();
        self.0 += &format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"{tuples} format=\"binary\">"
        );
        STANDARD.encode_string([&header[..], &content].concat(), &mut self.0);
        self.0.push_str("</DataArray>\n");
    }
}
