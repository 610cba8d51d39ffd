//! Contact forces of a LAMMPS `dump local`.
//!
//! For every granular pair style, `compute pair/local` gives the normal force alone as `fx fy fz`, and the tangential
//! force as `p1 p2 p3`; both act on the first of the two grains. The expected dump:
//!
//! ```text
//! compute pl all property/local patom1 patom2
//! compute pf all pair/local dist fx fy fz p1 p2 p3
//! dump forces all local 1 forces.dump c_pl[*] c_pf[*]
//! dump_modify forces format float %.17g
//! ```
//!
//! By default the columns have the names above. Columns renamed by `dump_modify colname` to `patom1 patom2 fx
//! fy fz p1 p2 p3` are found by these names, and others by
//! [`ImportOptions::contact_columns`](super::ImportOptions::contact_columns). Pairs that do not touch, which
//! LAMMPS lists as long as they are neighbours, have no force and are left out. Of several frames, that of the step of the
//! grains is read.

use super::assemble::{self, GrainTable, Moment};
use super::contact_lists::{ListedContact, ListedForce};
use super::error::ImportError;
use super::imported::Imported;
use super::lammps_columns::{self, ForceRow};
use super::lammps_items::{Frame, full_lines, next_frame};
use super::settings::{ImportOptions, Properties};
use grainlab_core::{Cell, Vec3, contact_search};

/// Ids of the two grains, normal force, tangential force.
const BY_NUMBER: [&str; 8] =
    ["c_pl[1]", "c_pl[2]", "c_pf[2]", "c_pf[3]", "c_pf[4]", "c_pf[5]", "c_pf[6]", "c_pf[7]"];
const BY_NAME: [&str; 8] = ["patom1", "patom2", "fx", "fy", "fz", "p1", "p2", "p3"];

/// Columns that are required for forces.
const LEAST: usize = 5;

/// Tangential forces up to this fraction are rounding of the force's direction: 17 digits leave less, 6 more.
const CENTRAL: f64 = 1e-9;

struct Local<'a> {
    /// Pairs that carry force.
    contacts: Vec<ListedContact>,
    tangential: bool,
    /// Names of all columns, places of those that are read, and the rows of the contacts.
    names: Vec<&'a str>,
    columns: Vec<usize>,
    rows: Vec<ForceRow<'a>>,
}

/// The packing of these grains, with the contact forces of the options, if any, at its step.
pub(super) fn packing(
    grains: GrainTable,
    settings: &Properties,
    options: &ImportOptions,
    state: Moment,
    source: String,
) -> Result<Imported, ImportError> {
    let of_step = |text| {
        contacts(text, &options.contact_columns, state.step)
            .map_err(|e| ImportError::Invalid(format!("in the file of the contact forces: {e}")))
    };
    let forces = options.contact_forces.as_deref().map(of_step).transpose()?;
    forces.as_ref().map_or(Ok(()), |forces| forces.check(&grains, &settings.cell))?;
    let listed = forces.as_ref().map(|forces| forces.contacts.as_slice());
    let imported = assemble::packing(grains, settings, listed, state, source, Vec::new())?;
    forces.map_or(Ok(()), |forces| forces.whole(&imported))?;
    Ok(imported)
}

/// The contacts of the frame of this step, that of the grains; a dump without steps has one frame. `chosen` are the columns in
/// the default order, five or eight; none for the default ones.
fn contacts<'a>(text: &'a str, chosen: &[String], step: u64) -> Result<Local<'a>, ImportError> {
    let mut lines = full_lines(text);
    if lines.peek().is_none() {
        return Err(ImportError::empty());
    }
    let (mut steps, mut found) = (Vec::new(), None);
    while let Some(frame) = next_frame(&mut lines, "ENTRIES")? {
        steps.extend(frame.step);
        if frame.step.is_some_and(|of| of != step) {
            continue;
        }
        if found.is_some() {
            let problem = format!("a second frame of contact forces for step {step}: leave one");
            return Err(frame.head.error(problem));
        }
        found = Some(frame);
    }
    let Some(Frame { head, names, rows, .. }) = found else {
        let (some, both) = (some(&steps), "dump both at the same step");
        return Err(ImportError::Invalid(match steps.is_empty() {
            true => NEEDED.to_owned(),
            false => format!("the contact forces are of step {some} and the grains of step {step}: {both}"),
        }));
    };
    let columns = find(&names, chosen).map_err(|problem| head.error(problem))?;
    let tangential = columns.len() == BY_NAME.len();
    let mut local = Local { contacts: Vec::new(), tangential, names, columns, rows: Vec::new() };
    for line in rows {
        let words = line.words();
        let field = |k: usize| {
            let word = words.get(local.columns[k]).copied();
            word.ok_or_else(|| line.error("a column is missing"))
        };
        let normal = line.vector("force", [field(2)?, field(3)?, field(4)?])?;
        let tangential = match tangential {
            true => line.vector("tangential force", [field(5)?, field(6)?, field(7)?])?,
            false => Vec3::zeros(),
        };
        if normal == Vec3::zeros() && tangential == Vec3::zeros() {
            continue;
        }
        let ids = (line.id("first grain", field(0)?)?, line.id("second grain", field(1)?)?);
        local.rows.push(ForceRow { ids, normal, tangential, text: line.text });
        local.contacts.push(ListedContact {
            rolling: Vec3::zeros(),
            line: line.number,
            ids,
            normal: None,
            overlap: None,
            force: ListedForce::Total(normal + tangential),
        });
    }
    Ok(local)
}

impl Local<'_> {
    /// Refuses columns that have no normal and tangential force.
    fn check(&self, grains: &GrainTable, cell: &Cell) -> Result<(), ImportError> {
        let columns: Vec<&str> = self.columns.iter().map(|k| self.names[*k]).collect();
        lammps_columns::check(&self.rows, (&columns, &self.names), (grains, cell))
    }

    /// Refuses a dump without any force, although grains overlap by more than rounding; and normal forces given as the whole force: with friction and
    /// without columns of tangential forces, some force must have a tangential part.
    fn whole(&self, imported: &Imported) -> Result<(), ImportError> {
        let packing = &imported.packing;
        if self.contacts.is_empty() {
            let blur = imported.rounding.map_or(0.0, |rounding| rounding.of_overlap());
            let overlapping =
                contact_search::of_packing(packing)?.iter().filter(|c| c.overlap > blur).count();
            return if overlapping > 0 { Err(ImportError::no_forces(overlapping)) } else { Ok(()) };
        }
        let central =
            |c: &grainlab_core::Contact| c.tangential_force.norm() <= CENTRAL * c.normal_force.abs();
        let lacking = !self.tangential && packing.friction > 0.0 && packing.contacts.iter().all(central);
        if lacking {
            return Err(ImportError::Invalid(format!(
                "contact forces all point along their contacts, with a friction of {}: for granular pair styles LAMMPS gives \
                 the normal force alone as fx fy fz. Add the tangential force, p1 p2 p3: compute pl all property/local patom1 \
                 patom2, compute pf all pair/local dist fx fy fz p1 p2 p3, dump forces all local 1 forces.dump c_pl[*] c_pf[*], \
                 dump_modify forces format float %.17g; or give --friction 0 if there is none",
                packing.friction
            )));
        }
        Ok(())
    }
}

const NEEDED: &str = "columns c_pl[1] c_pl[2] c_pf[2] c_pf[3] c_pf[4] c_pf[5] c_pf[6] c_pf[7] are needed: dump local of \
    compute pl all property/local patom1 patom2 and compute pf all pair/local dist fx fy fz p1 p2 p3; name others with \
    --contact-columns";

fn once(names: &[&str], wanted: &[&str]) -> Result<(), String> {
    let twice = wanted.iter().find(|wanted| names.iter().filter(|name| name == wanted).count() > 1);
    twice.map_or(Ok(()), |name| Err(format!("the column {name} occurs twice")))
}

/// Indices of the columns, all eight or five.
fn find(names: &[&str], chosen: &[String]) -> Result<Vec<usize>, String> {
    let place = |wanted: &str| names.iter().position(|n| *n == wanted);
    if !chosen.is_empty() {
        if chosen.len() != LEAST && chosen.len() != BY_NAME.len() {
            let count = chosen.len();
            return Err(format!(
                "{count} columns are named; five or eight are needed: {}",
                BY_NAME.join(" ")
            ));
        }
        once(names, &chosen.iter().map(String::as_str).collect::<Vec<_>>())?;
        let missing = |name: &String| format!("there is no column {name}; there are: {}", names.join(" "));
        return chosen.iter().map(|name| place(name).ok_or_else(|| missing(name))).collect();
    }
    for wanted in [BY_NAME, BY_NUMBER] {
        let places: Vec<usize> = wanted.iter().map_while(|name| place(name)).collect();
        if places.len() >= LEAST {
            once(names, &wanted)?;
            let numbered = names.iter().filter(|n| n.starts_with("c_pf[")).count();
            if wanted == BY_NUMBER && places.len() < wanted.len() && numbered != 4 {
                return Err(format!(
                    "{numbered} columns c_pf[...]: dist fx fy fz and then p1 p2 p3 are expected; name the columns of the force \
                     with --contact-columns"
                ));
            }
            // A subset of the three components is not a force.
            let whole = places.len() == wanted.len();
            return Ok(places[..if whole { wanted.len() } else { LEAST }].to_vec());
        }
    }
    Err(NEEDED.to_owned())
}

/// The steps, or the first and the last of many.
fn some(steps: &[u64]) -> String {
    match steps {
        [first, second, .., last] if steps.len() > 6 => {
            format!("{first}, {second}, ... {last} ({} frames)", steps.len())
        }
        _ => steps.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
    }
}
