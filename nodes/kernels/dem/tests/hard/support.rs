//! Packings, measures and the brute-force search that the hard cases share.

use grainlab_core::effective_radius;
use grainlab_core::{Cell, ComponentControl, Contact, Mat3, Material, Packing, ServoLaw, Vec3};
use grainlab_dem::{Engine, EngineSettings, TimeStep};

pub(crate) const RADIUS: f64 = 1e-4;
pub(crate) const GLASS: Material = Material::GLASS;
/// So heavy that no force moves it: a grain led by the affine motion alone.
pub(crate) const HEAVY: Material = Material { density: 1e20, ..Material::GLASS };

/// No dissipation, a fixed time step (s) and a skin of a twentieth of a diameter.
pub(crate) fn setting(friction: f64, time_step: f64) -> EngineSettings {
    EngineSettings {
        friction,
        time_step: TimeStep::Fixed(time_step),
        skin: 0.1 * RADIUS,
        ..EngineSettings::default()
    }
}

/// An engine that is ready to step.
pub(crate) fn engine(
    cell: Cell,
    material: Material,
    radii: &[f64],
    x: &[Vec3],
    setting: EngineSettings,
) -> Engine {
    let mut e = Engine::new(cell, material, radii.to_vec(), x, setting).unwrap();
    e.initialise().unwrap();
    e
}

pub(crate) fn box_of(x: f64, y: f64, z: f64) -> Cell {
    Cell::new(Mat3::from_diagonal(&Vec3::new(x, y, z))).unwrap()
}

pub(crate) fn steps(e: &mut Engine, count: usize) {
    (0..count).for_each(|_| e.step().map(|_| ()).unwrap());
}

pub(crate) fn packing(e: &Engine) -> Packing {
    e.packing(Mat3::identity())
}

/// Kinetic and elastic energy, J; the tangential springs as if they had been loaded at the present overlap.
pub(crate) fn energy(p: &Packing) -> f64 {
    let kinetic: f64 = (0..p.grains())
        .map(|i| {
            let (m, r) = (p.material.sphere_mass(p.radii[i]), p.radii[i]);
            0.5 * m * p.velocities[i].norm_squared() + 0.2 * m * r * r * p.spins[i].norm_squared()
        })
        .sum();
    let elastic: f64 = p
        .contacts
        .iter()
        .map(|c| {
            let (_, k_t) = p.contact_stiffness(c);
            0.4 * c.normal_force * c.overlap + 0.5 * c.tangential_force.norm_squared() / k_t
        })
        .sum();
    kinetic + elastic
}

/// Total momentum, kg m/s.
pub(crate) fn momentum(p: &Packing) -> Vec3 {
    (0..p.grains()).map(|i| p.velocities[i] * p.material.sphere_mass(p.radii[i])).sum()
}

/// (i, j, image) of each contact.
pub(crate) type Keys = Vec<(u32, u32, [i8; 3])>;

pub(crate) fn found(p: &Packing) -> Keys {
    p.contacts.iter().map(|c| (c.i, c.j, c.image)).collect()
}

/// Every pair that touches, over all images that can: |f_k + n_k| ≤ reach/width_k for fractional distances f.
pub(crate) fn brute_force(p: &Packing) -> Keys {
    let mut out = Keys::new();
    for i in 0..p.grains() {
        for j in i..p.grains() {
            let d = p.positions[j] - p.positions[i];
            let (f, reach) = (p.cell.fractional(&d), p.radii[i] + p.radii[j]);
            let range = |k: usize| {
                let r = reach / p.cell.width(k) + 1e-9;
                (-f[k] - r).ceil() as i32..=(-f[k] + r).floor() as i32
            };
            for a in range(0) {
                for b in range(1) {
                    for c in range(2) {
                        let image = [a, b, c].map(|n| i8::try_from(n).unwrap());
                        if (i < j || image > [0, 0, 0]) && (d + p.cell.shift(image)).norm() < reach {
                            out.push((i as u32, j as u32, image));
                        }
                    }
                }
            }
        }
    }
    out.sort_unstable();
    out
}

/// Every number of a packing as its bits, so that −0 and 0 differ.
pub(crate) fn bits(p: &Packing) -> Vec<u64> {
    let mut out = vec![p.step, p.time.to_bits(), p.time_step.to_bits(), p.friction.to_bits()];
    out.extend(p.cell.matrix().iter().chain(p.deformation.iter()).map(|v| v.to_bits()));
    out.extend(p.radii.iter().map(|v| v.to_bits()));
    for v in p.positions.iter().chain(&p.velocities).chain(&p.spins) {
        out.extend(v.iter().map(|x| x.to_bits()));
    }
    for c in &p.contacts {
        out.extend([u64::from(c.i), u64::from(c.j)]);
        out.extend(c.image.iter().map(|n| *n as u64));
        out.extend([c.overlap.to_bits(), c.normal_force.to_bits()]);
        out.extend(c.normal.iter().chain(c.tangential_force.iter()).map(|v| v.to_bits()));
    }
    out
}

/// Uniform numbers from a seed.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn vector(&mut self, scale: f64) -> Vec3 {
        Vec3::from_fn(|_, _| self.between(-scale, scale))
    }
}

/// The strain rate that the servo answers to what the engine shows, as a laboratory does once a control period.
pub(crate) fn servo(
    e: &Engine,
    controls: [ComponentControl; 6],
    law: ServoLaw,
    rate_limit: f64,
    period: u32,
) -> grainlab_servo::ServoOutput {
    let seen = e.observables().unwrap();
    grainlab_servo::control(&grainlab_servo::ServoInput {
        stress: seen.stress.tensor,
        controls,
        rate: e.rate(),
        rate_limit,
        law,
        tangent: Some(seen.tangent),
        control_interval: e.time_step() * f64::from(period),
    })
    .unwrap()
}

/// An isotropic stress target.
pub(crate) fn isotropic(pressure: f64) -> [ComponentControl; 6] {
    std::array::from_fn(|i| ComponentControl::Stress(if i < 3 { pressure } else { 0.0 }))
}

/// Disordered packings at rest, from the example `press`; kept as files because the way there is chaotic.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sample {
    /// 48 grains, friction 0.3, 100 kPa.
    Pressed,
    /// 48 grains, friction 0.3, 20 kPa.
    Loose,
    /// 48 grains, no friction, 100 kPa.
    Frictionless,
    /// 8 grains, friction 0.3, 100 kPa.
    Few,
}

impl Sample {
    /// Reads the packing; what a contact's geometry tells is worked out anew.
    pub(crate) fn packing(self) -> Packing {
        let text = match self {
            Sample::Pressed => include_str!("packings/pressed.txt"),
            Sample::Loose => include_str!("packings/loose.txt"),
            Sample::Frictionless => include_str!("packings/frictionless.txt"),
            Sample::Few => include_str!("packings/few.txt"),
        };
        let rows = |kind: &'static str| {
            text.lines()
                .filter_map(move |l| l.strip_prefix(kind)?.strip_prefix(' '))
                .map(|l| l.split(' ').map(|word| word.parse::<f64>().unwrap()).collect::<Vec<f64>>())
        };
        let vector = |row: &[f64]| Vec3::from_column_slice(row);
        let columns: Vec<Vec3> = rows("cell").map(|r| vector(&r)).collect();
        let numerics = rows("numerics").next().unwrap();
        let radii: Vec<f64> = rows("grain").map(|r| r[0]).collect();
        let mut p = Packing {
            friction: numerics[0],
            time_step: numerics[1],
            ..Packing::at_rest(
                Cell::new(Mat3::from_columns(&columns)).unwrap(),
                radii,
                rows("grain").map(|r| vector(&r[1..])).collect(),
            )
        };
        for r in rows("contact") {
            let (i, j, image) = (r[0] as u32, r[1] as u32, [r[2], r[3], r[4]].map(|n| n as i8));
            let branch = p.positions[j as usize] - p.positions[i as usize] + p.cell.shift(image);
            let (a, b) = (p.radii[i as usize], p.radii[j as usize]);
            let overlap = a + b - branch.norm();
            let normal_force = p.material.normal_force(effective_radius(a, b), overlap);
            let (normal, tangential_force) = (branch.normalize(), vector(&r[5..]));
            let pressed = Contact::pressed([i, j], image, normal, overlap, normal_force);
            p.contacts.push(Contact { tangential_force, ..pressed });
        }
        p.validated().unwrap()
    }
}
