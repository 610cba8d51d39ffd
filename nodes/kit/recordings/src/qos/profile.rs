//! One profile of rosbag2.

use grainlab_msgs::Qos;
use serde_json::Value;

/// Samples kept with the history `keep_all`: what a reader may hold in memory is bounded.
const KEEP_ALL: u32 = 10_000;

/// Seconds from which a duration counts as infinite: those of DDS are 2³¹ − 1, those of ROS 2 more.
const INFINITE: u64 = i32::MAX as u64;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Policies {
    reliable: Option<bool>,
    transient_local: Option<bool>,
    depth: Option<u32>,
}

/// A policy: its values as numbers of rmw and as words, and the meaning of each. All have 0, `system_default`, and 3,
/// `unknown`, which leave it to the default.
type Values = &'static [(u64, &'static str, bool)];

const RELIABILITY: Values = &[(1, "reliable", true), (2, "best_effort", false)];
const DURABILITY: Values = &[(1, "transient_local", true), (2, "volatile", false)];
/// True is `keep_all`, of any number.
const HISTORY: Values = &[(1, "keep_last", false), (2, "keep_all", true)];
const LIVELINESS: Values = &[(1, "automatic", true)];

const KEYS: [&str; 9] = [
    "history",
    "depth",
    "reliability",
    "durability",
    "deadline",
    "lifespan",
    "liveliness",
    "liveliness_lease_duration",
    "avoid_ros_namespace_conventions",
];

impl Policies {
    /// Those of a profile that somebody wrote.
    pub(super) fn strict(whole: &Value) -> Result<Self, String> {
        let Value::Object(profile) = whole else {
            return Err("it is not a map of policies, such as reliability: best_effort".to_owned());
        };
        if let Some(key) = profile.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(format!("there is no policy {key}; there are: {}", KEYS.join(", ")));
        }
        for key in ["deadline", "lifespan", "liveliness_lease_duration"] {
            if profile.get(key).is_some_and(|value| !is_unlimited(value)) {
                return Err(format!("a limited {key} is not supported: leave it out"));
            }
        }
        if profile.get("avoid_ros_namespace_conventions").is_some_and(|value| *value != Value::Bool(false)) {
            return Err("avoid_ros_namespace_conventions: true is not supported: leave it out".to_owned());
        }
        // Here 3 is that of each topic.
        if let Some(value) = profile.get("liveliness").filter(|value| value.as_u64() == Some(3)) {
            return Err(format!("liveliness: {value} is not one of system_default, automatic"));
        }
        if let Some(value) = profile.get("depth").filter(|value| depth(value).is_none_or(|n| n == 0)) {
            return Err(format!("depth: {value} is not a number of messages, 1 or more"));
        }
        for (key, values) in [
            ("reliability", RELIABILITY),
            ("durability", DURABILITY),
            ("history", HISTORY),
            ("liveliness", LIVELINESS),
        ] {
            profile.get(key).map_or(Ok(None), |value| one_of(key, value, values))?;
        }
        Ok(Self::lenient(whole))
    }

    /// Those of a recorded profile that can be read.
    pub(super) fn lenient(profile: &Value) -> Self {
        let policy = |key: &str, values| profile.get(key).and_then(|v| one_of(key, v, values).ok()).flatten();
        let depth = profile.get("depth").and_then(depth);
        Self {
            reliable: policy("reliability", RELIABILITY),
            transient_local: policy("durability", DURABILITY),
            depth: if policy("history", HISTORY) == Some(true) { Some(KEEP_ALL) } else { depth },
        }
    }

    pub(super) fn over(&self, qos: Qos) -> Qos {
        Qos {
            reliable: self.reliable.unwrap_or(qos.reliable),
            transient_local: self.transient_local.unwrap_or(qos.transient_local),
            depth: self.depth.unwrap_or(qos.depth),
        }
    }
}

fn depth(value: &Value) -> Option<u32> {
    value.as_u64().and_then(|n| u32::try_from(n).ok())
}

/// The meaning of a value, written as a number or as a word.
fn one_of(key: &str, value: &Value, values: Values) -> Result<Option<bool>, String> {
    let is = |number: u64, word: &str| value.as_u64() == Some(number) || value.as_str() == Some(word);
    if is(0, "system_default") || is(3, "unknown") {
        return Ok(None);
    }
    let found = values.iter().find(|(number, word, _)| is(*number, word));
    found.map(|(_, _, meaning)| Some(*meaning)).ok_or_else(|| {
        let words: Vec<&str> = values.iter().map(|(_, word, _)| *word).collect();
        format!("{key}: {value} is not one of system_default, {}", words.join(", "))
    })
}

/// True for a duration `{sec, nsec}` that is zero, which is the default, or infinite.
fn is_unlimited(duration: &Value) -> bool {
    let part = |key: &str| duration.get(key).and_then(Value::as_u64);
    match (part("sec"), part("nsec")) {
        (Some(sec), nsec) => sec >= INFINITE || sec == 0 && nsec.unwrap_or(0) == 0,
        _ => false,
    }
}
