//! Settings in which the scenes of runs differ.

use crate::run::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use toml::{Table, Value};

/// Keys of a scene that change nothing in it but the random numbers.
const NO_SETTINGS: [&str; 3] = ["name", "description", "seed"];

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Setting {
    /// Key of the scene; of several with the same values, the last parts of all.
    pub(crate) name: String,
    /// Unit of the values; may be empty.
    pub(crate) unit: &'static str,
    pub(crate) values: Vec<String>,
    /// Last parts of keys with other values that change together with these.
    pub(crate) with: BTreeSet<String>,
}

/// Most settings that a figure shows: one along its axis, one as lines.
const MOST_OF_A_FIGURE: usize = 2;

impl Setting {
    /// Writes numbers without a zero after the point, and stresses in kPa.
    fn shorten(&mut self) {
        let Some(numbers) = self.numbers() else { return };
        let is_stress = ["stress", "pressure"].contains(&self.name.rsplit('.').next().unwrap_or_default());
        let unit = if is_stress { 1e3 } else { 1.0 };
        self.values = numbers.iter().map(|v| (v / unit).to_string()).collect();
        self.unit = if is_stress { "kPa" } else { "" };
    }

    pub(crate) fn header(&self) -> String {
        [&*self.name, self.unit].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
    }

    pub(crate) fn of(&self, value: impl Display) -> String {
        format!("{value} {}", self.unit).trim_end().to_owned()
    }

    /// Takes a key that changes together with this one.
    fn join(&mut self, other: &Self) {
        let last = |key: &str| key.rsplit('.').next().unwrap_or(key).to_owned();
        let parts = |setting: &Self| setting.name.split(", ").map(last).collect::<BTreeSet<String>>();
        if self.values == other.values {
            self.name = parts(self).union(&parts(other)).cloned().collect::<Vec<_>>().join(", ");
        } else {
            self.with.extend(parts(other));
        }
        self.with.extend(other.with.iter().cloned());
    }

    /// False for numbers that rise and fall independently, as those of a random design.
    fn goes_with(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.numbers(), other.numbers()) else { return true };
        let mut pairs: Vec<(f64, f64)> = a.into_iter().zip(b).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.is_sorted_by(|a, b| a.1 <= b.1) || pairs.is_sorted_by(|a, b| a.1 >= b.1)
    }

    /// The values, if all are numbers.
    pub(crate) fn numbers(&self) -> Option<Vec<f64>> {
        self.values.iter().map(|v| v.parse().ok().filter(|v: &f64| v.is_finite())).collect()
    }

    pub(crate) fn different(&self) -> usize {
        self.values.iter().collect::<BTreeSet<_>>().len()
    }
}

/// The settings in which the runs differ. Keys that change together, as the friction of several phases, are one setting, and
/// all that differs between scenes alone is the setting `scene`.
pub(crate) fn differing(runs: &[&Run]) -> Vec<Setting> {
    let scenes: Vec<String> = runs.iter().map(|run| run.scene_name()).collect();
    let tables: Vec<BTreeMap<String, String>> = runs.iter().map(|run| keys(&run.scene_text)).collect();
    let names: BTreeSet<&String> = tables.iter().flat_map(BTreeMap::keys).collect();
    let mut found: Vec<(Vec<usize>, Setting)> = Vec::new();
    let firsts = |values: &[String]| -> Vec<usize> {
        values.iter().map(|v| values.iter().position(|w| w == v).unwrap_or(0)).collect()
    };
    let of_scene = firsts(&scenes);
    for name in names {
        let values: Vec<String> = tables.iter().map(|t| t.get(name).cloned().unwrap_or_default()).collect();
        if values.iter().zip(&of_scene).all(|(v, first)| *v == values[*first]) {
            continue;
        }
        let new = Setting { name: name.clone(), values, ..Setting::default() };
        let pattern = firsts(&new.values);
        let Some((_, known)) = found.iter_mut().find(|(p, known)| *p == pattern && known.goes_with(&new))
        else {
            found.push((pattern, new));
            continue;
        };
        known.join(&new);
        // Values have their keys where not every scene has these, as for laws of sizes.
        let word = |key: &str| key.rsplit('.').next().unwrap_or(key).to_owned();
        for (value, other) in known
            .values
            .iter_mut()
            .zip(&new.values)
            .filter(|(value, other)| value.is_empty() != other.is_empty() || value.contains(' '))
        {
            if !other.is_empty() {
                let more = format!("{} {other}", word(name));
                *value = if value.is_empty() { more } else { format!("{value}, {more}") };
            }
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let of_scenes = of_scene.iter().any(|first| *first > 0);
    // A key whose values follow from those of another one, as a drag that was set with each size, would be a third setting.
    let follows = |b: &[usize], a: &[usize]| a != b && a.iter().zip(b).all(|(a, other)| b[*a] == *other);
    while found.len() + usize::from(of_scenes) > MOST_OF_A_FIGURE {
        let pairs = (0..found.len()).flat_map(|a| (0..found.len()).map(move |b| (a, b)));
        let joins = |(a, b): &(usize, usize)| {
            follows(&found[*b].0, &found[*a].0) && found[*a].1.goes_with(&found[*b].1)
        };
        let Some((a, b)) = pairs.into_iter().find(joins) else { break };
        let follower = found[b].1.clone();
        found[a].1.join(&follower);
        found.remove(b);
    }
    let mut settings: Vec<Setting> = found.into_iter().map(|(_, setting)| setting).collect();
    if of_scenes {
        settings.push(Setting { name: "scene".to_owned(), values: scenes, ..Setting::default() });
    }
    settings.iter_mut().for_each(Setting::shorten);
    for setting in settings.iter_mut().filter(|s| !s.with.is_empty()) {
        setting.name += &format!(" (with {})", setting.with.iter().cloned().collect::<Vec<_>>().join(", "));
    }
    settings
}

/// The keys of a scene with dots, phases by their names.
pub(crate) fn keys(text: &str) -> BTreeMap<String, String> {
    let mut table: Table = text.parse().unwrap_or_default();
    NO_SETTINGS.iter().for_each(|key| _ = table.remove(*key));
    let mut found = BTreeMap::new();
    flatten(&Value::Table(table), String::new(), &mut found);
    found
}

fn flatten(value: &Value, path: String, found: &mut BTreeMap<String, String>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| flatten(value, below(key), found)),
        Value::Array(all) => {
            for (n, value) in all.iter().enumerate() {
                let name = value.get("name").and_then(Value::as_str);
                flatten(value, below(&name.map_or_else(|| (n + 1).to_string(), str::to_owned)), found);
            }
        }
        // Phases of one name are told apart together. Numbers that differ by rounding alone are equal.
        value => {
            let rounded = value.as_float().and_then(|v| format!("{v:.12e}").parse::<f64>().ok());
            let text = rounded.map(|v| Value::Float(v).to_string());
            let text = text.or_else(|| value.as_str().map(str::to_owned));
            *found.entry(path).or_default() += &text.unwrap_or_else(|| value.to_string())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_whose_values_follow_from_those_of_another_is_no_third_setting() {
        let of = |spread: f64, count: u32, drag: f64| {
            let mut run = Run::default();
            run.scene_text = format!("numerics.skin = {spread}\ngrains.count = {count}\nphase.drag = {drag}");
            run
        };
        let all = [0.1, 0.2].map(|s| [(50, 3e3), (100, 1.5e3), (200, 1.5e3)].map(|(n, drag)| of(s, n, drag)));
        let found = differing(&all.iter().flatten().collect::<Vec<_>>());
        let names: Vec<(&str, usize)> = found.iter().map(|s| (s.name.as_str(), s.different())).collect();
        assert_eq!(names, [("numerics.skin", 2), ("grains.count (with drag)", 3)]);
    }

    #[test]
    fn settings_of_a_random_design_stay_apart() {
        let of = |[mu, drag, spread]: [f64; 3]| {
            let mut run = Run::default();
            run.scene_text = format!("friction = {mu}\ndrag = {drag}\nspread = {spread}");
            run
        };
        let runs = [[0.1, 3e3, 0.02], [0.2, 1e3, 0.03], [0.3, 2e3, 0.01]].map(of);
        let names = |runs: &[&Run]| differing(runs).into_iter().map(|s| s.name).collect::<Vec<_>>();
        assert_eq!(names(&runs.each_ref()), ["drag", "friction", "spread"]);
        assert_eq!(names(&[&runs[0], &runs[1]]), ["drag (with friction, spread)"]);
    }

    #[test]
    fn keys_that_change_together_are_one_setting_and_a_seed_is_none() {
        let of = |seed: u32, mu: f64, grains: u32| {
            let phases = "phase = [{name = 'a', friction = MU}, {name = 'b', friction = MU, rate = [0, 1]}]";
            let text = format!("seed = {seed}\ngrains.count = {grains}\n{phases}");
            let mut run = Run::default();
            run.scene_text = text.replace("MU", &mu.to_string()) + &format!("\nnumerics.skin = {mu}");
            run
        };
        let runs = [of(1, 0.1, 80), of(2, 0.1, 80), of(1, 0.3, 90), of(2, 0.1, 90)];
        let found = differing(&runs.each_ref());
        let names: Vec<(&str, usize)> = found.iter().map(|s| (s.name.as_str(), s.different())).collect();
        assert_eq!(names, [("friction, skin", 2), ("grains.count", 2)]);
        assert_eq!(found[0].numbers(), Some(vec![0.1, 0.1, 0.3, 0.1]));
        assert!(differing(&[&runs[0], &runs[1]]).is_empty());
    }
}
