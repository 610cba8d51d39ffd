//! Makes a packing from grains, settings and contacts.

use std::collections::{BTreeMap, BTreeSet};

use grainlab_core::contact_search::{self, SearchError};
use grainlab_core::notes::texts;
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};
use grainlab_msgs::boundary::packing_header;

use super::contact_lists::{self, ListedContact, ListedForce};
use super::error::{ImportError, Setting};
use super::imported::Imported;
use super::rounding::{ALL_DIGITS, Printed, Rounding};
use super::settings::{ImportOptions, Properties};
use super::text::Line;

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
    pub(super) printed: Printed,
    /// kg, where the file has them; else empty.
    pub(super) masses: Vec<f64>,
    /// Types or species of the file, if it has them.
    pub(super) kinds: BTreeSet<String>,
    /// A radius of the file that the one given replaces, and that, m.
    pub(super) replaced: Option<(f64, f64)>,
}

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

    fn notes(&self, material: &Material) -> Vec<String> {
        let other = |(mass, radius): &(&f64, &f64)| {
            is_beyond((**mass / material.sphere_mass(**radius) - 1.0).abs(), 1e-5)
        };
        let heavier = self.masses.iter().zip(&self.radii).filter(other).count();
        let masses = (heavier > 0).then(|| {
            let density = material.density;
            format!("{heavier} grain(s) have another mass than density and radius give; the density {density} kg/m3 is used")
        });
        let implausible = self.density().filter(|d| !DENSITIES.contains(d)).map(|density| {
            format!("masses and radii of the file give a density of {density:.3e} kg/m3: are its units SI?")
        });
        let soft = material.shear_modulus_doubt();
        let soft = soft.map(|doubt| format!("the shear modulus of the grains is {doubt}"));
        let kinds = (self.kinds.len() > 1).then(|| {
            format!(
                "the grains are of {} types in the file; they are taken to be of one material",
                self.kinds.len()
            )
        });
        let radii = self.replaced.map(|(stated, given)| {
            format!("the radii of the file, the first of them {stated} m, are replaced by the one given, {given} m")
        });
        [radii, masses, implausible, soft, kinds].into_iter().flatten().collect()
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
            printed: self.printed,
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
    let rounding = grains.printed.rounding();
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
        path: None,
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
            let contacts = listed_contacts(&packing, &index, listed, rounding)?;
            let (contacts, twice) = contact_lists::once(listed, contacts)?;
            packing.contacts = contacts;
            let apart = contact_lists::leave_out_apart(&mut packing, rounding)?;
            notes.extend(twice.into_iter().chain(apart));
            contact_lists::check_forces(&packing, settings.law_is_stated)?;
            std::mem::take(&mut packing.contacts)
        }
    };
    notes.extend(texts(&contact_search::doubts(&packing)?));
    let blurred = rounding.and_then(|rounding| rounding.noticeable(&packing));
    notes.extend(blurred.map(|blurred| {
        format!("{blurred}: contacts, forces and stiffness are uncertain accordingly; {ALL_DIGITS}")
    }));
    packing.contacts.sort_by_key(|c| (c.i, c.j, c.image));
    let packing = packing.validated()?.consistent()?;
    let header = packing_header(&packing);
    Ok(Imported { header, packing, step: state.step, run_state: Vec::new(), source, rounding, notes })
}

fn listed_contacts(
    packing: &Packing,
    index: &BTreeMap<u32, usize>,
    listed: &[ListedContact],
    rounding: Option<Rounding>,
) -> Result<Vec<Contact>, ImportError> {
    let pairs = listed.iter().map(|c| Pair::new(packing, index, c)).collect::<Result<Vec<_>, _>>()?;
    let is_reversed = |(c, pair): &(&ListedContact, &Pair)| pair.is_reversed(packing, c);
    let mut reversed = listed.iter().zip(&pairs).filter(is_reversed);
    if let Some((first, _)) = reversed.next() {
        let (line, (i, j), count) = (first.line, first.ids, 1 + reversed.count());
        let what = format!(
            "the normals of {count} of {} contacts point the wrong way, the first of grains {i} and {j}: the angle to the direction \
             that positions give is pi; reverse the signs of these normals",
            listed.len()
        );
        return Err(ImportError::line(line, what));
    }
    listed.iter().zip(&pairs).map(|(c, pair)| listed_contact(packing, pair, c, rounding)).collect()
}

struct Pair {
    /// Indices of the grains, the smaller one first.
    grains: [usize; 2],
    /// -1 if the first grain of the file has the larger index, so that all signs change; else 1.
    side: f64,
    /// Sum of the radii, m.
    radii: f64,
    /// From the first grain to the second one as held, m.
    apart: Vec3,
}

/// A normal is along a line between two grains if their distance by it, over the sum of their radii, is off by less than this.
const ALONG: f64 = 1e-3;

impl Pair {
    fn new(p: &Packing, index: &BTreeMap<u32, usize>, c: &ListedContact) -> Result<Self, ImportError> {
        let find = |id: u32| index.get(&id).copied().ok_or_else(|| ImportError::unknown_id(c.line, id));
        let (first, second) = (find(c.ids.0)?, find(c.ids.1)?);
        let (i, j) = (first.min(second), first.max(second));
        let side = if first > second { -1.0 } else { 1.0 };
        let apart = p.positions[j] - p.positions[i];
        Ok(Self { grains: [i, j], side, radii: p.radii[i] + p.radii[j], apart })
    }

    /// Steps, in cell vectors, to the image of the second grain that is nearest to the place expected by this normal.
    fn steps(&self, p: &Packing, c: &ListedContact, normal: Vec3) -> Vec3 {
        let expected = normal * (-self.side * (self.radii - c.overlap.unwrap_or(0.0)));
        (p.cell.inverse() * (expected - self.apart)).map(f64::round)
    }

    /// True if the reversed normal leads to an image of the second grain, and the normal itself does not.
    fn is_reversed(&self, p: &Packing, c: &ListedContact) -> bool {
        let leads = |normal: Vec3| {
            let branch = self.apart + p.cell.matrix() * self.steps(p, c, normal);
            let expected = normal * (-self.side * (self.radii - c.overlap.unwrap_or(0.0)));
            (branch - expected).norm() <= ALONG * self.radii
        };
        c.normal.is_some_and(|normal| !leads(normal) && leads(-normal))
    }
}

/// The contact in the convention of grainlab, checked against the positions.
fn listed_contact(
    p: &Packing,
    pair: &Pair,
    c: &ListedContact,
    rounded: Option<Rounding>,
) -> Result<Contact, ImportError> {
    let Pair { grains: [i, j], side, radii, apart } = *pair;
    // Expected image of j; without a normal, the nearest one.
    let steps = match c.normal {
        Some(normal) => pair.steps(p, c, normal),
        None => -(p.cell.inverse() * apart).map(f64::round),
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
    // `blur` is the largest effect of rounded positions on the quantity.
    let contradiction = |quantity: &str, given: f64, found: f64, blur: f64| {
        let (i, j) = c.ids;
        let why = match rounded.filter(|_| (given - found).abs() <= blur) {
            Some(rounding) => format!(
                "positions have {} digits, which changes it by up to {blur:.1e}; {ALL_DIGITS}",
                rounding.digits
            ),
            None => "positions, cell and contacts are not of the same state, or have too few digits (17 are needed)".to_owned(),
        };
        let what = format!("{quantity} of the contact of grains {i} and {j} is {given:e}");
        ImportError::line(c.line, format_args!("{what}, but positions give {found:e}: {why}"))
    };
    let blur = rounded.map_or(0.0, |rounding| rounding.of_overlap());
    // Rounding of 17 digits: a few units in the last place of the coordinates.
    let rounding =
        16.0 * f64::EPSILON * (p.positions[i].amax() + p.positions[j].amax() + p.cell.matrix().amax());
    let overlap = c.overlap.unwrap_or(radii - distance);
    if (overlap - (radii - distance)).abs() > 1e-9 * overlap.abs() + rounding {
        return Err(contradiction("overlap (m)", overlap, radii - distance, blur));
    }
    let normal = c.normal.map_or(measured, |n| n * -side);
    let chord = (normal - measured).norm();
    if chord > 1e-9 + rounding / distance {
        let angle = 2.0 * (0.5 * chord).min(1.0).asin();
        return Err(contradiction("angle of the normal (rad)", 0.0, angle, blur / distance));
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
        return Err(contradiction("tangential force along the normal (N)", along, 0.0, 0.0));
    }
    let (i, j) = (i as u32, j as u32);
    Ok(Contact { i, j, image, overlap, normal, normal_force, tangential_force, rolling_force: c.rolling })
}
