//! Contacts listed in a file, and their checks: each contact once, with forces of the stated contact law.

use grainlab_core::{Contact, OTHER_LAW, Packing, Vec3};

use super::error::ImportError;
use super::rounding::{ALL_DIGITS, Rounding};

#[derive(Clone, Copy, Debug)]
pub(super) struct ListedContact {
    pub(super) line: usize,
    /// Ids of the two grains, in the file's order.
    pub(super) ids: (u32, u32),
    /// Unit vector from the second to the first grain, if the file has it.
    pub(super) normal: Option<Vec3>,
    /// m, if the file has it.
    pub(super) overlap: Option<f64>,
    /// On the first grain, N.
    pub(super) force: ListedForce,
    /// Elastic rolling force, N; the same seen from either grain.
    pub(super) rolling: Vec3,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum ListedForce {
    /// Along the normal, and across it.
    Split {
        normal: f64,
        tangential: Vec3,
    },
    Total(Vec3),
}

/// Forces of one contact, listed from both grains, are equal up to this share: six printed digits.
const SAME_FORCE: f64 = 1e-5;

/// Sums of normal forces that differ by less than this factor may belong to a packing in motion, or to grains of almost this
/// material, and only have a note.
const OTHER_FORCES: f64 = 10.0;

/// Force over the mean force up to which a contact without overlap is of no importance.
const NEGLIGIBLE: f64 = 1e-3;

/// Error of an overlap from positions with all their digits, over the largest edge of the cell.
const EXACT: f64 = 64.0 * f64::EPSILON;

/// Units of length other than m, in m.
const UNITS: [(&str, f64); 3] = [("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6)];

/// Relative difference of sums of forces that are of one unit.
const SAME_UNIT: f64 = 0.1;

/// Sorts the contacts of `listed`, which `contacts` has in its order, and notes those listed from both grains.
/// A contact that is listed twice is an error, unless from both grains and with equal and opposite forces.
pub(super) fn once(
    listed: &[ListedContact],
    contacts: Vec<Contact>,
) -> Result<(Vec<Contact>, Option<String>), ImportError> {
    let mut all: Vec<(&ListedContact, Contact)> = listed.iter().zip(contacts).collect();
    all.sort_by_key(|(_, c)| key(c));
    let (mut found, mut twice) = (Vec::<(&ListedContact, Contact)>::with_capacity(all.len()), 0);
    for (row, contact) in all {
        let Some((first, before)) = found.last().filter(|(_, before)| key(before) == key(&contact)) else {
            found.push((row, contact));
            continue;
        };
        let is_reversed = row.ids == (first.ids.1, first.ids.0)
            && (row.ids.0 != row.ids.1 || before.image != contact.image);
        let other = if before.image == contact.image { contact } else { seen_from_image(contact) };
        if !is_reversed || !has_same_force(before, &other) {
            return Err(repeated(row, first, is_reversed));
        }
        twice += 1;
    }
    let note = (twice > 0).then(|| match twice {
        1 => "1 contact is listed from both of its grains, and was taken once".to_owned(),
        n => format!("{n} contacts are listed from both of their grains, and were taken once"),
    });
    Ok((found.into_iter().map(|(_, contact)| contact).collect(), note))
}

/// The order of contacts, in which both names of a contact with an own image are the same.
fn key(c: &Contact) -> (u32, u32, [i8; 3]) {
    let opposite = c.image.map(i8::saturating_neg);
    (c.i, c.j, if c.i == c.j { c.image.max(opposite) } else { c.image })
}

/// A contact of a grain with an own image, seen from the image.
fn seen_from_image(c: Contact) -> Contact {
    Contact {
        image: c.image.map(i8::saturating_neg),
        normal: -c.normal,
        tangential_force: -c.tangential_force,
        rolling_force: -c.rolling_force,
        ..c
    }
}

fn has_same_force(a: &Contact, b: &Contact) -> bool {
    let size = a.normal_force.hypot(a.tangential_force.norm());
    let difference =
        (a.normal_force - b.normal_force).hypot((a.tangential_force - b.tangential_force).norm());
    difference <= SAME_FORCE * size
}

fn repeated(row: &ListedContact, first: &ListedContact, is_reversed: bool) -> ImportError {
    let ((a, b), (line, before)) = (row.ids, (row.line.max(first.line), row.line.min(first.line)));
    let what = match is_reversed {
        true => "from both grains, and the two forces are not equal and opposite",
        false => "twice",
    };
    // Without normals, contacts through two images of a grain have one name.
    let reason = match row.normal {
        Some(_) => "list each contact once",
        None => {
            "list each contact once; a dump local does not state the periodic image, so the cell must be larger than two grains"
        }
    };
    ImportError::line(
        line,
        format_args!("the contact of grains {a} and {b} is listed {what}, first in line {before}: {reason}"),
    )
}

/// Leaves out contacts that do not overlap because of rounding, and notes it.
/// One that carries more than next to nothing, or is farther apart than rounding explains, is an error.
pub(super) fn leave_out_apart(
    packing: &mut Packing,
    rounding: Option<Rounding>,
) -> Result<Option<String>, ImportError> {
    let (apart, touching): (Vec<Contact>, Vec<Contact>) =
        packing.contacts.iter().copied().partition(|c| c.overlap <= 0.0);
    let force = |c: &Contact| c.normal_force.hypot(c.tangential_force.norm());
    let contacts = packing.contacts.len();
    let mean = packing.contacts.iter().map(force).sum::<f64>().max(f64::MIN_POSITIVE) / contacts as f64;
    let Some(strongest) = apart.iter().max_by(|a, b| force(a).total_cmp(&force(b))).copied() else {
        return Ok(None);
    };
    let blur = rounding.map_or(0.0, |r| r.of_overlap()).max(EXACT * packing.cell.matrix().amax());
    let is_rounding = apart.iter().all(|c| -c.overlap <= blur);
    packing.contacts = touching;
    if is_rounding && force(&strongest) <= NEGLIGIBLE * mean {
        return Ok(Some(format!(
            "{} of {contacts} contacts do not overlap by the rounded positions, and were left out: each carries at most {:.1e} of the \
             mean force",
            apart.len(),
            force(&strongest) / mean
        )));
    }
    let cause = match rounding.filter(|_| is_rounding) {
        Some(rounding) => format!(
            "{rounding} and overlaps by up to {:.1e} m, and do not hold the overlaps of these forces; {ALL_DIGITS}",
            rounding.of_overlap()
        ),
        None => "positions and forces are not of the same state".to_owned(),
    };
    let [i, j] = [strongest.i, strongest.j].map(|g| packing.ids[g as usize]);
    Err(ImportError::Invalid(format!(
        "{} of {contacts} contacts carry a force although their grains do not overlap by position; the strongest, of grains {i} \
         and {j}, has {:.3e} N across a gap of {:.1e} m: {cause}",
        apart.len(),
        strongest.normal_force,
        -strongest.overlap
    )))
}

/// Returns the unit other than m in which the lengths of `packing` give its normal forces, which are `ratio` times the law.
fn unit_of_lengths(packing: &Packing, ratio: f64) -> Option<&'static str> {
    let sum = |scale: f64| -> f64 {
        let force = |c: &Contact| {
            let (radius, overlap) = (packing.effective_radius(c), c.overlap.max(0.0));
            packing.law.normal_force(&packing.material, scale * radius, scale * overlap)
        };
        packing.contacts.iter().map(force).sum::<f64>()
    };
    let fits = |(_, scale): &&(&str, f64)| (ratio * sum(1.0) / sum(*scale) - 1.0).abs() <= SAME_UNIT;
    UNITS.iter().find(fits).map(|(unit, _)| *unit)
}

/// Fails if no contact carries a force, all forces have the wrong sign, or the law is only assumed and cannot give them.
pub(super) fn check_forces(packing: &Packing, law_is_stated: bool) -> Result<(), ImportError> {
    let is_zero = |c: &Contact| c.normal_force == 0.0 && c.tangential_force.norm() == 0.0;
    if !packing.contacts.is_empty() && packing.contacts.iter().all(is_zero) {
        return Err(ImportError::no_forces(packing.contacts.len()));
    }
    let Some(found) = packing.compare_with_law() else { return Ok(()) };
    let law = packing.law.name();
    if let Some(pulling) = found.reversed {
        return Err(ImportError::Invalid(format!(
            "{pulling} of {} contacts pull although the grains overlap, and {law} contacts only press: the forces have the wrong \
             sign, because they act on the second grain of each contact. Reverse the signs of all forces; for a LAMMPS dump local, \
             exchange the columns of the two ids by --contact-columns (contact_columns in [start] of a scene)",
            packing.contacts.len()
        )));
    }
    let is_far = !(1.0 / OTHER_FORCES..=OTHER_FORCES).contains(&found.ratio);
    let is_other = found.linear_stiffness.is_some() && packing.law_difference() > OTHER_LAW;
    if !law_is_stated && (is_far || is_other) {
        let lengths = unit_of_lengths(packing, found.ratio).filter(|_| is_far);
        return Err(ImportError::Invalid(other_law(law, found.ratio, found.linear_stiffness, lengths)));
    }
    Ok(())
}

/// Says that the forces are `ratio` times those of the assumed law, and which law (linear springs) or unit of length explains them.
fn other_law(law: &str, ratio: f64, linear_stiffness: Option<f64>, lengths: Option<&str>) -> String {
    // Factors of units need as many digits before the point as after it.
    let times = if (0.01..1e4).contains(&ratio) { format!("{ratio:.3}") } else { format!("{ratio:.2e}") };
    let what = format!(
        "the file states no contact law, and its normal forces are {times} times those of {law} contacts with these overlaps and \
         this material"
    );
    if let Some(unit) = lengths {
        return format!(
            "{what}. They are those of {law} contacts if its lengths are in {unit}: convert positions, radii, overlaps and cell to m"
        );
    }
    let elsewhere = "in a scene, give the law under [contact]; beside a CSV, as contact_law in its JSON";
    match linear_stiffness {
        Some(k_n) => format!(
            "{what}. They are proportional to the overlap, as those of linear springs with k_n = {k_n:.4e} N/m: give \
             --contact-law linear:{k_n:.4e},RATIO, where RATIO is k_t/k_n ({elsewhere})"
        ),
        None => format!(
            "{what}: they belong to another contact law, or the shear modulus is not that of the grains. Give --contact-law, or \
             --shear-modulus; --contact-law {law} measures the packing as it is ({elsewhere})"
        ),
    }
}
