//! Grains that carry no force.

use crate::packing::Packing;

/// Number of contacts that a grain needs to carry force: 2 with friction, 4 without.
pub fn min_contacts(friction: f64) -> u32 {
    if friction > 0.0 { 2 } else { 4 }
}

/// For each grain, whether it is part of the contact network: grains with fewer than [`min_contacts`]
/// contacts with remaining grains are removed, again and again. A contact with an own image counts twice,
/// because it touches the grain on two sides.
///
/// # Panics
/// If a contact names a grain that does not exist, which [`Packing::check`] refuses.
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
