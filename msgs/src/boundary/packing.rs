//! `Packing`: the complete mechanical state.

use super::check::{Check, header, row_major};
use super::earlier_path::earlier_path;
use super::error::BoundaryError;
use crate::std_msgs::Header;
use crate::{msg, stamp};
use grainlab_core::{
    Cell, Contact, EngineProgram, Mat3, Material, Packing, PathPosition, StrainOrigin, Vec3,
};

const CHECK: Check = Check("Packing");

/// The message of a packing, bit for bit. `scene` names the scene, `run_state` is needed only by a resumed
/// run. The packing must be validated.
pub fn packing_message(packing: &Packing, scene: &str, run_state: Vec<u8>) -> msg::Packing {
    let contacts = &packing.contacts;
    let rolling = contacts.iter().filter(|_| packing.law.rolling.is_some());
    msg::Packing {
        header: packing_header(packing),
        step: packing.step,
        time: packing.time,
        cell: row_major(packing.cell.matrix()),
        deformation: row_major(&packing.deformation),
        id: packing.ids.clone(),
        radius: packing.radii.clone(),
        position: interleaved(packing.positions.iter()),
        velocity: interleaved(packing.velocities.iter()),
        angular_velocity: interleaved(packing.spins.iter()),
        contact_pair: contacts.iter().flat_map(|c| [c.i, c.j]).collect(),
        contact_image: contacts.iter().flat_map(|c| c.image).collect(),
        contact_overlap: contacts.iter().map(|c| c.overlap).collect(),
        contact_normal: interleaved(contacts.iter().map(|c| &c.normal)),
        contact_normal_force: contacts.iter().map(|c| c.normal_force).collect(),
        contact_tangential_force: interleaved(contacts.iter().map(|c| &c.tangential_force)),
        contact_rolling_force: interleaved(rolling.map(|c| &c.rolling_force)),
        shear_modulus: packing.material.shear_modulus,
        poisson_ratio: packing.material.poisson_ratio,
        density: packing.material.density,
        contact_law: packing.law.name().to_owned(),
        contact_law_parameters: packing.law.parameters(),
        friction: packing.friction,
        time_step: packing.time_step,
        run_state,
        path: packing.path.iter().map(path_message).collect(),
        scene: scene.to_owned(),
    }
}

/// The header of that message, and of all its measurements.
pub fn packing_header(packing: &Packing) -> Header {
    header(stamp(packing.time))
}

impl TryFrom<&msg::Packing> for Packing {
    type Error = BoundaryError;

    fn try_from(m: &msg::Packing) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        CHECK.all_finite("cell", &m.cell)?;
        let matrix = Mat3::from_row_slice(&m.cell);
        let Some(cell) = Cell::new(matrix) else {
            let (volume, must) =
                (matrix.determinant(), "be the volume of a right-handed cell, finite and more than 0");
            return Err(CHECK.refused("cell (volume)", format_args!("{volume:?}"), must));
        };
        let law = CHECK.contact_law(&m.contact_law, &m.contact_law_parameters)?;
        let packing = Packing {
            step: m.step,
            time: m.time,
            cell,
            deformation: Mat3::from_row_slice(&m.deformation),
            ids: m.id.clone(),
            radii: m.radius.clone(),
            positions: triples("position", &m.position, m.radius.len(), THREE_PER_GRAIN)?,
            velocities: triples("velocity", &m.velocity, m.radius.len(), THREE_PER_GRAIN)?,
            spins: triples("angular_velocity", &m.angular_velocity, m.radius.len(), THREE_PER_GRAIN)?,
            contacts: contacts(m, law.rolling.is_some())?,
            material: Material {
                shear_modulus: m.shear_modulus,
                poisson_ratio: m.poisson_ratio,
                density: m.density,
            },
            law,
            friction: m.friction,
            time_step: m.time_step,
            path: path(m)?,
        };
        Ok(packing.validated()?.consistent()?)
    }
}

fn path_message(path: &PathPosition) -> msg::PathPosition {
    let engine = path.engine.clone().unwrap_or_default();
    msg::PathPosition {
        phase: path.phase as u32,
        end_of_phase: path.end_of_phase,
        strain_origin: match path.strain_origin {
            StrainOrigin::Reference => msg::PathPosition::REFERENCE,
            StrainOrigin::FirstStep => msg::PathPosition::FIRST_STEP,
            StrainOrigin::Unknown => msg::PathPosition::UNKNOWN,
        },
        engine: engine.name,
        engine_version: engine.version,
        engine_ranks: engine.ranks,
    }
}

/// Returns the path of a message. Earlier versions recorded the path in the run state alone.
fn path(m: &msg::Packing) -> Result<Option<PathPosition>, BoundaryError> {
    let path = CHECK.optional("path", &m.path, |_, path| position(path))?;
    Ok(path.or_else(|| earlier_path(&m.run_state)))
}

fn position(path: &msg::PathPosition) -> Result<PathPosition, BoundaryError> {
    let strain_origin = match path.strain_origin {
        msg::PathPosition::REFERENCE => StrainOrigin::Reference,
        msg::PathPosition::FIRST_STEP => StrainOrigin::FirstStep,
        msg::PathPosition::UNKNOWN => StrainOrigin::Unknown,
        other => {
            let allowed = "0 (reference), 1 (first step), 2 (unknown)";
            return Err(CHECK.code("path[0].strain_origin", other, allowed));
        }
    };
    let program = || EngineProgram {
        name: path.engine.clone(),
        version: path.engine_version.clone(),
        ranks: path.engine_ranks,
    };
    Ok(PathPosition {
        phase: path.phase as usize,
        end_of_phase: path.end_of_phase,
        strain_origin,
        engine: (!path.engine.is_empty()).then(program),
    })
}

const THREE_PER_GRAIN: &str = "three per grain, as many grains as radii";
const ONE_PER_CONTACT: &str = "one per contact, as many contacts as overlaps";
const TWO_PER_CONTACT: &str = "two per contact, as many contacts as overlaps";
const THREE_PER_CONTACT: &str = "three per contact, as many contacts as overlaps";
const NO_ROLLING: &str = "none, because the contact law has no resistance to rolling";

fn contacts(m: &msg::Packing, resists_rolling: bool) -> Result<Vec<Contact>, BoundaryError> {
    let count = m.contact_overlap.len();
    CHECK.length("contact_pair", m.contact_pair.len(), 2 * count, TWO_PER_CONTACT)?;
    CHECK.length("contact_image", m.contact_image.len(), 3 * count, THREE_PER_CONTACT)?;
    CHECK.length("contact_normal_force", m.contact_normal_force.len(), count, ONE_PER_CONTACT)?;
    let normals = triples("contact_normal", &m.contact_normal, count, THREE_PER_CONTACT)?;
    let tangential =
        triples("contact_tangential_force", &m.contact_tangential_force, count, THREE_PER_CONTACT)?;
    let rolling = if resists_rolling {
        triples("contact_rolling_force", &m.contact_rolling_force, count, THREE_PER_CONTACT)?
    } else {
        CHECK.length("contact_rolling_force", m.contact_rolling_force.len(), 0, NO_ROLLING)?;
        vec![Vec3::zeros(); count]
    };
    let contact = |c: usize| Contact {
        i: m.contact_pair[2 * c],
        j: m.contact_pair[2 * c + 1],
        image: [m.contact_image[3 * c], m.contact_image[3 * c + 1], m.contact_image[3 * c + 2]],
        overlap: m.contact_overlap[c],
        normal: normals[c],
        normal_force: m.contact_normal_force[c],
        tangential_force: tangential[c],
        rolling_force: rolling[c],
    };
    Ok((0..count).map(contact).collect())
}

fn triples(
    field: &'static str,
    values: &[f64],
    count: usize,
    reason: &'static str,
) -> Result<Vec<Vec3>, BoundaryError> {
    CHECK.length(field, values.len(), 3 * count, reason)?;
    Ok(values.chunks_exact(3).map(Vec3::from_column_slice).collect())
}

fn interleaved<'a>(vectors: impl Iterator<Item = &'a Vec3>) -> Vec<f64> {
    vectors.flat_map(|v| [v.x, v.y, v.z]).collect()
}
