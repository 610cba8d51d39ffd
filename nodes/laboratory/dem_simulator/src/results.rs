//! The results of the run as they arrive: data about packings, answers to them, and the processes that send both.

use crate::run_end::{DATA, Processes, RunEnd, Verdict};
use grainlab_msgs::boundary::{BoundaryError, ModuliReading, WaveSpeedsReading};
use grainlab_msgs::msg::{Microstructure, Moduli, PackingReport, WaveSpeeds};
use grainlab_msgs::{Guid, stamp, topics};
use grainlab_node_kit::processes::Status;
use grainlab_node_kit::{Bus, BusError, Demand, Participant, PeerWatch, Subscription};
use std::collections::BTreeSet;

/// More results than arrive between two steps of the node: an instrument may send hundreds of shots.
const BACKLOG: u32 = 1024;

/// Receives results, and judges the end of the run by them.
pub(crate) struct Results {
    reports: Subscription<PackingReport>,
    moduli: Subscription<Moduli>,
    wave_speeds: Subscription<WaveSpeeds>,
    microstructures: Subscription<Microstructure>,
    peers: PeerWatch,
    end: RunEnd,
    /// Wave speeds of step 0 may be about the packing that the run starts from.
    starts_from_packing: bool,
}

impl Results {
    pub(crate) fn subscribe(
        bus: &mut dyn Bus,
        end: RunEnd,
        starts_from_packing: bool,
    ) -> Result<Self, BusError> {
        let demand = Demand::reliable(BACKLOG);
        Ok(Self {
            reports: Subscription::subscribe(bus, &topics::PACKING_REPORT, demand)?,
            moduli: Subscription::subscribe(bus, &topics::MODULI, demand)?,
            wave_speeds: Subscription::subscribe(bus, &topics::WAVE_SPEEDS, demand)?,
            microstructures: Subscription::subscribe(bus, &topics::MICROSTRUCTURE, demand)?,
            peers: PeerWatch::subscribe(bus)?,
            end,
            starts_from_packing,
        })
    }

    /// Forgets what was received before the run begins: latched messages of an earlier run.
    pub(crate) fn begin(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        self.receive(bus)?;
        self.end.begin();
        Ok(())
    }

    pub(crate) fn receive(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        self.peers.update(bus, |_, _| {})?;
        while let Some((report, info)) = self.reports.take_valid(bus)? {
            self.refuse(grainlab_core::results::PackingReport::try_from(&report));
            let is_declined = report.stiffness.is_empty();
            self.end.hear_data(
                &topics::PACKING_REPORT,
                report.source_step,
                info.writer.participant(),
                is_declined,
            );
        }
        while let Some((moduli, info)) = self.moduli.take_valid(bus)? {
            self.refuse(ModuliReading::try_from(&moduli));
            // Data about no packing have step 0.
            if moduli.source_step > 0 {
                self.end.hear_data(&topics::MODULI, moduli.source_step, info.writer.participant(), false);
            }
        }
        while let Some((speeds, info)) = self.wave_speeds.take_valid(bus)? {
            self.refuse(WaveSpeedsReading::try_from(&speeds));
            let is_of_start = self.starts_from_packing && speeds.header.stamp == stamp(0.0);
            if speeds.source_step > 0 || is_of_start {
                let is_declined = speeds.speeds.is_empty();
                self.end.hear_data(
                    &topics::WAVE_SPEEDS,
                    speeds.source_step,
                    info.writer.participant(),
                    is_declined,
                );
            }
        }
        while let Some((found, info)) = self.microstructures.take_valid(bus)? {
            self.end.hear_answer(&found.source, found.source_step, info.writer.participant());
        }
        Ok(())
    }

    fn refuse<T>(&mut self, read: Result<T, BoundaryError>) {
        if let Err(why) = read {
            self.end.hear_refused(why.to_string());
        }
    }

    /// Judges the end of the run by the results of the packing of `step`; the error is what it waits for.
    pub(crate) fn look(&mut self, bus: &dyn Bus, step: u64) -> Result<Verdict, String> {
        let processes = self.processes(bus);
        self.end.look(step, &processes, bus.now())
    }

    fn processes(&self, bus: &dyn Bus) -> Processes {
        let participants =
            |writers: Vec<Guid>| -> BTreeSet<Participant> { writers.iter().map(Guid::participant).collect() };
        let mut processes = Processes {
            writers: DATA
                .iter()
                .map(|topic| (topic.name, participants(bus.foreign_writers(topic))))
                .collect(),
            inversions: participants(bus.foreign_writers(&topics::MICROSTRUCTURE)),
            ..Processes::default()
        };
        let own = Status::of(std::process::id()).map(|status| status.name);
        for peer in self.peers.iter() {
            let (participant, report) = (peer.participant, &peer.report);
            if let Some(is_at_work) = report.health.measuring() {
                processes.measuring.insert(participant, is_at_work && report.exit.is_none());
            }
            processes.names.insert(participant, report.node.clone());
            // Another host may have a process with this number.
            let of_grainlab = |status: &Status| own.as_ref() == Some(&status.name);
            let is_stopped = Status::of(report.pid).is_some_and(|s| s.is_stopped() && of_grainlab(&s));
            processes.any_stopped |= report.exit.is_none() && is_stopped;
        }
        processes
    }
}
