//! Packings that need no simulation, and the contacts of a packing by brute force.

use grainlab_core::{Cell, Contact, Material, Packing, Stiffness, Vec3};
use nalgebra::Matrix6;

/// Diameter of the grains of [`lattice`], m.
pub const DIAMETER: f64 = 2e-4;

/// An overlap far below the diameter, m.
pub const OVERLAP: f64 = 2e-8;

/// Creates one grain per cell that touches its own images: a simple cubic lattice, or grains apart if `overlap` is not positive.
pub fn lattice(overlap: f64) -> Packing {
    let contact = |axis: usize| {
        let (mut image, mut normal) = ([0; 3], Vec3::zeros());
        (image[axis], normal[axis]) = (1, 1.0);
        let normal_force = Material::GLASS.normal_force(DIAMETER / 4.0, overlap);
        Contact::pressed([0, 0], image, normal, overlap, normal_force)
    };
    let cell = Cell::cube(DIAMETER - overlap).unwrap_or_else(|| panic!("no cell for {overlap}"));
    Packing {
        step: 12,
        time: 0.5,
        contacts: if overlap > 0.0 { [2, 1, 0].map(contact).to_vec() } else { Vec::new() },
        friction: 0.3,
        time_step: 1e-8,
        ..Packing::at_rest(cell, vec![DIAMETER / 2.0], vec![Vec3::zeros()])
    }
    .validated()
    .unwrap_or_else(|e| panic!("a lattice of {overlap}: {e}"))
}

/// The four sites of a face-centred cubic cell, in edges.
pub const FACE_CENTRED: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];

/// Returns the stiffness of a cubic crystal along its edges, Pa.
pub fn cubic(c11: f64, c12: f64, c44: f64) -> Stiffness {
    Stiffness(Matrix6::from_fn(|i, j| match (i == j, i < 3, j < 3) {
        (true, true, _) => c11,
        (true, false, _) => c44,
        (false, true, true) => c12,
        _ => 0.0,
    }))
}

/// Returns ρ v² of the mode along `direction` whose motion is nearest to `motion`, Pa, and cos² of the angle between the two.
pub fn mode_nearest(stiffness: &Stiffness, direction: &Vec3, motion: &Vec3) -> (f64, f64) {
    let waves = stiffness.plane_waves(direction);
    let modes = waves.moduli.into_iter().zip(waves.polarizations.map(|p| p.dot(motion).powi(2)));
    modes.reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap_or_default()
}

/// Grains i and j, and the image of j, of each contact.
pub type Keys = Vec<(u32, u32, [i8; 3])>;

/// Returns the keys of contacts.
pub fn keys(contacts: &[Contact]) -> Keys {
    contacts.iter().map(|c| (c.i, c.j, c.image)).collect()
}

/// Returns every pair that touches, over all images that can: |f_k + n_k| ≤ reach/width_k for fractional distances f.
pub fn touching(cell: &Cell, x: &[Vec3], radii: &[f64]) -> Keys {
    let mut out = Keys::new();
    for i in 0..x.len() {
        for j in i..x.len() {
            let d = x[j] - x[i];
            let (f, reach) = (cell.fractional(&d), radii[i] + radii[j]);
            let range = |k: usize| {
                let r = reach / cell.width(k) + 1e-9;
                (-f[k] - r).ceil() as i8..=(-f[k] + r).floor() as i8
            };
            for a in range(0) {
                for b in range(1) {
                    for c in range(2) {
                        let image = [a, b, c];
                        if (i < j || image > [0, 0, 0]) && (d + cell.shift(image)).norm() < reach {
                            out.push((i as u32, j as u32, image));
                        }
                    }
                }
            }
        }
    }
    out.sort_unstable();
    out
}
