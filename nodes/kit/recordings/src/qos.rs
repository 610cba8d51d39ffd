//! Quality of service as rosbag2 writes it: the profiles of a channel, and files of overrides.

use std::collections::BTreeMap;
use std::path::Path;

use grainlab_console::Failure;
use grainlab_msgs::Qos;
use serde_json::Value;

use grainlab_console::input;

mod profile;

use profile::Policies;

/// QoS that rosbag2 requests and offers where nothing else is known.
const DEFAULT: Qos = Qos { reliable: true, depth: 10, transient_local: false };

/// QoS by topic, from a file in the format of `ros2 bag --qos-profile-overrides-path`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct QosOverrides(BTreeMap<String, Policies>);

impl QosOverrides {
    /// Reads the file: a map from names of topics to profiles, whose policies are all optional.
    ///
    /// # Errors
    /// If it cannot be read, is not YAML, or has a profile that is not valid.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = input::text(path, input::SETTINGS);
        let text = text
            .map_err(|e| Failure::usage(format!("{}: cannot read the QoS profiles: {e}", path.display())))?;
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &str) -> Result<Self, Failure> {
        let wrong = |problem: String| {
            let example = "`/topic: {reliability: best_effort, history: keep_last, depth: 10}`";
            Failure::usage(format!("{}: {problem}; it has to be YAML such as {example}", path.display()))
        };
        let file: Value = serde_saphyr::from_str(text).map_err(|e| wrong(e.to_string()))?;
        let Value::Object(topics) = file else {
            return Err(wrong("it is not a map from names of topics to profiles".to_owned()));
        };
        let profile = |(topic, value): (String, Value)| match Policies::strict(&value) {
            Ok(policies) => Ok((topic.trim_start_matches('/').to_owned(), policies)),
            Err(problem) => Err(Failure::usage(format!("{}: profile of {topic}: {problem}", path.display()))),
        };
        topics.into_iter().map(profile).collect::<Result<_, _>>().map(Self)
    }

    /// The QoS of a topic: `qos`, with what the file says about it.
    pub fn apply(&self, topic: &str, qos: Qos) -> Qos {
        self.0.get(topic.trim_start_matches('/')).map_or(qos, |policies| policies.over(qos))
    }

    /// Names of the topics in the file, without the leading slash.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}

/// The QoS with which a reader receives from all of these writers, by the rule of rosbag2: reliable only if all are reliable,
/// transient local only if all are. The depth is the sum of theirs, at least 10.
pub fn adapted(offers: &[Qos]) -> Qos {
    let depth = offers.iter().fold(0, |sum: u32, qos| sum.saturating_add(qos.depth));
    Qos {
        reliable: offers.iter().all(|qos| qos.reliable),
        transient_local: !offers.is_empty() && offers.iter().all(|qos| qos.transient_local),
        depth: depth.max(DEFAULT.depth),
    }
}

/// The QoS that a player offers for a recorded topic, by the rule of rosbag2: that of the writers if it is the same for all, else
/// reliable, volatile, depth 10. The flag says whether they differ.
pub fn offered_profiles(recorded: &str) -> (Qos, bool) {
    let profiles = profiles(recorded);
    match profiles.split_first() {
        Some((first, others)) if others.iter().all(|qos| qos == first) => {
            let depth = if first.depth == 0 { DEFAULT.depth } else { first.depth };
            (Qos { depth, ..*first }, false)
        }
        first => (DEFAULT, first.is_some()),
    }
}

/// The profiles of a channel, `offered_qos_profiles`: as far as they can be read. A depth of 0 is unknown.
pub fn profiles(recorded: &str) -> Vec<Qos> {
    let Ok(Value::Array(list)) = serde_saphyr::from_str::<Value>(recorded) else { return Vec::new() };
    list.iter().map(|value| Policies::lenient(value).over(Qos { depth: 0, ..DEFAULT })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<QosOverrides, String> {
        QosOverrides::parse(Path::new("qos.yaml"), text).map_err(|e| e.to_string())
    }

    #[test]
    fn a_file_of_rosbag2_overrides_what_it_names() {
        let text = "/talker:\n  depth: 1000\n  history: keep_last\n  reliability: best_effort\n  durability: volatile\n  \
                    deadline:\n    sec: 2147483647\n    nsec: 4294967295\n  liveliness: system_default\nscan:\n  durability: \
                    transient_local\n";
        let overrides = parse(text).unwrap();
        let talker = Qos { reliable: false, depth: 1000, transient_local: false };
        assert_eq!(overrides.apply("/talker", Qos::LATCHED), talker);
        assert_eq!(overrides.apply("/scan", Qos::STREAM), Qos { transient_local: true, ..Qos::STREAM });
        assert_eq!(overrides.apply("/other", Qos::STREAM), Qos::STREAM);
    }

    #[test]
    fn a_wrong_profile_is_refused_with_topic_policy_and_what_to_write() {
        for (text, words) in [
            ("/a: {reliability: reliabel}", &["profile of /a", "reliabel", "best_effort"][..]),
            ("/a: {realiability: reliable}", &["realiability", "reliability"]),
            ("/a: {depth: -1}", &["depth", "-1"]),
            ("/a: {depth: 0, history: keep_last}", &["depth", "0"]),
            ("/a: {deadline: {sec: 1, nsec: 0}}", &["deadline", "leave it out"]),
            ("/a: 5", &["profile of /a", "policies"]),
            ("- a", &["qos.yaml", "not a map"]),
            ("/a: {", &["qos.yaml", "YAML"]),
        ] {
            let error = parse(text).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
        }
    }

    #[test]
    fn a_reader_asks_for_no_more_than_every_writer_offers() {
        let of = |reliable, transient_local, depth| Qos { reliable, transient_local, depth };
        assert_eq!(adapted(&[of(true, true, 1), of(true, true, 30)]), of(true, true, 31));
        assert_eq!(adapted(&[of(true, true, 0), of(false, true, 0)]), of(false, true, 10));
        assert_eq!(adapted(&[of(true, false, 1), of(true, true, 1)]), of(true, false, 10));
    }

    #[test]
    fn profiles_of_numbers_and_of_words_are_read_and_mixed_ones_give_the_default() {
        let latched = Qos { reliable: false, depth: 3, transient_local: true };
        assert_eq!(offered_profiles(&latched.offered_qos_profiles()), (latched, false));
        let words =
            "- history: keep_last\n  depth: 3\n  reliability: best_effort\n  durability: transient_local\n";
        assert_eq!(offered_profiles(words), (latched, false));
        let unknown = Qos { depth: 0, ..latched };
        assert_eq!(offered_profiles(&unknown.offered_qos_profiles()).0.depth, 10);
        let mixed = format!("{}\n{}", latched.offered_qos_profiles(), Qos::STREAM.offered_qos_profiles());
        assert_eq!(offered_profiles(&mixed), (DEFAULT, true));
        assert_eq!(offered_profiles(""), (DEFAULT, false));
        assert_eq!(offered_profiles("{nonsense"), (DEFAULT, false));
    }
}
