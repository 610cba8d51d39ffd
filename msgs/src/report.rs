//! The report of a process on `/diagnostics`, as a value and as a message.

use crate::clock::wall_stamp;
use crate::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use crate::exit::Exit;
use crate::guid::Guid;
use crate::health::{Health, Level};
use crate::std_msgs::Header;

const PID: &str = "pid:";
const FINAL: &str = "final";
const EXIT: &str = "exit";
const PUBLISHED: &str = "published";
const FULL: &str = "full";
const RECEIVED: &str = "received";
const REFUSED: &str = "refused";

/// The statistics of one writer of a process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Published {
    /// Resolved topic name, as in `/lab/stress`.
    pub topic: String,
    /// Identity of the writer.
    pub writer: Guid,
    /// Number of samples published, which is the RTPS sequence number of the last one.
    pub count: u64,
    /// Number of samples dropped because a reliable reader was too far behind.
    pub full: u64,
}

/// The statistics of one subscription of a process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Resolved topic name.
    pub topic: String,
    /// Number of samples taken.
    pub taken: u64,
    /// Number of samples whose content was refused: undecodable, or invalid for the node.
    pub refused: u64,
}

/// One heartbeat of one process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Fully qualified node name.
    pub node: String,
    /// Id of the process.
    pub pid: u32,
    /// The health that the node reports.
    pub health: Health,
    /// The exit code of the process; only in its last report.
    pub exit: Option<Exit>,
    /// The statistics of each of its writers. In the last report they are final and include that report
    /// itself, so that a recording can be checked against them by RTPS sequence numbers.
    pub published: Vec<Published>,
    /// The number of samples its subscriptions took, one entry per topic.
    pub received: Vec<Received>,
}

impl Report {
    /// As a message; `nanos` is the time of the report, ns since 1970.
    pub fn to_message(&self, nanos: u64) -> DiagnosticArray {
        let mut values = Vec::new();
        let mut push = |key: String, value: String| values.push(KeyValue { key, value });
        if let Some(exit) = self.exit {
            push(FINAL.into(), "true".into());
            push(EXIT.into(), exit.code().to_string());
        }
        for (name, value) in &self.health.values {
            push(name.clone(), value.clone());
        }
        for writer in &self.published {
            push(format!("{PUBLISHED} {}", writer.topic), format!("{} {}", writer.writer, writer.count));
            if writer.full > 0 {
                push(format!("{FULL} {}", writer.topic), format!("{} {}", writer.writer, writer.full));
            }
        }
        for topic in &self.received {
            push(format!("{RECEIVED} {}", topic.topic), topic.taken.to_string());
            if topic.refused > 0 {
                push(format!("{REFUSED} {}", topic.topic), topic.refused.to_string());
            }
        }
        DiagnosticArray {
            header: Header { stamp: wall_stamp(nanos), frame_id: String::new() },
            status: vec![DiagnosticStatus {
                level: self.health.level as u8,
                name: self.node.clone(),
                message: self.health.message.clone(),
                hardware_id: format!("{PID}{}", self.pid),
                values,
            }],
        }
    }

    /// The reports in a message. Statuses of other software (no `pid:` in the hardware id) are skipped.
    pub fn from_message(message: &DiagnosticArray) -> Vec<Report> {
        message.status.iter().filter_map(Self::from_status).collect()
    }

    fn from_status(status: &DiagnosticStatus) -> Option<Report> {
        let pid = status.hardware_id.strip_prefix(PID)?.parse().ok()?;
        let mut report = Report {
            node: status.name.clone(),
            pid,
            health: Health {
                level: Level::from_wire(status.level),
                message: status.message.clone(),
                values: Vec::new(),
            },
            exit: None,
            published: Vec::new(),
            received: Vec::new(),
        };
        let mut is_final = false;
        for KeyValue { key, value } in &status.values {
            match key.split_once(' ') {
                Some((PUBLISHED, topic)) => {
                    let (writer, count) = writer_and_count(value)?;
                    report.published.push(Published { topic: topic.into(), writer, count, full: 0 });
                }
                Some((FULL, topic)) => {
                    let (writer, full) = writer_and_count(value)?;
                    let entry =
                        report.published.iter_mut().find(|p| p.writer == writer && p.topic == topic)?;
                    entry.full = full;
                }
                Some((RECEIVED, topic)) => {
                    let taken = value.parse().ok()?;
                    report.received.push(Received { topic: topic.into(), taken, refused: 0 });
                }
                Some((REFUSED, topic)) => {
                    report.received.iter_mut().find(|r| r.topic == topic)?.refused = value.parse().ok()?;
                }
                None if key == FINAL => is_final = value == "true",
                None if key == EXIT => report.exit = value.parse().ok().and_then(Exit::from_code),
                _ => report.health.values.push((key.clone(), value.clone())),
            }
        }
        if is_final && report.exit.is_none() {
            report.exit = Some(Exit::Failure);
        }
        Some(report)
    }

    /// True for the last report of its process.
    pub fn is_final(&self) -> bool {
        self.exit.is_some()
    }
}

fn writer_and_count(value: &str) -> Option<(Guid, u64)> {
    let (writer, count) = value.split_once(' ')?;
    Some((writer.parse().ok()?, count.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        let writer = Guid([7; 16]);
        Report {
            node: "/lab/servo".into(),
            pid: 4711,
            health: Health::warn("slow").with("waiting_s", 1.5),
            exit: Some(Exit::DataLoss),
            published: vec![
                Published { topic: "/lab/strain_rate".into(), writer, count: 12, full: 3 },
                Published { topic: "/diagnostics".into(), writer: Guid([8; 16]), count: 2, full: 0 },
            ],
            received: vec![Received { topic: "/lab/stress".into(), taken: 12, refused: 1 }],
        }
    }

    #[test]
    fn a_report_survives_the_message() {
        let message = report().to_message(1_700_000_000_123_456_789);
        assert_eq!((message.header.stamp.sec, message.header.stamp.nanosec), (1_700_000_000, 123_456_789));
        assert_eq!(message.status[0].hardware_id, "pid:4711");
        assert_eq!(Report::from_message(&message), [report()]);
        let running = Report { exit: None, ..report() };
        assert!(!Report::from_message(&running.to_message(0))[0].is_final());
    }

    #[test]
    fn statuses_of_others_and_broken_counts_are_no_reports() {
        let mut message = report().to_message(0);
        message.status[0].hardware_id = "motor 3".into();
        assert!(Report::from_message(&message).is_empty());
        let mut message = report().to_message(0);
        message.status[0].values.push(KeyValue { key: "published /x".into(), value: "many".into() });
        assert!(Report::from_message(&message).is_empty());
    }
}
