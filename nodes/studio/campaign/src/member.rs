//! A member of a campaign: one run.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A key of the scene and its value, as `KEY=VALUE` on a command line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    /// The key, such as `grains.count`.
    pub key: String,
    /// The value in TOML, without the quotes of a plain text.
    pub value: String,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value)
    }
}

/// One run: a scene, its seed, and what is set in it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Member {
    /// Name of its folder: the scene, the values that distinguish it, the seed.
    pub name: String,
    /// A built-in scene, or the whole path of a file.
    pub scene: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// Keys set in the scene.
    pub set: Vec<Setting>,
}

impl Member {
    /// A member, named after its scene, the settings from number `common` on, and its seed.
    pub(crate) fn new(scene: &str, seed: u64, set: Vec<Setting>, common: usize) -> Self {
        let own = set.iter().skip(common).map(|s| {
            let key = s.key.strip_prefix("phase.*.").unwrap_or(&s.key);
            format!("-{key}={}", plain(&s.value))
        });
        let stem = stem(scene).to_owned();
        let name: String = std::iter::once(stem).chain(own).chain([format!("-{seed}")]).collect();
        Self { name: file_name(&name), scene: scene.to_owned(), seed, set }
    }

    /// The scene without its folder, which differs between machines.
    pub fn scene_name(&self) -> &str {
        stem(&self.scene)
    }

    /// The settings as arguments of a command.
    pub fn sets(&self) -> Vec<String> {
        self.set.iter().map(ToString::to_string).collect()
    }
}

fn stem(scene: &str) -> &str {
    let file = scene.rsplit('/').next().unwrap_or(scene);
    file.strip_suffix(".toml").unwrap_or(file)
}

/// One text for each number, so that two spellings of it give one name.
fn plain(value: &str) -> String {
    let number = value.parse::<f64>().ok().filter(|x| *x == 0.0 || (1e-6..1e15).contains(&x.abs()));
    number.map_or_else(|| value.to_owned(), |x| x.to_string())
}

/// Other characters than letters, digits and some marks become `_`.
fn file_name(name: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || "._-=+".contains(c) { c } else { '_' };
    let name: String = name.chars().map(safe).collect();
    if name.starts_with('.') { format!("_{name}") } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_is_named_after_what_distinguishes_it() {
        let set = |key: &str, value: &str| Setting { key: key.into(), value: value.into() };
        let member = Member::new(
            "/a/b/uniaxial.toml",
            3,
            vec![set("grains.count", "500"), set("friction", "0.05")],
            1,
        );
        assert_eq!((member.name.as_str(), member.scene_name()), ("uniaxial-friction=0.05-3", "uniaxial"));
        assert_eq!(member.sets(), ["grains.count=500", "friction=0.05"]);
        let member =
            Member::new("s2", 1, vec![set("phase.*.drag", "1000.0"), set("phase.settle-*.x", "1")], 0);
        assert_eq!(member.name, "s2-drag=1000-phase.settle-_.x=1-1");
        let named = |value| Member::new("s", 1, vec![set("pressure", value)], 0).name;
        assert_eq!(
            ["5e4", "50000.0", "50_000"].map(named),
            ["50000", "50000", "50_000"].map(|p| format!("s-pressure={p}-1"))
        );
        assert_eq!(Member::new("..", 1, vec![set("a", "x/../y")], 0).name, "_..-a=x_.._y-1");
    }
}
