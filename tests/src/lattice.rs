//! Packings that need no simulation: grains on a simple cubic lattice, each touching its six neighbours.

use grainlab_core::{Cell, contact_search};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg::Packing;

const DIAMETER: f64 = 2e-4;
const OVERLAP: f64 = 2e-8;

/// A packing of `edge`³ grains (three or more per row) at a step.
pub fn lattice(edge: usize, step: u64) -> Packing {
    let spacing = DIAMETER - OVERLAP;
    let place = |n: usize| [n / (edge * edge), n / edge % edge, n % edge].map(|k| k as f64 * spacing).into();
    let grains = edge * edge * edge;
    let cell = Cell::cube(spacing * edge as f64).unwrap_or_else(|| panic!("a cell of {edge} grains"));
    let mut packing = grainlab_core::Packing {
        step,
        time: step as f64 * 1e-6,
        friction: 0.3,
        time_step: 1e-8,
        ..grainlab_core::Packing::at_rest(
            cell,
            vec![DIAMETER / 2.0; grains],
            (0..grains).map(place).collect(),
        )
    };
    packing.contacts = contact_search::of_packing(&packing).unwrap_or_else(|e| panic!("contacts: {e}"));
    packing_message(
        &packing.validated().unwrap_or_else(|e| panic!("a packing: {e}")),
        "lattice",
        vec![1, 2, 3],
    )
}
