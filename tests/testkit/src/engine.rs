//! Grains in motion, and packings that they came to rest in.

use crate::packings::{Keys, keys, touching};
use grainlab_core::{
    Cell, ComponentControl, Contact, Mat3, Material, Packing, ServoLaw, Vec3, effective_radius,
};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, TimeStep};
use grainlab_servo::{ServoInput, ServoOutput};

/// Radius of a grain, m.
pub const RADIUS: f64 = 1e-4;

/// Glass.
pub const GLASS: Material = Material::GLASS;

/// So heavy that no force moves it: a grain led by the affine motion alone.
pub const HEAVY: Material = Material { density: 1e20, ..Material::GLASS };

/// Returns settings without dissipation, with a fixed time step (s) and a skin of a twentieth of a diameter.
pub fn setting(friction: f64, time_step: f64) -> EngineSettings {
    EngineSettings {
        friction,
        time_step: TimeStep::Fixed(time_step),
        skin: 0.1 * RADIUS,
        ..EngineSettings::default()
    }
}

/// Creates an engine that is ready to step.
pub fn engine(cell: Cell, material: Material, radii: &[f64], x: &[Vec3], setting: EngineSettings) -> Engine {
    let engine = Engine::new(cell, material, radii.to_vec(), x, setting);
    ready(engine.unwrap_or_else(|e| panic!("an engine: {e}")))
}

/// Creates an engine of a packing that is ready to step.
pub fn taken_up(packing: &Packing, setting: EngineSettings) -> Engine {
    ready(Engine::from_packing(packing, setting).unwrap_or_else(|e| panic!("an engine: {e}")))
}

/// Returns grains of these radii (m) at random places, with a solid fraction of 0.35 and random velocities of root mean square
/// `speed` (m/s).
pub fn gas(radii: &[f64], speed: f64, seed: u64) -> Packing {
    let gas = grainlab_dem::gas::random_placement(radii, 0.35, speed, seed);
    let gas = gas.unwrap_or_else(|e| panic!("a gas: {e}"));
    Packing { velocities: gas.velocities, ..Packing::at_rest(gas.cell, radii.to_vec(), gas.positions) }
}

fn ready(mut engine: Engine) -> Engine {
    engine.initialise().unwrap_or_else(|e| panic!("an engine: {e}"));
    engine
}

/// Returns a cell with edges along the axes, m.
pub fn box_of(x: f64, y: f64, z: f64) -> Cell {
    Cell::new(Mat3::from_diagonal(&Vec3::new(x, y, z))).unwrap_or_else(|| panic!("no box of {x}, {y}, {z}"))
}

/// Makes `count` steps, one by one.
pub fn steps(e: &mut Engine, count: usize) {
    for _ in 0..count {
        e.step().unwrap_or_else(|error| panic!("step {}: {error}", e.steps()));
    }
}

/// Returns the packing of an engine.
pub fn packing(e: &Engine) -> Packing {
    e.packing(Mat3::identity())
}

/// Returns kinetic and elastic energy, J; the tangential springs as if they had been loaded at the present overlap.
pub fn energy(p: &Packing) -> f64 {
    let kinetic = |i: usize| {
        let (m, r) = (p.material.sphere_mass(p.radii[i]), p.radii[i]);
        0.5 * m * p.velocities[i].norm_squared() + 0.2 * m * r * r * p.spins[i].norm_squared()
    };
    let elastic = |c: &Contact| {
        let (_, k_t) = p.contact_stiffness(c);
        0.4 * c.normal_force * c.overlap + 0.5 * c.tangential_force.norm_squared() / k_t
    };
    (0..p.grains()).map(kinetic).sum::<f64>() + p.contacts.iter().map(elastic).sum::<f64>()
}

/// Returns the total momentum, kg m/s.
pub fn momentum(p: &Packing) -> Vec3 {
    (0..p.grains()).map(|i| p.velocities[i] * p.material.sphere_mass(p.radii[i])).sum()
}

/// Returns the keys of the contacts of a packing.
pub fn found(p: &Packing) -> Keys {
    keys(&p.contacts)
}

/// Returns the keys of every pair of grains that touches.
pub fn brute_force(p: &Packing) -> Keys {
    touching(&p.cell, &p.positions, &p.radii)
}

/// Returns every number of a packing as its bits, so that −0 and 0 differ.
pub fn bits(p: &Packing) -> Vec<u64> {
    let mut out = vec![p.step, p.time.to_bits(), p.time_step.to_bits(), p.friction.to_bits()];
    out.extend(p.ids.iter().map(|id| u64::from(*id)));
    out.extend(p.cell.matrix().iter().chain(p.deformation.iter()).map(|v| v.to_bits()));
    out.extend(p.radii.iter().map(|v| v.to_bits()));
    for v in p.positions.iter().chain(&p.velocities).chain(&p.spins) {
        out.extend(v.iter().map(|x| x.to_bits()));
    }
    for c in &p.contacts {
        out.extend([u64::from(c.i), u64::from(c.j)]);
        out.extend(c.image.iter().map(|n| *n as u64));
        out.extend([c.overlap.to_bits(), c.normal_force.to_bits()]);
        let forces = c.tangential_force.iter().chain(c.rolling_force.iter());
        out.extend(c.normal.iter().chain(forces).map(|v| v.to_bits()));
    }
    out
}

/// Returns the answer of the servo to what the engine shows, as a laboratory has it once a control period.
pub fn servo(
    e: &Engine,
    controls: [ComponentControl; 6],
    law: ServoLaw,
    rate_limit: f64,
    period: u32,
) -> ServoOutput {
    let seen = e.observables().unwrap_or_else(|error| panic!("step {}: {error}", e.steps()));
    let input = ServoInput {
        stress: seen.stress.tensor,
        controls,
        rate: e.rate(),
        rate_limit,
        law,
        tangent: Some(seen.tangent),
        control_interval: e.time_step() * f64::from(period),
    };
    grainlab_servo::control(&input).unwrap_or_else(|error| panic!("step {}: {error}", e.steps()))
}

/// Returns an isotropic stress target.
pub fn isotropic(pressure: f64) -> [ComponentControl; 6] {
    std::array::from_fn(|i| ComponentControl::Stress(if i < 3 { pressure } else { 0.0 }))
}

/// Disordered packings at rest, from the example `press`; kept as files because the way there is chaotic.
#[derive(Clone, Copy, Debug)]
pub enum Sample {
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
    /// Reads the packing; what follows from the places of the grains is computed.
    pub fn packing(self) -> Packing {
        let name = format!("pressed/{self:?}.txt").to_lowercase();
        let text = crate::golden::text(&name);
        let rows = |kind: &'static str| {
            text.lines().filter_map(move |l| l.strip_prefix(kind)?.strip_prefix(' ')).map(|l| {
                let numbers = l.split(' ').map(|word| word.parse::<f64>());
                numbers.collect::<Result<Vec<f64>, _>>().unwrap_or_else(|e| panic!("{name}: {l}: {e}"))
            })
        };
        let vector = |row: &[f64]| Vec3::from_column_slice(row);
        let columns: Vec<Vec3> = rows("cell").map(|r| vector(&r)).collect();
        let numerics = rows("numerics").next().unwrap_or_default();
        let cell = Cell::new(Mat3::from_columns(&columns)).unwrap_or_else(|| panic!("{name}: no cell"));
        let positions = rows("grain").map(|r| vector(&r[1..])).collect();
        let mut p = Packing {
            friction: numerics[0],
            time_step: numerics[1],
            ..Packing::at_rest(cell, rows("grain").map(|r| r[0]).collect(), positions)
        };
        for r in rows("contact") {
            let (i, j, image) = (r[0] as u32, r[1] as u32, [r[2], r[3], r[4]].map(|n| n as i8));
            let branch = p.positions[j as usize] - p.positions[i as usize] + p.cell.shift(image);
            let (a, b) = (p.radii[i as usize], p.radii[j as usize]);
            let overlap = a + b - branch.norm();
            let normal_force = p.material.normal_force(effective_radius(a, b), overlap);
            let pressed = Contact::pressed([i, j], image, branch.normalize(), overlap, normal_force);
            p.contacts.push(Contact { tangential_force: vector(&r[5..]), ..pressed });
        }
        p.validated().unwrap_or_else(|e| panic!("{name}: {e}"))
    }
}
