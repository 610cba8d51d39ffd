//! Processes on the bus that are not part of the run, as they are recorded.

use grainlab_msgs::Topic;
use grainlab_node_kit::{Bus, Stranger, member_of};
use grainlab_recordings::TopicNames;
use grainlab_recordings::strangers::StrangerView;
use std::collections::{BTreeMap, BTreeSet};

/// The name under which a stranger is counted: `run ID` for all processes of another launched run, else the
/// process.
pub fn name(stranger: &Stranger) -> String {
    match stranger.run {
        Some(run) if member_of(&stranger.participant) != 0 => format!("run {run}"),
        _ => stranger.to_string(),
    }
}

/// For a recording and for `summary.json`: one entry for each process, and one for each other run. `noted` are the entries of earlier
/// recorders of the run.
pub fn grouped(noted: &[StrangerView], strangers: impl Iterator<Item = Stranger>) -> Vec<StrangerView> {
    let mut views: BTreeMap<String, StrangerView> = BTreeMap::new();
    let new = strangers.map(|stranger| StrangerView {
        who: name(&stranger),
        run: stranger.run.map(|run| run.to_string()),
        ignored: stranger.ignored,
    });
    for StrangerView { who, run, ignored } in noted.iter().cloned().chain(new) {
        let empty = StrangerView { who: who.clone(), run, ignored: BTreeMap::new() };
        let view = views.entry(who).or_insert(empty);
        for (topic, count) in ignored {
            *view.ignored.entry(topic).or_default() += count;
        }
    }
    views.into_values().collect()
}

/// Topics of other programs that the recorder of a run leaves out: those outside the contract.
#[derive(Default)]
pub(crate) struct LeftOut(BTreeSet<String>);

impl LeftOut {
    /// Notes the topics that are published now. Hidden ones, and those below a recorded one, which show its messages, do not count.
    pub(crate) fn look(&mut self, bus: &dyn Bus, recorded: &BTreeSet<String>) {
        for offer in bus.offers().into_iter().chain(bus.strange_offers()) {
            let topic = offer.topic;
            let shows = |name: &String| topic.strip_prefix(name.as_str()).is_some_and(|r| r.starts_with('/'));
            let of_contract =
                Topic::by_name(&topic).is_some() || offer.type_name.starts_with("grainlab_msgs/");
            let is_ours = of_contract || recorded.iter().any(shows);
            if !is_ours && !recorded.contains(&topic) && TopicNames::default().take(&topic, None, false) {
                self.0.insert(topic);
            }
        }
    }

    pub(crate) fn sentence(&self) -> Option<String> {
        let names = self.0.iter().map(String::as_str).collect::<Vec<_>>();
        let list = names.join(", ");
        let advice = format!("`grainlab bag record {}` records them beside the run", names.join(" "));
        (!names.is_empty())
            .then(|| format!("not recorded, as they are no topics of the laboratory: {list}; {advice}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::{Qos, topics};
    use grainlab_node_kit::{Hub, Names};

    #[test]
    fn topics_of_other_programs_that_a_run_does_not_record_are_named_with_what_to_do() {
        let hub = Hub::new(1);
        let [mut other, own] = ["other", "own"].map(|name| hub.bus(Names::new(name).unwrap()));
        let mut left_out = LeftOut::default();
        let recorded = BTreeSet::from(["/packing".to_owned(), "/known".to_owned()]);
        left_out.look(&own, &recorded);
        assert_eq!(left_out.sentence(), None);
        for name in ["/odom", "/camera", "/packing/points", "/known", "/_hidden"] {
            other
                .advertise(&Topic::outside_contract(name, "demo_msgs/msg/Any", Qos::STREAM).unwrap())
                .unwrap();
        }
        other.advertise(&topics::STRESS).unwrap();
        left_out.look(&own, &recorded);
        let sentence = left_out.sentence().unwrap();
        assert!(
            sentence.contains("laboratory: /camera, /odom; `grainlab bag record /camera /odom`"),
            "{sentence}"
        );
    }
}
