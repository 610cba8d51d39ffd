//! Doubts about the contacts of a packing, by its positions, its law and its friction.

use super::error::SearchError;
use super::find::of_packing;
use crate::notes::Note;
use crate::{Contact, OTHER_LAW, Packing};
use std::collections::BTreeSet;

/// Relative margin of the Coulomb limit, for rounding.
const BEYOND: f64 = 1e-3;

/// Overlaps at which the law is doubtful, planes that few contacts cross, contacts that are only in the list or only in the
/// positions, forces of another law, beyond the friction, or that pull. A note each; none for a packing that its law can have
/// made.
///
/// # Errors
/// As [`super::find`].
pub fn doubts(packing: &Packing) -> Result<Vec<Note>, SearchError> {
    let found = of_packing(packing)?;
    let (listed, by_position) = (keys(&packing.contacts), keys(&found));
    // Overlaps below rounding may be a contact or none.
    let rounding = 64.0 * f64::EPSILON * packing.cell.matrix().amax();
    let only = |contacts: &[Contact], others: &BTreeSet<_>| {
        count(packing, contacts.iter().filter(|c| c.overlap > rounding && !others.contains(&key(c))))
    };
    let limit = |c: &Contact| (1.0 + BEYOND) * packing.friction * c.normal_force.max(0.0);
    let beyond = count(packing, packing.contacts.iter().filter(|c| c.tangential_force.norm() > limit(c)));
    let pulling = count(packing, packing.contacts.iter().filter(|c| c.normal_force < 0.0));
    let difference = packing.law_difference();
    let found = [
        packing.overlap_note(),
        packing.crossings_note(),
        only(&found, &listed).map(|[n, i, j]| Note::not_listed(n, i, j)),
        only(&packing.contacts, &by_position).map(|[n, i, j]| Note::not_touching(n, i, j)),
        (difference > OTHER_LAW).then(|| Note::other_forces(packing.law.name(), difference)),
        beyond.map(|[n, i, j]| Note::beyond_friction(n, packing.friction, i, j)),
        pulling.map(|[n, i, j]| Note::pulling(n, i, j)),
    ];
    Ok(found.into_iter().flatten().collect())
}

/// A contact of a grain with its own image may be listed under either of two images.
fn key(c: &Contact) -> (u32, u32, [i8; 3]) {
    let opposite = c.image.map(i8::saturating_neg);
    (c.i, c.j, if c.i == c.j { c.image.max(opposite) } else { c.image })
}

fn keys(contacts: &[Contact]) -> BTreeSet<(u32, u32, [i8; 3])> {
    contacts.iter().map(key).collect()
}

/// Returns the number of `contacts` and the ids of the grains of the first one; `None` without contacts.
fn count<'a>(packing: &Packing, mut contacts: impl Iterator<Item = &'a Contact>) -> Option<[f64; 3]> {
    let first = contacts.next()?;
    let [i, j] = [first.i, first.j].map(|grain| f64::from(packing.ids[grain as usize]));
    Some([1.0 + contacts.count() as f64, i, j])
}
