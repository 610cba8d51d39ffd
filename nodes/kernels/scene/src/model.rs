//! The scene as a value.

use crate::sizes::Sizes;
use grainlab_core::contact::{ContactLaw, TangentialLaw};
use grainlab_core::{ComponentControl, Material, ServoLaw};

/// An experiment: what is simulated, and along which loading path.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name; lower case letters, digits, `_` and `-`.
    pub name: String,
    /// Description in one line.
    pub description: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// The packing that the run starts from; `None` for a gas.
    pub start: Option<Start>,
    /// Number of grains.
    pub grains: u32,
    /// Sizes of the grains.
    pub sizes: Sizes,
    /// Material of every grain.
    pub material: Material,
    /// Law of the contacts.
    pub law: ContactLaw,
    /// Settings of the numerical method.
    pub numerics: Numerics,
    /// Phases in the order they run; cycles are already unrolled.
    pub phases: Vec<Phase>,
    /// FNV-1a of the canonical text that the scene was read from: a run is resumed only in a scene with the same text.
    pub fingerprint: u64,
}

/// Numerical settings of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numerics {
    /// Fraction of the stability bound that the time step takes, in (0, 1]. The margin is for contacts that
    /// stiffen until the next update of the bound, 200 steps later: without damping, 1 heats packings that
    /// are compressed at 40 1/s or faster.
    pub time_step_safety: f64,
    /// Verlet skin over grain diameter, positive.
    pub skin: f64,
    /// Law by which the tangential force follows a change of normal stiffness.
    pub tangential: TangentialLaw,
    /// True if the energy balance of each phase is summed, which makes steps several times slower.
    pub energy_balance: bool,
}

impl Default for Numerics {
    fn default() -> Self {
        Self { time_step_safety: 0.8, skin: 0.05, tangential: TangentialLaw::Rescaled, energy_balance: false }
    }
}

/// One phase of the loading path.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Name; unrolled cycles carry their round, as in `unload#2`.
    pub name: String,
    /// Drive of the cell.
    pub kind: PhaseKind,
    /// Friction coefficient; 0 switches spins and tangential springs off, infinity the Coulomb check.
    pub friction: f64,
    /// Contact damping, share of critical.
    pub damping: f64,
    /// Drag on velocities relative to the affine motion, 1/s.
    pub drag: f64,
    /// Drag on spins, 1/s: stops a grain with two contacts from spinning, which no contact resists. The
    /// default of a relaxing or servoed phase is √(G/ρ)/(1000 d): spins decay while a shear wave crosses a
    /// thousand grains.
    pub spin_drag: f64,
    /// Solver steps between two requests; in an event-driven gas a step is a mean free time.
    pub control_period: u32,
    /// The state at the end is the reference of strains reported from then on.
    pub reference: bool,
    /// Publish the packing at the end.
    pub publish: bool,
    /// Interval at which packings within the phase are published; the one at its end is published by `publish`, or if it is due.
    pub record: Option<Record>,
    /// Conditions that end the phase.
    pub until: Conditions,
}

/// A packing to start from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    /// Path of its file.
    pub packing: String,
    /// Path of the file with its contact forces, if they are in one of their own.
    pub contact_forces: Option<String>,
    /// Columns of that file, if they are named.
    pub contact_columns: Vec<String>,
    /// Solver step of the packing.
    pub step: Option<u64>,
    /// Copies of the packing along each edge of its cell.
    pub copies: u32,
}

/// Interval at which packings are published.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Record {
    /// Solver steps of the run.
    EverySteps(u64),
    /// Strain since the phase began.
    EveryStrain(f64),
    /// Simulated time since the phase began, s.
    EveryTime(f64),
}

/// Drive of the cell during a phase.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseKind {
    /// Grains placed at random and agitated, compressed isotropically.
    Gas {
        /// Solid fraction at which the grains are placed, below 0.35.
        initial_solid_fraction: f64,
        /// Root mean square speed of a grain, m/s; upper bound of the kinetic energy.
        speed: f64,
        /// Strain rate of each axis, 1/s, negative in compression.
        rate: f64,
        /// Method of the collisions.
        method: GasMethod,
    },
    /// A fixed cell.
    Relax,
    /// Imposed strain rate.
    Strain {
        /// Voigt order, tensor components, 1/s, positive in extension.
        rate: [f64; 6],
    },
    /// Per component: a stress target, a strain rate, or held.
    Servo {
        /// Control of each component, Voigt order.
        controls: [ComponentControl; 6],
        /// The control law.
        law: ServoLaw,
        /// Largest magnitude of a strain rate component, 1/s.
        rate_limit: f64,
    },
}

impl Phase {
    /// Control of each strain component while this phase runs.
    pub fn controls(&self) -> [ComponentControl; 6] {
        use ComponentControl::{Held, StrainRate};
        match &self.kind {
            PhaseKind::Gas { rate, .. } => {
                std::array::from_fn(|i| if i < 3 { StrainRate(*rate) } else { Held })
            }
            PhaseKind::Relax => [Held; 6],
            PhaseKind::Strain { rate } => rate.map(|r| if r == 0.0 { Held } else { StrainRate(r) }),
            PhaseKind::Servo { controls, .. } => *controls,
        }
    }

    /// Imposed rate of a strain component (Voigt index), 1/s; `None` where a stress is controlled instead.
    pub(crate) fn imposed_rate(&self, component: usize) -> Option<f64> {
        match self.controls()[component] {
            ComponentControl::StrainRate(rate) => Some(rate),
            ComponentControl::Held => Some(0.0),
            ComponentControl::Stress(_) => None,
        }
    }

    /// Imposed rate of the volumetric strain, 1/s.
    pub(crate) fn imposed_volumetric_rate(&self) -> Option<f64> {
        (0..3).map(|component| self.imposed_rate(component)).sum()
    }
}

impl PhaseKind {
    /// Largest magnitude of a component of the strain rate, 1/s; `None` in a fixed cell.
    pub fn rate_limit(&self) -> Option<f64> {
        match self {
            Self::Gas { rate, .. } => Some(rate.abs()),
            Self::Relax => None,
            Self::Strain { rate } => rate.iter().map(|r| r.abs()).reduce(f64::max),
            Self::Servo { rate_limit, .. } => Some(*rate_limit),
        }
    }
}

/// Method by which the grains of a gas collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GasMethod {
    /// As hard, elastic, frictionless spheres, from collision to collision. A solver step is a mean free time at the
    /// present solid fraction; there are no lasting contacts, and so no stress.
    EventDriven,
    /// By the contact law, step by step.
    Soft,
}

/// Conditions that end a phase: all must hold for `hold` seconds, or the run fails at `timeout`.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Conditions that must hold at the same time.
    pub all: Vec<Condition>,
    /// Duration for which they must hold, s of simulated time.
    pub hold: f64,
    /// Simulated time after which the phase has failed, s.
    pub timeout: f64,
}

/// A measured quantity that ends a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The quantity is at or above the value.
    AtLeast(Measure, f64),
    /// The quantity is at or below the value.
    AtMost(Measure, f64),
    /// Every servoed stress component is within `fraction` of the mean stress target.
    OnTarget {
        /// Allowed error over the mean of the stress targets.
        fraction: f64,
    },
}

/// The quantity of a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Solid fraction of the packing.
    SolidFraction,
    /// Time in this phase, s.
    Elapsed,
    /// Logarithmic strain component since the phase began (Voigt index), positive in extension.
    Strain(usize),
    /// Stress component (Voigt index), Pa, positive in compression.
    Stress(usize),
    /// Mean stress, Pa.
    Pressure,
    /// Stress difference σ33 − (σ11 + σ22)/2, Pa.
    Deviator,
    /// Mean net force of non-rattlers over mean contact force.
    Unbalanced,
    /// Root mean square speed relative to the affine motion, m/s.
    Speed,
}
