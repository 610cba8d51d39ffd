//! Packings for the tests.

use grainlab_core::results::ElasticStiffness;
use grainlab_core::{Cell, Contact, Mat3, Material, OVERLAP_LIMIT, Packing, Vec3, contact_search};
use grainlab_micromechanics::network::{SpringNetwork, Springs};
use grainlab_micromechanics::{PackingView, Settings, analyze};
use grainlab_testkit::Random;

/// The stiffness by these settings.
pub(crate) fn solved(p: &Packing, settings: &Settings) -> ElasticStiffness {
    analyze(p, settings).unwrap().report.stiffness().copied().unwrap()
}

/// The stiffness with these springs.
pub(crate) fn with_springs(p: &Packing, springs: Springs) -> ElasticStiffness {
    solved(p, &Settings { springs, ..Settings::default() })
}

pub(crate) fn network(p: &Packing, springs: Springs) -> SpringNetwork {
    SpringNetwork::new(&PackingView::new(p).unwrap(), springs).unwrap()
}

/// A packing of spheres of one radius at `positions`, with all contacts in `cell` (images up to one cell
/// away). With `uniform`, every contact has that overlap, so that all springs are equal.
pub(crate) fn packing(
    cell: Cell,
    positions: Vec<Vec3>,
    radius: f64,
    friction: f64,
    uniform: Option<f64>,
) -> Packing {
    let radii = vec![radius; positions.len()];
    packing_of_sizes(cell, positions, radii, friction, uniform)
}

/// Packing with spheres of these radii.
pub(crate) fn packing_of_sizes(
    cell: Cell,
    positions: Vec<Vec3>,
    radii: Vec<f64>,
    friction: f64,
    uniform: Option<f64>,
) -> Packing {
    let n = positions.len();
    let mut packing = Packing {
        step: 7,
        time: 0.5,
        ids: (1..=n as u32).collect(),
        friction,
        ..Packing::at_rest(cell, radii, positions)
    };
    packing.contacts = contact_search::of_packing(&packing).expect("grains apart");
    // Grains at random overlap more than grains may: all springs are softened alike.
    let deepest = packing.overlaps().map_or(0.0, |overlaps| overlaps.largest);
    let share = if deepest > OVERLAP_LIMIT { 0.9 * OVERLAP_LIMIT / deepest } else { 1.0 };
    for k in 0..packing.contacts.len() {
        let r_eff = packing.effective_radius(&packing.contacts[k]);
        let c = &mut packing.contacts[k];
        c.overlap *= share;
        c.normal_force = Material::GLASS.normal_force(r_eff, c.overlap);
    }
    if let Some(overlap) = uniform {
        for k in 0..packing.contacts.len() {
            let r_eff = packing.effective_radius(&packing.contacts[k]);
            let c = &mut packing.contacts[k];
            (c.overlap, c.normal_force) = (overlap, Material::GLASS.normal_force(r_eff, overlap));
        }
    }
    packing.validated().expect("a sample is a packing")
}

/// `grains` spheres placed at random in a cube, no closer than 0.8 diameters, then enlarged by `swell`: not
/// in equilibrium, but a network with every kind of grain, from no contact to a dozen.
pub(crate) fn random(grains: usize, swell: f64, seed: u64) -> Packing {
    let mut dice = Random::new(seed);
    let diameter = 2.0e-4;
    let edge = diameter * (grains as f64 * std::f64::consts::FRAC_PI_6 / 0.45).cbrt();
    let cell = Cell::new(Mat3::new(edge, 0.2 * edge, 0.0, 0.0, edge, -0.1 * edge, 0.0, 0.0, edge)).unwrap();
    let positions = places(&cell, &vec![0.4 * diameter; grains], &mut dice);
    packing(cell, positions, 0.5 * swell * diameter, 0.1, None)
}

/// Places of spheres of these radii without overlap, drawn one after the other.
pub(crate) fn places(cell: &Cell, radii: &[f64], dice: &mut Random) -> Vec<Vec3> {
    let mut positions: Vec<Vec3> = Vec::new();
    while positions.len() < radii.len() {
        let x = cell.matrix() * Vec3::new(dice.unit(), dice.unit(), dice.unit());
        let clear = positions.iter().zip(radii).all(|(y, r)| {
            let mut s = cell.fractional(&(x - y));
            s.apply(|v| *v -= v.round());
            (cell.matrix() * s).norm() > r + radii[positions.len()]
        });
        if clear {
            positions.push(x);
        }
    }
    positions
}

/// The packing without its weakest contacts, with a mean coordination number of `coordination`.
pub(crate) fn thinned(p: &Packing, coordination: f64) -> Packing {
    let mut out = p.clone();
    let kept = (0.5 * coordination * p.grains() as f64).round() as usize;
    assert!(kept < p.contacts.len(), "nothing to take away");
    let mut overlaps: Vec<f64> = p.contacts.iter().map(|c| c.overlap).collect();
    overlaps.sort_by(f64::total_cmp);
    let least = overlaps[overlaps.len() - kept];
    out.contacts.retain(|c| c.overlap >= least);
    out.validated().expect("fewer contacts are a packing, too")
}

/// The rotated packing.
pub(crate) fn turned(p: &Packing, rotation: &Mat3) -> Packing {
    let mut out = p.clone();
    out.cell = Cell::new(rotation * p.cell.matrix()).unwrap();
    out.positions.iter_mut().for_each(|x| *x = rotation * *x);
    for c in &mut out.contacts {
        c.normal = rotation * c.normal;
        c.tangential_force = rotation * c.tangential_force;
    }
    out.validated().expect("a turned packing is a packing")
}

/// A contact between its own two grains.
pub(crate) struct Pair {
    pub(crate) normal: Vec3,
    /// Distance of the centres, m.
    pub(crate) branch: f64,
    pub(crate) overlap: f64,
    pub(crate) normal_force: f64,
    /// On the second grain.
    pub(crate) tangential_force: Vec3,
}

impl Pair {
    /// Along `normal`, with a force of 1 N.
    pub(crate) fn along(normal: Vec3) -> Self {
        Self { normal, branch: 2e-4, overlap: 1e-8, normal_force: 1.0, tangential_force: Vec3::zeros() }
    }
}

/// Contacts of any directions and forces, each between two grains without other contacts, placed at random in
/// a cube of 1 cm³: for measurements of structure, not mechanically stable.
pub(crate) fn pairs(contacts: &[Pair], seed: u64) -> Packing {
    let mut dice = Random::new(seed);
    let cell = Cell::cube(0.01).unwrap();
    let mut p = Packing { friction: 0.5, ..Packing::at_rest(cell, Vec::new(), Vec::new()) };
    for (k, pair) in contacts.iter().enumerate() {
        let place = Vec3::from_fn(|_, _| 0.01 * dice.unit());
        for (half, offset) in [0.0, pair.branch].into_iter().enumerate() {
            p.ids.push((2 * k + half + 1) as u32);
            p.radii.push(0.5 * (pair.branch + pair.overlap));
            p.positions.push(place + pair.normal * offset);
            p.velocities.push(Vec3::zeros());
            p.spins.push(Vec3::zeros());
        }
        let grains = [2 * k as u32, 2 * k as u32 + 1];
        let pressed = Contact::pressed(grains, [0; 3], pair.normal, pair.overlap, pair.normal_force);
        p.contacts.push(Contact { tangential_force: -pair.tangential_force, ..pressed });
    }
    p.validated().expect("pairs are a packing")
}

/// Directions about z whose cosine x has the cumulative distribution `cumulative` on [0, 1], drawn from `dice`.
pub(crate) fn drawn(dice: &mut Random, count: usize, cumulative: impl Fn(f64) -> f64) -> Vec<Vec3> {
    (0..count)
        .map(|_| {
            let side = if dice.unit() < 0.5 { -1.0 } else { 1.0 };
            direction(inverse(&cumulative, dice.unit()) * side, dice.unit())
        })
        .collect()
}

/// Directions without scatter: uniform in x and about z.
pub(crate) fn spread(count: usize, cumulative: impl Fn(f64) -> f64) -> Vec<Vec3> {
    (0..count)
        .map(|k| {
            let x = inverse(&cumulative, (k as f64 + 0.5) / count as f64);
            direction(x, (k as f64 * 0.618_033_988_749_895).fract())
        })
        .collect()
}

/// Cumulative distribution of x = |n·z| for A(d) of Eq. 6.
pub(crate) fn eq6(eps: f64) -> impl Fn(f64) -> f64 {
    move |x| (1.0 - eps) * x + eps * x.powi(3)
}

fn inverse(cumulative: &impl Fn(f64) -> f64, share: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-15 {
        let x = 0.5 * (low + high);
        if cumulative(x) < share { low = x } else { high = x }
    }
    0.5 * (low + high)
}

fn direction(x: f64, turn: f64) -> Vec3 {
    let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
    let flat = (1.0 - x * x).max(0.0).sqrt();
    Vec3::new(flat * cos, flat * sin, x).normalize()
}
