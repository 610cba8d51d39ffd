//! The gas that a run begins with: grains placed at random, and phases of hard spheres that move from collision to collision.

use crate::error::ExperimentError;
use grainlab_core::{Mat3, Packing, SymTensor, Vec3};
use grainlab_dem::Dem;
use grainlab_dem::gas::{GasError, HardSpheres, mean_free_time, random_placement};
use grainlab_engine::{Compute, EngineError, EngineFactory, ParticleEngine};
use grainlab_scene::{Condition, GasMethod, Measure, Phase, PhaseKind, Scene};

/// The grains of a scene, placed at random with thermal velocities.
pub(crate) fn at_random(scene: &Scene) -> Result<Packing, ExperimentError> {
    let (fraction, speed) = match scene.phases.first().map(|p| &p.kind) {
        Some(PhaseKind::Gas { initial_solid_fraction, speed, .. }) => (*initial_solid_fraction, *speed),
        _ => return Err(ExperimentError::Resume("the path does not begin with a gas phase".into())),
    };
    let radii: Vec<f64> = scene.sizes.diameters(scene.grains).iter().map(|d| 0.5 * d).collect();
    let gas = random_placement(&radii, fraction, speed, scene.seed)?;
    Ok(Packing {
        ids: (0..scene.grains).collect(),
        spins: vec![Vec3::zeros(); radii.len()],
        velocities: gas.velocities,
        material: scene.material,
        law: scene.law,
        friction: scene.phases[0].friction,
        ..Packing::at_rest(gas.cell, radii, gas.positions)
    })
}

/// True for a phase of hard spheres.
pub(crate) fn is_event_driven(phase: &Phase) -> bool {
    matches!(phase.kind, PhaseKind::Gas { method: GasMethod::EventDriven, .. })
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct EventDriven {
    /// Solver step, s.
    pub(crate) step: f64,
    /// Root mean square speed of the thermostat, m/s.
    pub(crate) speed: f64,
}

impl EventDriven {
    /// Parameters of an event-driven phase at the `present` solid fraction; `None` in any other phase.
    ///
    /// The solver step is a mean free time at the present solid fraction and at the speed of the phase, but short enough not to
    /// exceed, in one control period, the solid fraction at which the phase ends.
    pub(crate) fn of(scene: &Scene, phase: &Phase, present: f64) -> Option<Self> {
        let PhaseKind::Gas { method: GasMethod::EventDriven, speed, rate, .. } = phase.kind else {
            return None;
        };
        let mut step = mean_free_time(present, scene.sizes.mean(), speed);
        for condition in &phase.until.all {
            if let Condition::AtLeast(Measure::SolidFraction, wanted) = condition
                && *wanted > present
            {
                // Slightly more, so that rounding does not leave the condition unmet.
                let strain = (wanted / present).ln() / 3.0 + 1e-9;
                step = step.min(strain / -rate / f64::from(phase.control_period));
            }
        }
        Some(Self { step, speed })
    }

    /// Returns the engine after one control period at `rate` (1/s), and the deformation gradient over it.
    pub(crate) fn advance(
        self,
        engine: &dyn ParticleEngine,
        period: u32,
        rate: &[f64; 6],
        compute: &Compute,
    ) -> Result<(Box<dyn ParticleEngine>, Mat3), ExperimentError> {
        if let Some(c) = rate.iter().position(|r| !r.is_finite()) {
            let component = SymTensor::COMPONENTS[c];
            return Err(EngineError::Rate { component, value: rate[c] }.into());
        }
        if *rate != [rate[0], rate[0], rate[0], 0.0, 0.0, 0.0] {
            let what = format!("a strain rate of {rate:?} 1/s is not isotropic");
            return Err(GasError::HardSpheres(what).into());
        }
        let old = engine.packing(Mat3::identity())?;
        let interval = self.step * f64::from(period);
        let mut spheres =
            HardSpheres::new(old.cell, old.radii.clone(), old.positions.clone(), old.velocities.clone())?;
        let (deformation, _) = spheres.advance_unless(rate[0], interval, &|| compute.is_stopped())?;
        spheres.apply_thermostat(self.speed);
        let packing = Packing {
            step: old.step + u64::from(period),
            time: old.time + interval,
            time_step: self.step,
            cell: *spheres.cell(),
            positions: spheres.positions().to_vec(),
            velocities: spheres.velocities().to_vec(),
            contacts: Vec::new(),
            ..old
        };
        Ok((Dem::default().start(&packing, engine.settings(), rate, compute)?, deformation))
    }
}
