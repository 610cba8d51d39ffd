//! Grains that carry no force.

use grainlab_core::Packing;

/// Contacts that a grain needs in order to carry force: 2 with friction, 4 without.
pub fn min_contacts(friction: f64) -> u32 {
    if friction > 0.0 { 2 } else { 4 }
}

/// Whether each grain takes part in the contact network: what is left after removing, again and again, grains with fewer
/// than [`min_contacts`] contacts with grains that are left. A contact with an own image counts twice,
/// as it touches the grain on two sides.
pub fn non_rattlers(packing: &Packing) -> Vec<bool> {
    let needed = min_contacts(packing.friction);
    let n = packing.grains();
    let mut neighbours = vec![Vec::new(); n];
    let mut degree = vec![0u32; n];
    for c in &packing.contacts {
        for (grain, other) in [(c.i, c.j), (c.j, c.i)] {
            neighbours[grain as usize].push(other as usize);
            degree[grain as usize] += 1;
        }
    }
    let mut left = vec![true; n];
    let mut queue: Vec<usize> = (0..n).filter(|&g| degree[g] < needed).collect();
    for &g in &queue {
        left[g] = false;
    }
    while let Some(g) = queue.pop() {
        for &other in &neighbours[g] {
            degree[other] = degree[other].saturating_sub(1);
            if left[other] && degree[other] < needed {
                left[other] = false;
                queue.push(other);
            }
        }
    }
    left
}
