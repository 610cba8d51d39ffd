//! An engine of some 100 lines: frictionless Hertz spheres of one law, every pair in every step, no damping.

use grainlab_core::contact::ContactLaw;
use grainlab_core::stress::stress;
use grainlab_core::{Contact, Mat3, Packing, SymTensor, Vec3};
use grainlab_engine::{Compute, EngineError, EngineFactory, EngineSettings, Observables, ParticleEngine};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Fault {
    #[default]
    None,
    Slow,
    Attraction,
    Forgetful,
    Careless,
    NoDrag,
    Heavy,
    Rigid,
    Hasty,
    Wishful,
    Skewed,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Toys(pub(crate) Fault);

#[derive(Clone, Debug)]
struct Toy {
    grains: Packing,
    settings: EngineSettings,
    rate: [f64; 6],
    fault: Fault,
}

fn refused<T>(reason: impl ToString) -> Result<T, EngineError> {
    Err(EngineError::Failed { engine: "toy".into(), reason: reason.to_string() })
}

impl EngineFactory for Toys {
    fn start(
        &self,
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
        _compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        if packing.law != ContactLaw::default() {
            return refused("only the law hertz");
        }
        packing.check().or_else(refused)?;
        let mut toy = Toy { grains: packing.clone(), settings: *settings, rate: *rate, fault: self.0 };
        if self.0 == Fault::Forgetful {
            toy.grains.velocities.fill(Vec3::zeros());
        }
        toy.check(settings)?;
        toy.find_contacts()?;
        Ok(Box::new(toy))
    }
}

impl Toy {
    fn check(&self, s: &EngineSettings) -> Result<(), EngineError> {
        if self.fault != Fault::Careless && (s.drag.is_nan() || s.drag < 0.0) {
            return refused("drag must be 0 or more");
        }
        if self.fault != Fault::Wishful && s.friction != 0.0
            || s.damping != 0.0
            || s.thermostat_speed.is_some()
        {
            return refused("friction, damping and thermostats are not supported");
        }
        Ok(())
    }

    fn find_contacts(&mut self) -> Result<(), EngineError> {
        let p = &mut self.grains;
        p.contacts.clear();
        let modulus = 4.0 / 3.0 * p.material.shear_modulus / (1.0 - p.material.poisson_ratio);
        for i in 0..p.radii.len() {
            for j in i + 1..p.radii.len() {
                let apart = p.cell.inverse() * (p.positions[j] - p.positions[i]);
                let branch = p.cell.matrix() * apart.map(|s| s - s.round());
                let (distance, (r, s)) = (branch.norm(), (p.radii[i], p.radii[j]));
                let overlap = r + s - distance;
                if overlap <= 0.0 {
                    continue;
                }
                if overlap > 0.2 * r.min(s) {
                    return refused(format!("grains {} and {} overlap too far", p.ids[i], p.ids[j]));
                }
                let sign = if self.fault == Fault::Attraction { -1.0 } else { 1.0 };
                let normal_force = sign * modulus * (r * s / (r + s)).sqrt() * overlap.powf(1.5);
                let (grains, image) = ([i as u32, j as u32], apart.map(|s| -s.round() as i8).into());
                p.contacts.push(Contact::pressed(grains, image, branch / distance, overlap, normal_force));
            }
        }
        Ok(())
    }

    fn forces(&self) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); self.grains.radii.len()];
        for c in &self.grains.contacts {
            let on_j = c.normal * c.normal_force;
            forces[c.j as usize] += on_j;
            forces[c.i as usize] -= on_j;
        }
        forces
    }
}

impl ParticleEngine for Toy {
    fn settings(&self) -> &EngineSettings {
        &self.settings
    }

    fn begin_phase(&mut self, settings: &EngineSettings) -> Result<(), EngineError> {
        self.check(settings)?;
        self.settings = *settings;
        let (smallest, m) =
            (self.grains.radii.iter().fold(f64::INFINITY, |a, r| a.min(*r)), self.grains.material);
        self.grains.time_step = 0.1 * smallest * (m.density / m.shear_modulus).sqrt();
        Ok(())
    }

    fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), EngineError> {
        if !rate.iter().all(|r| r.is_finite()) {
            return refused("the strain rate is not finite");
        }
        self.rate = *rate;
        Ok(())
    }

    fn rate(&self) -> [f64; 6] {
        self.rate
    }

    fn run(&mut self, steps: u32) -> Result<(Mat3, Observables), EngineError> {
        let (dt, mut total) = (self.grains.time_step, Mat3::identity());
        let rate = SymTensor::from_voigt(self.rate).matrix() * dt;
        let step = Mat3::identity() + rate + 0.5 * rate * rate;
        let drag = if self.fault == Fault::NoDrag { 0.0 } else { self.settings.drag };
        let steps = if self.fault == Fault::Hasty { steps.max(1) } else { steps };
        for _ in 0..steps {
            let forces = self.forces();
            let p = &mut self.grains;
            for (n, force) in forces.iter().enumerate() {
                let heavy = if self.fault == Fault::Heavy { 10.0 } else { 1.0 };
                let mass = heavy * p.material.sphere_mass(p.radii[n]);
                p.velocities[n] = (p.velocities[n] + force * (dt / mass)) * (-drag * dt).exp();
                let affine = if self.fault == Fault::Rigid { Mat3::identity() } else { step };
                p.positions[n] = affine * p.positions[n] + p.velocities[n] * dt;
            }
            let Some(cell) = p.cell.deformed(&step) else { return refused("the cell lost its volume") };
            p.cell = cell;
            (p.step, p.time) = (p.step + 1, p.time + if self.fault == Fault::Slow { 0.5 * dt } else { dt });
            total = step * total;
            self.find_contacts()?;
        }
        Ok((total, self.observables()?))
    }

    fn steps(&self) -> u64 {
        self.grains.step
    }

    fn time(&self) -> f64 {
        self.grains.time
    }

    fn time_step(&self) -> f64 {
        self.grains.time_step
    }

    fn observables(&self) -> Result<Observables, EngineError> {
        let p = &self.grains;
        let net: f64 = self.forces().iter().map(|f| f.norm()).sum::<f64>() / p.radii.len() as f64;
        let mean: f64 = p.contacts.iter().map(|c| c.normal_force).sum::<f64>() / p.contacts.len() as f64;
        let squares: f64 = p.velocities.iter().map(|v| v.norm_squared()).sum();
        let mut stress = stress(p);
        stress.tensor.xy *= if self.fault == Fault::Skewed { -1.0 } else { 1.0 };
        Ok(Observables {
            stress,
            cell: p.cell,
            unbalanced: if p.contacts.is_empty() { 1.0 } else { net / mean },
            speed: (squares / p.radii.len() as f64).sqrt(),
            contacts: p.contacts.len() as u32,
            tangent: None,
            solid_fraction: None,
        })
    }

    fn packing(&self, deformation: Mat3) -> Result<Packing, EngineError> {
        Ok(Packing { deformation, ..self.grains.clone() })
    }
}
