//! Two spheres in the engine: their motion step by step, and their collision.

use crate::error::VerificationError;
use grainlab_core::contact::{ContactLaw, TangentialLaw};
use grainlab_core::{Cell, Mat3, Material, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, TimeStep};

/// Radius of the sphere that stands for a plane, over that of the sphere that meets it. R* is then 1e-5 below that of a plane,
/// and positions are exact to 1e-11 radii.
pub(crate) const PLANE: f64 = 1e5;

/// Two spheres before they meet.
#[derive(Clone, Debug)]
pub(crate) struct TwoSpheres {
    pub(crate) material: Material,
    pub(crate) law: ContactLaw,
    /// Radii, m, of both spheres.
    pub(crate) radii: [f64; 2],
    /// Positions of the centres, m.
    pub(crate) positions: [Vec3; 2],
    /// Velocities of the centres, m/s.
    pub(crate) velocities: [Vec3; 2],
    /// Spins of both, rad/s.
    pub(crate) spins: [Vec3; 2],
    pub(crate) friction: f64,
    /// Damping of the contact, as a fraction of critical.
    pub(crate) damping: f64,
    pub(crate) tangential: TangentialLaw,
    /// Time step, s.
    pub(crate) time_step: f64,
}

/// The two spheres at one time.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// Positions of the centres, m.
    pub(crate) positions: [Vec3; 2],
    /// At the time of the positions, m/s.
    pub(crate) velocities: [Vec3; 2],
    /// At the time of the positions, rad/s.
    pub(crate) spins: [Vec3; 2],
}

/// A collision from its first to its last contact.
#[derive(Clone, Debug)]
pub(crate) struct Collision {
    /// After it, m/s.
    pub(crate) velocities: [Vec3; 2],
    /// After it, rad/s.
    pub(crate) spins: [Vec3; 2],
    /// Overlap (m) and elastic normal force (N) of each step.
    pub(crate) path: Vec<[f64; 2]>,
    /// Duration of contact, s.
    pub(crate) duration: f64,
}

impl TwoSpheres {
    /// A sphere of radius `radius` (m) that touches a sphere of `ratio` times its radius, on its +z side, and moves into it with
    /// `velocity` (m/s) and `spin` (rad/s).
    pub(crate) fn upon(material: Material, radius: f64, ratio: f64, velocity: Vec3, spin: Vec3) -> Self {
        let zero = Vec3::zeros();
        Self {
            material,
            law: ContactLaw::default(),
            radii: [radius, radius * ratio],
            positions: [Vec3::z() * (radius * (1.0 + ratio)), zero],
            velocities: [velocity, zero],
            spins: [spin, zero],
            friction: 0.0,
            damping: 0.0,
            tangential: TangentialLaw::Rescaled,
            time_step: 0.0,
        }
    }

    /// Effective radius, m.
    pub(crate) fn effective_radius(&self) -> f64 {
        grainlab_core::effective_radius(self.radii[0], self.radii[1])
    }

    /// Effective mass, kg.
    pub(crate) fn effective_mass(&self) -> f64 {
        let [a, b] = self.radii.map(|r| self.material.sphere_mass(r));
        a * b / (a + b)
    }

    /// Speed of approach, m/s.
    pub(crate) fn approach(&self) -> f64 {
        let branch = self.positions[1] - self.positions[0];
        (self.velocities[0] - self.velocities[1]).dot(&branch) / branch.norm()
    }

    /// This pair with a time step of 1/`steps` of an elastic collision by Hertz.
    pub(crate) fn in_steps(mut self, steps: f64) -> Self {
        self.time_step = self.hertz().duration / steps;
        self
    }

    /// Elastic collision of the pair by Hertz.
    pub(crate) fn hertz(&self) -> crate::hertz::Impact {
        let young = self.material.effective_young();
        crate::hertz::impact(young, self.effective_radius(), self.effective_mass(), self.approach())
    }

    fn engine(&self) -> Result<Engine, VerificationError> {
        let largest = self.radii[0].max(self.radii[1]);
        let cell = Cell::cube(8.0 * largest).ok_or(VerificationError::Cell(largest))?;
        let settings = EngineSettings {
            friction: self.friction,
            damping: self.damping,
            tangential: self.tangential,
            time_step: TimeStep::Fixed(self.time_step),
            skin: 0.1 * self.radii[0].min(self.radii[1]),
            ..EngineSettings::default()
        };
        let packing = Packing {
            material: self.material,
            law: self.law,
            velocities: self.velocities.to_vec(),
            spins: self.spins.to_vec(),
            ..Packing::at_rest(cell, self.radii.to_vec(), self.positions.to_vec())
        };
        let mut engine = Engine::from_packing(&packing, settings)?;
        engine.initialise()?;
        Ok(engine)
    }

    /// The motion after each of these numbers of steps, which must increase.
    pub(crate) fn after(&self, steps: &[u32]) -> Result<Vec<Motion>, VerificationError> {
        let mut engine = self.engine()?;
        let mut done = 0;
        steps
            .iter()
            .map(|end| {
                engine.run(end - done)?;
                done = *end;
                motion(&engine)
            })
            .collect()
    }

    pub(crate) fn collide(&self) -> Result<Collision, VerificationError> {
        const LONGEST: u32 = 1_000_000;
        let mut engine = self.engine()?;
        let mut path = Vec::new();
        for _ in 0..LONGEST {
            engine.step()?;
            match engine.packing(Mat3::identity()).contacts.first() {
                Some(c) => path.push([c.overlap, c.normal_force]),
                None if !path.is_empty() => {
                    let [velocities, spins] = rates(&engine);
                    let duration = path.len() as f64 * self.time_step;
                    return Ok(Collision { velocities, spins, path, duration });
                }
                None => {}
            }
        }
        Err(VerificationError::NoCollision(LONGEST))
    }
}

impl Collision {
    /// Largest overlap, m.
    pub(crate) fn deepest(&self) -> f64 {
        self.path.iter().map(|p| p[0]).fold(0.0, f64::max)
    }

    /// Largest elastic normal force, N.
    pub(crate) fn largest_force(&self) -> f64 {
        self.path.iter().map(|p| p[1]).fold(0.0, f64::max)
    }

    /// Elastic normal force during the approach at an overlap (m), N, by linear interpolation between steps; the largest one
    /// beyond the largest overlap.
    pub(crate) fn force_at(&self, overlap: f64) -> f64 {
        let after = self.path.iter().position(|p| p[0] >= overlap);
        let Some(k) = after else { return self.largest_force() };
        let [[d0, f0], [d1, f1]] = [if k == 0 { [0.0; 2] } else { self.path[k - 1] }, self.path[k]];
        f0 + (f1 - f0) * (overlap - d0) / (d1 - d0)
    }
}

/// Velocities and spins of the engine, which are those half a step before the positions.
fn rates(engine: &Engine) -> [[Vec3; 2]; 2] {
    let p = engine.packing(Mat3::identity());
    [[p.velocities[0], p.velocities[1]], [p.spins[0], p.spins[1]]]
}

/// The present motion. The engine has velocities half a step before the positions; those at the time of the positions are the
/// mean of these and of those after the next kick, as in velocity Verlet.
fn motion(engine: &Engine) -> Result<Motion, VerificationError> {
    let p = engine.packing(Mat3::identity());
    let before = rates(engine);
    let mut next = engine.clone();
    next.step()?;
    let after = rates(&next);
    let mean = |k: usize| [0, 1].map(|g| 0.5 * (before[k][g] + after[k][g]));
    Ok(Motion { positions: [p.positions[0], p.positions[1]], velocities: mean(0), spins: mean(1) })
}
