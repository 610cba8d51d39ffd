//! The reports that nodes send once a second.

use crate::observer::Observer;
use grainlab_console::Failure;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::topics;
use grainlab_node_kit::Report;
use ros2_client::qos::{History, WhenFull};
use ros2_client::{MessageTypeName, Name, QosProfile};
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

/// Time for which reports are listened to: a node sends one each second. A busy host is late.
pub(crate) const LISTEN: Duration = Duration::from_millis(2500);
pub(crate) const LATEST: Duration = Duration::from_secs(15);

/// The nodes whose reports arrive now, with their latest health; those of `expected` are waited for longer.
pub(crate) fn latest_reports(
    observer: &mut Observer,
    expected: &BTreeSet<String>,
) -> Result<BTreeMap<String, Report>, Failure> {
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .history(History::KeepLast { depth: 100 });
    let name = Name::parse(topics::DIAGNOSTICS.name).map_err(|e| Failure::failed(format!("{e:?}")))?;
    let info = topics::DIAGNOSTICS.info;
    let kind = MessageTypeName::new(info.package, info.name);
    let topic = observer.node.create_topic(&name, kind, &qos).map_err(Failure::failed)?;
    let reader =
        observer.node.create_subscription::<DiagnosticArray>(&topic, Some(qos)).map_err(Failure::failed)?;
    let start = Instant::now();
    let mut heard: BTreeMap<String, Report> = BTreeMap::new();
    let is_missing = |heard: &BTreeMap<String, Report>| expected.iter().any(|node| !heard.contains_key(node));
    while start.elapsed() < LISTEN || start.elapsed() < LATEST && is_missing(&heard) {
        match reader.take() {
            Ok(Some((message, _))) => {
                heard.extend(Report::from_message(&message).into_iter().map(|r| (r.node.clone(), r)));
            }
            // A message that does not decode is none of ours.
            Ok(None) | Err(_) => std::thread::sleep(Duration::from_millis(10)),
        }
    }
    Ok(heard)
}
