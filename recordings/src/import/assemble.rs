//! Makes a packing from grains, settings and contacts.

use std::collections::{BTreeMap, BTreeSet};

use grainlab_core::contact_search::{self, SearchError};
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};
use grainlab_msgs::boundary::packing_header;

use super::error::ImportError;
use super::imported::Imported;
use super::setting::Setting;
use super::settings::{ImportOptions, Properties};
use super::text::{Line, digits};

/// Densities of grains, kg/m3, that are not implausible.
const DENSITIES: std::ops::RangeInclusive<f64> = 100.0..=30_000.0;

/// Grains in the order and with the ids of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct GrainTable {
    pub(super) ids: Vec<u32>,
    /// Radii of the grains, m.
    pub(super) radii: Vec<f64>,
    /// Positions of the centres, m.
    pub(super) positions: Vec<Vec3>,
    /// Velocities of the grains, m/s.
    pub(super) velocities: Vec<Vec3>,
    /// Angular velocities, rad/s.
    pub(super) spins: Vec<Vec3>,
    /// Line of each grain, counted from 1.
    pub(super) lines: Vec<usize>,
    /// Most significant digits of any coordinate as printed.
    pub(super) digits: u32,
    /// kg, where the file has them; else empty.
    pub(super) masses: Vec<f64>,
    /// Types or species of the file, if it has them.
    pub(super) kinds: BTreeSet<String>,
    /// A radius of the file that the one given replaces, and that, m.
    pub(super) replaced: Option<(f64, f64)>,
}

/// A contact as listed in a file.
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

/// Other known properties of the state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) step: u64,
    /// Simulated time, s.
    pub(super) time: f64,
    pub(super) deformation: Mat3,
    /// s; 0 if the packing is not from a grainlab simulation.
    pub(super) time_step: f64,
}

impl Moment {
    pub(super) fn at(step: u64) -> Self {
        Self { step, time: 0.0, deformation: Packing::no_reference(), time_step: 0.0 }
    }
}

impl GrainTable {
    /// The radius of a grain, m: the one given, else that of the file.
    pub(super) fn radius(
        &mut self,
        stated: Option<f64>,
        options: &ImportOptions,
    ) -> Result<f64, ImportError> {
        let radius = options.radius.or(stated).ok_or_else(|| ImportError::Missing(vec![Setting::Radius]))?;
        if let Some(stated) = stated.filter(|stated| *stated != radius) {
            self.replaced.get_or_insert((stated, radius));
        }
        Ok(radius)
    }

    /// The density, kg/m³, that the masses give, if all agree within 6 printed digits.
    pub(super) fn density(&self) -> Option<f64> {
        let volume = |radius: &f64| 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let mut all = self.masses.iter().zip(&self.radii).map(|(mass, radius)| mass / volume(radius));
        let first = all.next().filter(|_| self.masses.len() == self.radii.len())?;
        all.all(|other| (other / first - 1.0).abs() < 1e-5).then_some(first)
    }

    /// Notes on the grains of a packing with this material.
    fn notes(&self, material: &Material) -> Vec<String> {
        let other = |(mass, radius): &(&f64, &f64)| {
            is_beyond((**mass / material.sphere_mass(**radius) - 1.0).abs(), 1e-5)
        };
        let heavier = self.masses.iter().zip(&self.radii).filter(other).count();
        let masses = (heavier > 0).then(|| {
            format!("{heavier} grain(s) have another mass than density and radius give; the density is used")
        });
        let implausible = self.density().filter(|d| !DENSITIES.contains(d)).map(|density| {
            format!("masses and radii of the file give a density of {density:.3e} kg/m3: are its units SI?")
        });
        let kinds = (self.kinds.len() > 1).then(|| {
            format!(
                "the grains are of {} types in the file; they are taken to be of one material",
                self.kinds.len()
            )
        });
        let radii = self.replaced.map(|(stated, given)| {
            format!("the radii of the file, the first of them {stated} m, are replaced by the one given, {given} m")
        });
        [radii, masses, implausible, kinds].into_iter().flatten().collect()
    }

    /// Adds a grain read from `line`; vectors are position, velocity and spin.
    pub(super) fn push(
        &mut self,
        line: &Line<'_>,
        id: u32,
        radius: f64,
        [x, v, w]: [Vec3; 3],
    ) -> Result<(), ImportError> {
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(line.error(format!("the radius of grain {id} is {radius}: it must be more than 0")));
        }
        self.ids.push(id);
        self.radii.push(radius);
        self.positions.push(x);
        self.velocities.push(v);
        self.spins.push(w);
        self.lines.push(line.number);
        Ok(())
    }

    /// Records the number of digits of the coordinates.
    pub(super) fn printed(&mut self, coordinates: [&str; 3]) {
        self.digits = coordinates.into_iter().map(digits).fold(self.digits, u32::max);
    }

    /// Sorts by id: other programs list grains in any order.
    pub(super) fn sorted_by_id(self) -> Self {
        let mut order: Vec<usize> = (0..self.ids.len()).collect();
        order.sort_by_key(|&k| self.ids[k]);
        let vectors = |v: &[Vec3]| order.iter().map(|&k| v[k]).collect();
        Self {
            ids: order.iter().map(|&k| self.ids[k]).collect(),
            radii: order.iter().map(|&k| self.radii[k]).collect(),
            positions: vectors(&self.positions),
            velocities: vectors(&self.velocities),
            spins: vectors(&self.spins),
            lines: order.iter().map(|&k| self.lines[k]).collect(),
            digits: self.digits,
            masses: order.iter().filter_map(|&k| self.masses.get(k).copied()).collect(),
            kinds: self.kinds,
            replaced: self.replaced,
        }
    }

    /// Folds grains that are more than 60 cells away back into the cell: image indices end at 127.
    pub(super) fn folded_if_far(mut self, cell: &Cell) -> Self {
        for x in &mut self.positions {
            let copy = cell.fractional(x).map(f64::floor);
            if copy.amax() > 60.0 {
                *x -= cell.matrix() * copy;
            }
        }
        self
    }
}

/// True for a deviation that is more than `limit`, or NaN.
pub(super) fn is_beyond(deviation: f64, limit: f64) -> bool {
    deviation.is_nan() || deviation > limit
}

/// Length of a difference of two places to the nearest image, m.
pub(super) fn apart_in_cell(cell: &Cell, difference: &Vec3) -> f64 {
    let apart = cell.fractional(difference);
    (cell.matrix() * apart.map(|a| a - a.round())).norm()
}

/// The packing of these grains; contacts that are not listed (`None`) are found from positions.
pub(super) fn packing(
    grains: GrainTable,
    settings: &Properties,
    listed: Option<&[ListedContact]>,
    state: Moment,
    source: String,
    mut notes: Vec<String>,
) -> Result<Imported, ImportError> {
    if grains.ids.is_empty() {
        return Err(ImportError::empty());
    }
    let mut index = BTreeMap::new();
    for (k, id) in grains.ids.iter().enumerate() {
        if let Some(first) = index.insert(*id, k) {
            let [before, line] = [first, k].map(|k| grains.lines[k]);
            return Err(ImportError::twice(*id, line.max(before), line.min(before)));
        }
    }
    let printed = grains.digits;
    notes.extend(settings.notes.iter().cloned());
    notes.extend(grains.notes(&settings.material));
    let mut packing = Packing {
        step: state.step,
        time: state.time,
        cell: settings.cell,
        deformation: state.deformation,
        ids: grains.ids,
        radii: grains.radii,
        positions: grains.positions,
        velocities: grains.velocities,
        spins: grains.spins,
        contacts: Vec::new(),
        material: settings.material,
        law: settings.law,
        friction: settings.friction,
        time_step: state.time_step,
    }
    .validated()?;
    packing.contacts = match listed {
        None => {
            notes.push(
                "contacts were found from positions: normal forces by the contact law, no tangential forces"
                    .into(),
            );
            contact_search::of_packing(&packing)?
        }
        Some(listed) => {
            listed.iter().map(|c| listed_contact(&packing, &index, c)).collect::<Result<_, _>>()?
        }
    };
    notes.extend(contact_search::doubts(&packing)?);
    notes.extend(too_few_digits(printed, &packing));
    packing.contacts.sort_by_key(|c| (c.i, c.j, c.image));
    let packing = packing.validated()?.consistent()?;
    let header = packing_header(&packing);
    Ok(Imported { header, packing, step: state.step, run_state: Vec::new(), source, notes })
}

/// A warning if the rounding of printed positions changes overlaps noticeably. Programs print at least six
/// digits; fewer were typed by hand, and count as exact.
fn too_few_digits(digits: u32, packing: &Packing) -> Option<String> {
    let overlaps = packing.contacts.iter().map(|c| c.overlap);
    let mean = overlaps.sum::<f64>() / packing.contacts.len() as f64;
    let largest = packing.positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
    let rounding = 0.5 * 10f64.powi(largest.log10().floor() as i32 + 1 - digits as i32);
    ((5..=12).contains(&digits) && rounding > 1e-3 * mean).then(|| {
        format!(
            "positions have {digits} digits, so they are rounded by up to {rounding:.1e} m, {:.1} % of the mean overlap: \
             contacts, forces and stiffness are uncertain accordingly; export them with 17 digits",
            100.0 * rounding / mean
        )
    })
}

/// The contact in the convention of grainlab, checked against the positions.
fn listed_contact(
    p: &Packing,
    index: &BTreeMap<u32, usize>,
    c: &ListedContact,
) -> Result<Contact, ImportError> {
    let find = |id: u32| index.get(&id).copied().ok_or_else(|| ImportError::unknown_id(c.line, id));
    let (first, second) = (find(c.ids.0)?, find(c.ids.1)?);
    // The first grain of the file becomes i unless its index is the larger one; then all signs change.
    let swapped = first > second;
    let (i, j) = if swapped { (second, first) } else { (first, second) };
    let side = if swapped { -1.0 } else { 1.0 };
    let radii = p.radii[i] + p.radii[j];
    let apart = p.positions[j] - p.positions[i];
    // Expected image of j; without a normal, the nearest one.
    let steps = match (c.normal, c.overlap) {
        (Some(normal), overlap) => {
            let expected = normal * (-side * (radii - overlap.unwrap_or(0.0)));
            (p.cell.inverse() * (expected - apart)).map(f64::round)
        }
        (None, _) => -(p.cell.inverse() * apart).map(f64::round),
    };
    if steps.amax() > f64::from(i8::MAX) || !steps.amax().is_finite() {
        return Err(SearchError::FarImage(c.ids.0 as usize, c.ids.1 as usize).into());
    }
    let image = [steps.x as i8, steps.y as i8, steps.z as i8];
    let branch = apart + p.cell.shift(image);
    let distance = branch.norm();
    if distance == 0.0 {
        return Err(SearchError::Coincident(c.ids.0 as usize, c.ids.1 as usize).into());
    }
    let measured = branch / distance;
    let contradiction = |quantity: &str, given: f64, found: f64| {
        let (i, j) = c.ids;
        let why =
            "positions, cell and contacts are not of the same state, or have too few digits (17 are needed)";
        let what = format!("{quantity} of the contact of grains {i} and {j} is {given:e}");
        ImportError::line(c.line, format_args!("{what}, but positions give {found:e}: {why}"))
    };
    // Rounding of 17 digits: a few units in the last place of the coordinates.
    let rounding =
        16.0 * f64::EPSILON * (p.positions[i].amax() + p.positions[j].amax() + p.cell.matrix().amax());
    let overlap = c.overlap.unwrap_or(radii - distance);
    if (overlap - (radii - distance)).abs() > 1e-9 * overlap.abs() + rounding {
        return Err(contradiction("overlap (m)", overlap, radii - distance));
    }
    let normal = c.normal.map_or(measured, |n| n * -side);
    let angle = (normal - measured).norm();
    if angle > 1e-9 + rounding / distance {
        return Err(contradiction("angle of the normal (rad)", 0.0, angle));
    }
    let (normal_force, tangential_force) = match c.force {
        ListedForce::Split { normal, tangential } => (normal, tangential * side),
        ListedForce::Total(force) => {
            let on_i = force * side;
            let pressing = -on_i.dot(&normal);
            (pressing, on_i + normal * pressing)
        }
    };
    // Other codes rotate the tangential force with the contact only approximately; a wrong convention is wrong by
    // much more.
    let along = tangential_force.dot(&normal).abs();
    if along > 1e-3 * (normal_force.abs() + tangential_force.norm()) {
        return Err(contradiction("tangential force along the normal (N)", along, 0.0));
    }
    let (i, j) = (i as u32, j as u32);
    Ok(Contact { i, j, image, overlap, normal, normal_force, tangential_force, rolling_force: c.rolling })
}
