//! Packings that need no simulation: grains on a simple cubic lattice, each touching its six neighbours.

use grainlab_core::{Cell, Contact, Mat3, Material, Vec3};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg::Packing;

const DIAMETER: f64 = 2e-4;
const OVERLAP: f64 = 2e-8;

/// A packing of `edge`³ grains (three or more per row) at a step.
pub fn lattice(edge: usize, step: u64) -> Packing {
    let spacing = DIAMETER - OVERLAP;
    let place = |[x, y, z]: [usize; 3]| (x * edge + y) * edge + z;
    let (mut positions, mut contacts) = (Vec::new(), Vec::new());
    for n in 0..edge * edge * edge {
        let here = [n / (edge * edge), n / edge % edge, n % edge];
        positions.push(Vec3::from(here.map(|k| k as f64 * spacing)));
        for axis in 0..3 {
            let mut other = here;
            other[axis] = (here[axis] + 1) % edge;
            let (mut image, mut normal) = ([0; 3], Vec3::zeros());
            // From the grain with the lower index; across the face that is the other one.
            let wraps = other[axis] == 0;
            (image[axis], normal[axis]) = if wraps { (-1, -1.0) } else { (0, 1.0) };
            let (i, j) = if wraps { (place(other), n) } else { (n, place(other)) };
            let normal_force = Material::GLASS.normal_force(DIAMETER / 4.0, OVERLAP);
            contacts.push(Contact {
                i: i as u32,
                j: j as u32,
                image,
                overlap: OVERLAP,
                normal,
                normal_force,
                tangential_force: Vec3::zeros(),
                rolling_force: Vec3::zeros(),
            });
        }
    }
    contacts.sort_by_key(|c| (c.i, c.j, c.image));
    let grains = positions.len();
    let packing = grainlab_core::Packing {
        step,
        time: step as f64 * 1e-6,
        cell: Cell::cube(spacing * edge as f64).unwrap_or_else(|| panic!("a cell of {edge} grains")),
        deformation: Mat3::identity(),
        ids: (0..grains as u32).collect(),
        radii: vec![DIAMETER / 2.0; grains],
        positions,
        velocities: vec![Vec3::zeros(); grains],
        spins: vec![Vec3::zeros(); grains],
        contacts,
        material: Material::GLASS,
        law: Default::default(),
        friction: 0.3,
        time_step: 1e-8,
    };
    packing_message(
        &packing.validated().unwrap_or_else(|e| panic!("a packing: {e}")),
        "lattice",
        vec![1, 2, 3],
    )
}
