//! Columns of a packing in formats with named columns: the same names in each of them.

use grainlab_core::{Contact, Packing, Vec3};

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    Float(Vec<f64>),
    Unsigned(Vec<u32>),
    Signed(Vec<i32>),
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) name: &'static str,
    /// Numbers in each row.
    pub(crate) components: usize,
    pub(crate) values: Values,
}

fn scalars(name: &'static str, values: Vec<f64>) -> Column {
    Column { name, components: 1, values: Values::Float(values) }
}

fn vectors<'a>(name: &'static str, values: impl Iterator<Item = &'a Vec3>) -> Column {
    Column { name, components: 3, values: Values::Float(values.flatten().copied().collect()) }
}

fn counts(name: &'static str, components: usize, values: Vec<u32>) -> Column {
    Column { name, components, values: Values::Unsigned(values) }
}

/// Columns of the grains. Lengths in m, m/s, rad/s, kg. `position_unwrapped` is the position as held, to which the images of contacts
/// refer.
fn grains(packing: &Packing) -> Vec<Column> {
    let mut coordination = vec![0; packing.grains()];
    for contact in &packing.contacts {
        coordination[contact.i as usize] += 1;
        coordination[contact.j as usize] += 1;
    }
    let masses = packing.radii.iter().map(|r| packing.material.sphere_mass(*r)).collect();
    vec![
        scalars("radius", packing.radii.clone()),
        counts("id", 1, packing.ids.clone()),
        scalars("mass", masses),
        vectors("velocity", packing.velocities.iter()),
        vectors("angular_velocity", packing.spins.iter()),
        counts("contacts", 1, coordination),
        vectors("position_unwrapped", packing.positions.iter()),
    ]
}

/// Columns of the contacts. `pair` has ids. Forces in N, overlap in m; the normal points from the first grain to the second one, and the
/// tangential force acts on the first one. `mobilisation` is the tangential force over friction times normal force.
fn contacts(packing: &Packing) -> Vec<Column> {
    let list = &packing.contacts;
    let of = |value: fn(&Contact) -> f64| list.iter().map(value).collect::<Vec<_>>();
    let id = |index: u32| packing.ids[index as usize];
    let limited = packing.friction > 0.0 && packing.friction.is_finite();
    let mobilised = |c: &Contact| match limited {
        true => c.tangential_force.norm() / (packing.friction * c.normal_force),
        false => 0.0,
    };
    let mut columns = vec![
        counts("pair", 2, list.iter().flat_map(|c| [id(c.i), id(c.j)]).collect()),
        Column {
            name: "image",
            components: 3,
            values: Values::Signed(list.iter().flat_map(|c| c.image).map(i32::from).collect()),
        },
        scalars("overlap", of(|c| c.overlap)),
        scalars("normal_force", of(|c| c.normal_force)),
        vectors("normal", list.iter().map(|c| &c.normal)),
        vectors("tangential_force", list.iter().map(|c| &c.tangential_force)),
        scalars("mobilisation", list.iter().map(mobilised).collect()),
    ];
    if packing.law.rolling.is_some() {
        columns.push(vectors("rolling_force", list.iter().map(|c| &c.rolling_force)));
    }
    columns
}

/// Columns of the whole packing: SI units, matrices row by row, the edge vectors of the cell as columns.
pub(crate) fn state(packing: &Packing) -> Vec<Column> {
    let rows = |m: &grainlab_core::Mat3| m.transpose().as_slice().to_vec();
    vec![
        scalars("TimeValue", vec![packing.time]),
        scalars("step", vec![packing.step as f64]),
        Column { name: "cell", components: 9, values: Values::Float(rows(packing.cell.matrix())) },
        Column { name: "deformation", components: 9, values: Values::Float(rows(&packing.deformation)) },
        scalars("shear_modulus", vec![packing.material.shear_modulus]),
        scalars("poisson_ratio", vec![packing.material.poisson_ratio]),
        scalars("density", vec![packing.material.density]),
        scalars("friction", vec![packing.friction]),
        scalars("time_step", vec![packing.time_step]),
    ]
}

/// Positions folded into the cell, m.
fn folded(packing: &Packing) -> Vec<Vec3> {
    let cell = &packing.cell;
    let fold = |x: &Vec3| x - cell.matrix() * cell.fractional(x).map(f64::floor);
    packing.positions.iter().map(fold).collect()
}

/// The ends of each contact, m: the folded centre of the first grain, and from there along the branch vector.
fn ends(packing: &Packing) -> Vec<Vec3> {
    let folded = folded(packing);
    let ends = |c: &Contact| {
        let first = folded[c.i as usize];
        [first, first + packing.branch(c)]
    };
    packing.contacts.iter().flat_map(ends).collect()
}

/// A part of a packing as points and cells, which have so many consecutive points each.
pub(crate) struct Piece {
    pub(crate) points: Vec<Vec3>,
    pub(crate) cells: usize,
    pub(crate) points_per_cell: usize,
    /// `PointData` or `CellData`.
    pub(crate) place: &'static str,
    pub(crate) data: Vec<Column>,
}

impl Piece {
    /// The grains as points folded into the cell: radius, id, mass, velocities, number of contacts, position as held.
    pub(crate) fn grains(packing: &Packing) -> Self {
        let (cells, data) = (packing.grains(), grains(packing));
        Self { points: folded(packing), cells, points_per_cell: 1, place: "PointData", data }
    }

    /// The contacts as lines between centres: pair of ids, image, overlap, normal force, normal, tangential force,
    /// mobilisation.
    pub(crate) fn contacts(packing: &Packing) -> Self {
        let (cells, data) = (packing.contacts.len(), contacts(packing));
        Self { points: ends(packing), cells, points_per_cell: 2, place: "CellData", data }
    }
}
