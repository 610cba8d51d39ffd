//! A packing as CSV with a JSON sidecar.
//!
//! Rows, SI units, ids are persistent:
//!
//! - `p,id,x,y,z,radius,mass,vx,vy,vz,wx,wy,wz`, a grain;
//! - `c,i,j,nx,ny,nz,delta,fn,ftx,fty,ftz`, a contact of the grains with ids `i` and `j`: unit vector n from
//!   `j` to `i`, full overlap, and the force on `i`, fn·n + ft; with `,frx,fry,frz` after it, the elastic rolling force of
//!   a contact law with resistance to rolling.
//!
//! Lines that start with `#` are comments; one that names these columns in another order is refused. Without contact rows, contacts are found from positions.
//!
//! Sidecar keys: `G` or `shear_modulus` (Pa), `nu` or `poisson_ratio`, `density` (kg/m³), `mu_prep` or `friction` (a number, or `"inf"`), `cell` (three rows of
//! three; columns are the edge vectors, m) or `box_L` (three edges, m), and optionally `contact_law` and `contact_law_parameters` (as in
//! [`ContactLaw::new`](grainlab_core::contact::ContactLaw::new); Hertz–Mindlin without them), `step`, `time` (s),
//! `time_step` (s), `deformation` (three rows of three). `N` and `n_contacts`, the numbers of rows, are checked, and so are `units`
//! (SI) and `pbc` (periodic in all directions); `walls` and `gravity` are refused. Other keys are ignored.

use grainlab_core::Vec3;

use super::assemble::{self, GrainTable};
use super::contact_lists::{ListedContact, ListedForce};
use super::error::ImportError;
use super::imported::Imported;
use super::settings::ImportOptions;
use super::text::{Line, lines, shown};

mod sidecar;

use sidecar::Sidecar;

/// The packing of a CSV text and the text of its sidecar, if there is one.
///
/// # Errors
/// If a row or the sidecar is invalid, a quantity is missing, or contacts contradict the positions.
pub fn packing(csv: &str, sidecar: Option<&str>, options: &ImportOptions) -> Result<Imported, ImportError> {
    let sidecar = Sidecar::parse(sidecar)?;
    let settings = sidecar.known()?.complete(options)?;
    let (mut grains, mut contacts) = (GrainTable::default(), Vec::new());
    for line in lines(csv).filter(|l| !l.text.trim().is_empty()) {
        if let Some(comment) = line.text.trim_start().strip_prefix('#') {
            in_order(&line, comment)?;
            continue;
        }
        let fields: Vec<&str> = line.text.trim().split(',').collect();
        match fields.as_slice() {
            ["p", rest @ ..] => grain(&line, rest, options, &mut grains)?,
            ["c", rest @ ..] => contacts.push(contact(&line, rest)?),
            other => return Err(line.error(format!("a row starts with p or c, not {}", shown(other[0])))),
        }
    }
    sidecar.counts(grains.ids.len(), contacts.len())?;
    let listed = (!contacts.is_empty()).then_some(contacts.as_slice());
    assemble::packing(grains, &settings, listed, sidecar.state()?, "CSV".into(), Vec::new())
}

/// The columns of grains and of contacts after `p` and `c`.
const ORDERS: [(&str, &str); 2] = [
    ("particles", "id,x,y,z,radius,mass,vx,vy,vz,wx,wy,wz"),
    ("contacts", "i,j,nx,ny,nz,delta,fn,ftx,fty,ftz,frx,fry,frz"),
];

/// Refuses a comment that names columns in another order than that in which they are read.
fn in_order(line: &Line<'_>, comment: &str) -> Result<(), ImportError> {
    let Some((kind, columns)) = comment.split_once(':') else { return Ok(()) };
    let Some((_, order)) = ORDERS.iter().find(|(name, _)| *name == kind.trim()) else { return Ok(()) };
    let order: Vec<&str> = order.split(',').collect();
    let named = columns.split(',').filter_map(|column| column.split_whitespace().next());
    let named: Vec<&str> = named.skip_while(|column| ["p", "c"].contains(column)).collect();
    // A sentence has no order.
    let is_list = named.first() == Some(&order[0]);
    let elsewhere = |(k, name): &(usize, &&str)| order.get(*k) != Some(*name) && order.contains(*name);
    match named.iter().enumerate().find(elsewhere).filter(|_| is_list) {
        Some((k, name)) => Err(line.error(format!(
            "the comment names {name} as column {} of the {}; columns are {}",
            k + 1,
            kind.trim(),
            order.join(",")
        ))),
        None => Ok(()),
    }
}

fn grain(
    line: &Line<'_>,
    fields: &[&str],
    options: &ImportOptions,
    grains: &mut GrainTable,
) -> Result<(), ImportError> {
    let [id, x, y, z, radius, mass, vx, vy, vz, wx, wy, wz] = *fields else {
        let n = fields.len();
        return Err(line
            .error(format!("p is followed by id,x,y,z,radius,mass,vx,vy,vz,wx,wy,wz: 12 fields, not {n}")));
    };
    let position = line.vector("position", [x, y, z])?;
    let velocity = line.vector("velocity", [vx, vy, vz])?;
    let spin = line.vector("angular velocity", [wx, wy, wz])?;
    grains.printed.note([x, y, z], 1.0);
    grains.masses.push(line.number("mass", mass)?);
    let radius = grains.radius(Some(line.number("radius", radius)?), options)?;
    grains.push(line, line.id("id", id)?, radius, [position, velocity, spin])
}

fn contact(line: &Line<'_>, fields: &[&str]) -> Result<ListedContact, ImportError> {
    let wrong = || {
        let expected = "i,j,nx,ny,nz,delta,fn,ftx,fty,ftz, or these and frx,fry,frz: 10 or 13 fields";
        line.error(format!("c is followed by {expected}, not {}", fields.len()))
    };
    let (&[i, j, nx, ny, nz, delta, normal, ftx, fty, ftz], rest) =
        fields.split_first_chunk().ok_or_else(wrong)?;
    let rolling = match *rest {
        [] => Vec3::zeros(),
        [x, y, z] => line.vector("fr", [x, y, z])?,
        _ => return Err(wrong()),
    };
    let tangential: Vec3 = line.vector("ft", [ftx, fty, ftz])?;
    Ok(ListedContact {
        line: line.number,
        ids: (line.id("i", i)?, line.id("j", j)?),
        normal: Some(line.vector("n", [nx, ny, nz])?),
        overlap: Some(line.finite("delta", delta)?),
        force: ListedForce::Split { normal: line.finite("fn", normal)?, tangential },
        rolling,
    })
}
