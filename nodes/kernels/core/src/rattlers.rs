//! Grains that carry no force.

use crate::packing::Packing;

/// Number of contacts that a grain needs to carry force: 2 with friction, 4 without.
pub fn min_contacts(friction: f64) -> u32 {
    if friction > 0.0 { 2 } else { 4 }
}

/// For each grain, whether it is part of the contact network of a packing; see [`backbone`].
///
/// # Panics
/// If a contact names a grain that does not exist, which [`Packing::check`] refuses.
pub fn non_rattlers(packing: &Packing) -> Vec<bool> {
    let contacts = packing.contacts.iter().map(|c| [c.i, c.j]).collect();
    backbone(packing.grains(), contacts, min_contacts(packing.friction))
}

/// For each grain, whether it is left when grains with fewer than `needed` contacts with remaining grains are removed, again
/// and again. A contact with an own image counts twice, because it touches the grain on two sides.
pub fn backbone(grains: usize, mut contacts: Vec<[u32; 2]>, needed: u32) -> Vec<bool> {
    let mut count = vec![0u32; grains];
    contacts.iter().flatten().for_each(|grain| count[*grain as usize] += 1);
    let mut left = vec![true; grains];
    loop {
        let mut removed = false;
        for (left, count) in left.iter_mut().zip(&count) {
            removed |= *left && *count < needed;
            *left &= *count >= needed;
        }
        if !removed {
            return left;
        }
        contacts.retain(|contact| {
            let [i, j] = contact.map(|grain| grain as usize);
            let stays = left[i] && left[j];
            if !stays {
                count[i] -= 1;
                count[j] -= 1;
            }
            stays
        });
    }
}
