//! Doubts about the contacts of a packing, by its positions, its law and its friction.

use super::error::SearchError;
use super::find::of_packing;
use crate::{Contact, OTHER_LAW, Packing};
use std::collections::BTreeSet;

/// Relative margin of the Coulomb limit, for rounding.
const BEYOND: f64 = 1e-3;

/// Overlaps at which the law is doubtful, planes that few contacts cross, contacts that are only in the list or only in the
/// positions, forces of another law, beyond the friction, or that pull. A sentence each; empty for a packing that its law can have
/// made.
///
/// # Errors
/// As [`super::find`].
pub fn doubts(packing: &Packing) -> Result<Vec<String>, SearchError> {
    let found = of_packing(packing)?;
    let (listed, by_position) = (keys(&packing.contacts), keys(&found));
    // Overlaps below rounding may be a contact or none.
    let rounding = 64.0 * f64::EPSILON * packing.cell.matrix().amax();
    let only = |contacts: &[Contact], others: &BTreeSet<_>, [one, many]: [&str; 2]| {
        let missing = contacts.iter().filter(|c| c.overlap > rounding && !others.contains(&key(c)));
        counted(packing, missing, [&format!("1 contact {one}"), &format!("contacts {many}")])
    };
    let beyond = packing
        .contacts
        .iter()
        .filter(|c| c.tangential_force.norm() > (1.0 + BEYOND) * packing.friction * c.normal_force.max(0.0));
    let more = format!("more tangential force than a friction of {} allows", packing.friction);
    let beyond =
        counted(packing, beyond, [&format!("1 contact carries {more}"), &format!("contacts carry {more}")]);
    let pulling = packing.contacts.iter().filter(|c| c.normal_force < 0.0);
    let found = [
        packing.overlap_warning(),
        packing.crossings_warning(),
        only(
            &found,
            &listed,
            ["overlaps by position but is not listed", "overlap by position but are not listed"],
        ),
        only(
            &packing.contacts,
            &by_position,
            ["is listed but does not overlap by position", "are listed but do not overlap by position"],
        ),
        other_law(packing),
        beyond.map(|what| format!("{what}: of another friction, or in motion")),
        counted(packing, pulling, ["1 contact pulls", "contacts pull"])
            .map(|what| format!("{what} (normal force below 0): the contact law only presses")),
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

/// Text with the number of `contacts` and the grains of the first one; `None` for an empty list.
fn counted<'a>(
    packing: &Packing,
    contacts: impl Iterator<Item = &'a Contact>,
    [one, many]: [&str; 2],
) -> Option<String> {
    let contacts: Vec<_> = contacts.collect();
    let [i, j] = contacts.first().map(|c| [c.i, c.j].map(|g| packing.ids[g as usize]))?;
    let what = if contacts.len() == 1 { one.to_owned() } else { format!("{} {many}", contacts.len()) };
    Some(format!("{what}, the first of grains {i} and {j}"))
}

fn other_law(packing: &Packing) -> Option<String> {
    let difference = packing.law_difference();
    (difference > OTHER_LAW).then(|| {
        format!(
            "normal forces differ from the contact law by {:.1} % on average: of another contact law, another material, \
             rounded positions, or in motion; the stiffness is that of {} contacts of this material",
            100.0 * difference,
            packing.law.name()
        )
    })
}
