//! A run against time, from one pass over its recording.

use crate::energy::residual;
use crate::phased::{MOST_PHASES, PhaseAxis, Phased, bins_of};
use crate::stress_path::StressPath;
use grainlab_console::Failure;
use grainlab_core::results::PackingReport;
use grainlab_core::{ComponentControl, Packing};
use grainlab_msgs::{Topic, msg, simulated_seconds, topics};
use grainlab_page::three_digits;
use grainlab_recordings::{ChannelInfo, Message, OneRun, Recording, RunSign, Selection};
use grainlab_servo::ServoRequest;
use grainlab_viewer::{Film, View};
use std::collections::BTreeMap;

/// Most measured structures that are kept; beyond, every second one is left out.
const STRUCTURES: usize = 4096;

/// A run against simulated time, s, in bounded memory.
#[derive(Debug, Default)]
pub struct Timeline {
    bins: usize,
    /// Pa, in the order of Voigt.
    pub(crate) stress: [Phased; 6],
    /// Imposed stress, Pa, in the order of Voigt: no values where a strain rate is imposed.
    pub(crate) targets: [Phased; 6],
    /// Mean stress, Pa.
    pub(crate) pressure: Phased,
    /// Deviatoric stress, Pa.
    pub(crate) deviator: Phased,
    /// Logarithmic, positive in extension, in the order of Voigt.
    pub(crate) strain: [Phased; 6],
    pub(crate) path: StressPath,
    pub(crate) solid_fraction: Phased,
    pub(crate) coordination: Phased,
    pub(crate) unbalanced: Phased,
    /// Number and first time of each phase, in order.
    pub(crate) phases: Vec<(u32, f64)>,
    pub(crate) names: BTreeMap<u32, String>,
    /// Last time, s.
    pub(crate) end: f64,
    /// Measured packings: time, z and ε.
    pub(crate) fabrics: Vec<Structure>,
    pub(crate) film: Film,
    pub(crate) energy: Vec<msg::EnergyBalance>,
    pub(crate) last: Option<Packing>,
    pub(crate) unreadable: usize,
    /// Sign that the recording is of several runs: then it was not read to its end.
    pub(crate) several_runs: Option<RunSign>,
    /// Sequence number of the next request.
    next: u64,
    /// The recording counts phases from 0, as those of earlier versions.
    from_zero: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Structure {
    pub(crate) time: f64,
    pub(crate) z: f64,
    pub(crate) eps: f64,
    pub(crate) eps_stiffness: f64,
}

impl Timeline {
    /// Without data, for a run of this number of phases.
    pub fn of_phases(phases: usize) -> Self {
        Self { bins: bins_of(phases), ..Self::default() }
    }

    pub(crate) fn read(recording: &Recording, phases: usize) -> Result<Self, Failure> {
        let wanted =
            [topics::STRESS, topics::PACKING_REPORT, topics::PACKING, topics::RUN_STATE, topics::ENERGY];
        let of = |c: &ChannelInfo| {
            Topic::of_channel(&c.topic, &c.ros_type).filter(|t| wanted.iter().any(|w| w.name == t.name))
        };
        let channels = recording.channels();
        let names = channels.iter().filter(|c| of(c).is_some()).map(|c| c.topic.clone());
        let mut timeline = Self::of_phases(phases);
        let mut run = OneRun::default();
        for message in recording.messages(&Selection::topics(names))? {
            let Some(topic) = of(&message.channel) else { continue };
            if topic.name == topics::STRESS.name
                && let Ok(request) = message.decoded::<msg::Stress>()
                && let Err(sign) = run.request(request.sequence, &message.payload)
            {
                timeline.several_runs = Some(sign);
                return Ok(timeline);
            }
            if timeline.take(topic.name, &message).is_none() {
                timeline.unreadable += 1;
            }
        }
        Ok(timeline)
    }

    /// Takes one message; `None` if it cannot be read.
    fn take(&mut self, topic: &str, recorded: &Message) -> Option<()> {
        if topic == topics::STRESS.name {
            self.request(&ServoRequest::try_from(&recorded.decoded::<msg::Stress>().ok()?).ok()?);
        } else if topic == topics::PACKING_REPORT.name {
            let message: msg::PackingReport = recorded.decoded().ok()?;
            let time = simulated_seconds(&message.header.stamp);
            self.structure(time, &PackingReport::try_from(&message).ok()?);
        } else if topic == topics::PACKING.name {
            self.packing(Packing::try_from(&recorded.decoded::<msg::Packing>().ok()?).ok()?);
        } else if topic == topics::ENERGY.name {
            let balance: msg::EnergyBalance = recorded.decoded().ok().filter(|b| residual(b).is_finite())?;
            // A restarted simulator sends the balance of a phase again.
            self.energy.retain(|b| b.phase != balance.phase);
            self.energy.push(balance);
        } else {
            let state: msg::RunState = recorded.decoded().ok()?;
            self.name(state.phase, &state.phase_name);
        }
        Some(())
    }

    /// Takes a request of the lockstep. One that was published again is left out; returns whether it is new.
    pub fn request(&mut self, request: &ServoRequest) -> bool {
        if request.sequence < self.next {
            return false;
        }
        self.next = request.sequence + 1;
        let (time, phase) = (request.time, request.phase);
        self.from_zero |= phase == 0;
        if self.phases.len() < MOST_PHASES
            && self.phases.last().is_none_or(|(phase, _)| *phase != request.phase)
        {
            self.phases.push((request.phase, time));
        }
        self.end = self.end.max(time);
        let phase = (phase, self.bins);
        let push = |series: &mut [Phased; 6], values: [f64; 6]| {
            series.iter_mut().zip(values).for_each(|(s, v)| s.push(phase, time, v));
        };
        push(&mut self.stress, request.input.stress.voigt());
        push(&mut self.strain, request.strain.voigt());
        for (series, control) in self.targets.iter_mut().zip(&request.input.controls) {
            if let ComponentControl::Stress(target) = control {
                series.push(phase, time, *target);
            }
        }
        let (p, q) = (request.input.stress.mean(), request.input.stress.deviatoric_invariant());
        self.pressure.push(phase, time, p);
        self.deviator.push(phase, time, q);
        self.path.push(request.phase, [p, q, request.strain.voigt()[2]]);
        self.solid_fraction.push(phase, time, request.solid_fraction);
        self.coordination.push(phase, time, request.coordination);
        self.unbalanced.push(phase, time, request.unbalanced);
        true
    }

    /// Takes the structure of the packing at a time, s.
    pub fn structure(&mut self, time: f64, PackingReport { contacts, fabric, .. }: &PackingReport) {
        if self.fabrics.last().is_some_and(|s| s.time >= time) {
            return;
        }
        if self.fabrics.len() >= STRUCTURES {
            self.fabrics = self.fabrics.drain(..).step_by(2).collect();
        }
        self.fabrics.push(Structure {
            time,
            z: contacts.mechanical_coordination,
            eps: fabric.contact_anisotropy,
            eps_stiffness: fabric.stiffness_anisotropy(),
        });
    }

    /// Takes a packing; returns whether it is new. A restarted simulator may publish it again.
    pub fn packing(&mut self, packing: Packing) -> bool {
        if self.last.as_ref().is_some_and(|p| p.step >= packing.step) {
            return false;
        }
        self.film.push(view(&packing));
        self.end = self.end.max(packing.time);
        self.last = Some(packing);
        true
    }

    /// The last packing.
    pub fn last(&self) -> Option<&Packing> {
        self.last.as_ref()
    }

    /// The packings for pictures.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Takes the name of a phase, by its number from 0.
    pub fn name(&mut self, phase: u32, name: &str) {
        if !name.is_empty() && (self.names.len() < MOST_PHASES || self.names.contains_key(&phase)) {
            self.names.insert(phase, name.to_owned());
        }
    }

    /// The name of a phase, by its number in messages.
    pub fn phase_name(&self, phase: u32) -> String {
        self.names.get(&phase).cloned().unwrap_or_else(|| format!("phase {}", self.number(phase)))
    }

    /// The number of a phase, from 1, by its number in messages.
    pub(crate) fn number(&self, phase: u32) -> u32 {
        phase + u32::from(self.from_zero)
    }

    /// The number of the first phase in messages.
    pub(crate) fn first_phase(&self) -> u32 {
        u32::from(!self.from_zero)
    }

    /// Number of values of each series.
    pub fn count(&self) -> usize {
        self.pressure.count()
    }

    /// First time that is shown, s.
    pub(crate) fn begin(&self) -> f64 {
        self.phases.first().map_or(0.0, |(_, time)| *time)
    }

    /// Time as a number of phases.
    pub(crate) fn axis(&self) -> PhaseAxis {
        PhaseAxis(self.phases.iter().map(|(_, time)| *time).chain([self.end]).collect())
    }
}

/// A state as readers see it.
pub fn view(packing: &Packing) -> View {
    let pressure = grainlab_core::stress::stress(packing).tensor.mean() / 1e3;
    let phi = packing.solid_fraction();
    View::new(
        packing,
        format!("{:.3} ms, p {} kPa, φ {phi:.4}", packing.time * 1e3, three_digits(pressure, 2)),
    )
}
