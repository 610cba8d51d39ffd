//! A process that is not part of the run and publishes forged messages on its topics.

use super::forgery::Forgery;
use super::plan;
use grainlab_msgs::msg::{Microstructure, Packing, PackingReport, RunState, StrainRate, Stress};
use grainlab_msgs::{Message, from_cdr, to_cdr};
use grainlab_node_kit::{
    Bus, BusError, Demand, Dice, Hub, Identity, MemoryBus, Names, PublisherId, RunId, Sample, SubscriptionId,
    run_of,
};

/// One stranger on its bus.
pub(super) struct Stranger {
    plan: plan::Stranger,
    bus: MemoryBus,
    input: SubscriptionId,
    output: PublisherId,
    /// The run whose messages it forges.
    run: RunId,
    dice: Dice,
    pub(super) forged: u64,
}

impl Stranger {
    /// Publishes a message before any request: an answer of zeros, an old result.
    pub(super) fn join(hub: &Hub, run: RunId, plan: plan::Stranger, seed: u64) -> Result<Self, BusError> {
        let identity = match plan.of_a_run {
            true => Identity::member_of(RunId::named("another"), 1),
            false => Identity::default(),
        };
        let mut bus = hub.bus_as(Names::new("stranger")?, identity);
        let (from, to) = plan.forgery.topics();
        let input = bus.subscribe(&from, Demand::best_effort(1000))?;
        let output = bus.advertise(&to)?;
        let early = match plan.forgery {
            Forgery::StrainRate => Some(to_cdr(&StrainRate::default())),
            Forgery::Finished => Some(to_cdr(&RunState { state: RunState::FINISHED, ..RunState::default() })),
            _ => None,
        };
        let mut stranger = Self { plan, bus, input, output, run, dice: Dice::new(seed), forged: 0 };
        if let Some(body) = early {
            stranger.publish(&body, None)?;
        }
        Ok(stranger)
    }

    fn publish(&mut self, body: &[u8], about: Option<grainlab_node_kit::SampleId>) -> Result<(), BusError> {
        self.forged += 1;
        self.bus.publish_about(self.output, body, about).map(drop)
    }

    /// Forges a fraction of the received messages; true if any arrived.
    pub(super) fn step(&mut self) -> Result<bool, BusError> {
        let mut received = false;
        while let Some(sample) = self.bus.take(self.input)? {
            received = true;
            // Two strangers that forge each other's messages would never end.
            let of_the_run = run_of(&sample.info.writer.participant()) == Some(self.run);
            if !of_the_run || self.dice.unit() >= self.plan.share {
                continue;
            }
            let by = 0.5 + self.dice.unit();
            if let Some(body) = forged(self.plan.forgery, &sample, by) {
                // Refers to the request, like the answer of a servo.
                let about = (self.dice.below(2) == 0).then(|| sample.info.id());
                self.publish(&body, about)?;
            }
        }
        Ok(received)
    }
}

fn decoded<T: Message>(sample: &Sample) -> Option<T> {
    from_cdr(&sample.body).ok()
}

/// A message that differs from this one by a factor.
fn forged(forgery: Forgery, sample: &Sample, by: f64) -> Option<Vec<u8>> {
    let scale = |values: &mut [f64]| values.iter_mut().for_each(|v| *v *= by);
    Some(match forgery {
        Forgery::StrainRate => {
            let mut answer = grainlab_servo_controller::answer(&decoded::<Stress>(sample)?).ok()?;
            scale(&mut answer.rate);
            to_cdr(&answer)
        }
        Forgery::Stress => {
            let mut stress: Stress = decoded(sample)?;
            stress.stress.zz *= by;
            to_cdr(&stress)
        }
        Forgery::Packing => {
            let mut packing: Packing = decoded(sample)?;
            scale(&mut packing.contact_normal_force);
            to_cdr(&packing)
        }
        Forgery::Report => {
            let mut report: PackingReport = decoded(sample)?;
            report.stiffness.iter_mut().for_each(|s| s.stiffness[35] *= by);
            to_cdr(&report)
        }
        Forgery::Microstructure => {
            let source_step = decoded::<PackingReport>(sample)?.source_step;
            to_cdr(&Microstructure {
                source_step,
                source: "packing_report".to_owned(),
                ..Microstructure::default()
            })
        }
        Forgery::Finished => to_cdr(&RunState { state: RunState::FINISHED, ..RunState::default() }),
        Forgery::Failed => to_cdr(&RunState { state: RunState::FAILED, ..RunState::default() }),
        Forgery::Garbage => {
            let mut body = sample.body.clone();
            body.truncate(4 + (by * 40.0) as usize);
            body
        }
    })
}
