//! The states of a campaign in one table, from the recordings alone.

use crate::commands::launch::another_scene;
use grainlab_campaign::{Campaign, Folder, Member, Standing};
use grainlab_console::{Cell, Failure, count, print};
use grainlab_core::quantity::{Quantity, Shape};
use grainlab_core::results::{InferredQuantity, QUANTITIES};
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_page::Dataset;
use grainlab_recordings::{Recording, scenes};
use grainlab_results::quantities::{columns, typed_cells};
use grainlab_results::read_back::{self, InvertedPacking};
use grainlab_results::{Inference, ORIGIN};
use grainlab_scene::Scene;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// The state of a member at the end of a phase.
pub(crate) struct State<'a> {
    pub(crate) member: &'a Member,
    /// Name of the phase; empty if it is not known.
    pub(crate) phase: String,
    pub(crate) found: InvertedPacking,
}

/// Writes the tables beside the members. The exit is 3 if a member is missing.
pub(super) fn run(campaign: &Campaign, folder: &Folder) -> Result<Exit, Failure> {
    let _lock = folder.lock_tables()?;
    let (states, exit) = states(campaign, folder)?;
    print(&write(campaign, folder, &states)?)?;
    Ok(exit)
}

/// Writes the tables; a line for each, with the path of its file.
pub(crate) fn write(campaign: &Campaign, folder: &Folder, states: &[State<'_>]) -> Result<String, Failure> {
    let (table, keys) = table(campaign, states);
    let by: Vec<&str> = keys.iter().map(String::as_str).collect();
    // An axis has no sign, so that components of several have no mean: that of their fabric has the direction.
    let axes = QUANTITIES.iter().filter(|q| matches!(q.shape, Shape::Vector)).flat_map(Quantity::columns);
    let without: Vec<String> = axes.chain(["seed".to_owned()]).collect();
    let without: Vec<&str> = without.iter().map(String::as_str).collect();
    let groups = table.means(&by, &without);
    let line = |name: &str, file: &str, table: &Dataset| -> Result<String, Failure> {
        let path = folder.write(file, table.csv())?;
        Ok(format!("{}: {}\n", count(table.len(), name), path.display()))
    };
    Ok(line("state", "states.csv", &table)? + &line("group", "groups.csv", &groups)?)
}

/// The states of all finished members, in their order, and 3 if a member is missing.
pub(crate) fn states<'a>(campaign: &'a Campaign, folder: &Folder) -> Result<(Vec<State<'a>>, Exit), Failure> {
    let all = campaign.members.iter().map(|member| (member, folder.standing(member)));
    let (finished, missing): (Vec<_>, Vec<_>) = all.partition(|(_, standing)| standing.state == "finished");
    let others = folder.others(campaign);
    if others > 0 {
        let (runs, root) = (count(others, "run"), folder.root().display());
        grainlab_console::say!(
            "grainlab: {runs} in {root} are of no member of its campaign.toml: the tables leave them out"
        );
    }
    let found: Vec<Result<Found<'a>, String>> =
        finished.into_par_iter().map(|(member, _)| of_member(member, &folder.run(member))).collect();
    let mut exit = if missing.is_empty() { Exit::Done } else { Exit::DataLoss };
    let (mut states, mut empty, mut unread, mut without_scene) = (Vec::new(), 0, 0, 0);
    for member in found {
        match member {
            Ok(found) => {
                empty += usize::from(found.states.is_empty());
                without_scene += usize::from(found.without_scene);
                states.extend(found.states);
            }
            Err(why) => {
                grainlab_console::say!("grainlab: {why}");
                unread += 1;
                exit = Exit::DataLoss;
            }
        }
    }
    if !missing.is_empty() {
        let standings: Vec<Standing> = missing.iter().map(|(_, standing)| standing.clone()).collect();
        grainlab_console::say!(
            "grainlab: {} of {} are not in the tables: {}{}: `grainlab campaign status {}`",
            missing.len() + unread,
            count(campaign.members.len(), "member"),
            Standing::words(&standings),
            if unread > 0 { format!(", {unread} as above") } else { String::new() },
            folder.root().display()
        );
    }
    if without_scene > 0 {
        let members = count(without_scene, "member");
        grainlab_console::say!(
            "grainlab: {members}: the file of the scene is not there, so only the seed and what is set were compared with the recording"
        );
    }
    if empty > 0 {
        let members = count(empty, "member");
        grainlab_console::say!(
            "grainlab: {members} published no packing at the end of a phase: set publish = true in one"
        );
    }
    Ok((states, exit))
}

struct Found<'a> {
    states: Vec<State<'a>>,
    without_scene: bool,
}

fn of_member<'a>(member: &'a Member, run: &Path) -> Result<Found<'a>, String> {
    let failed = |e: &dyn std::fmt::Display| {
        let run = run.display();
        format!("member {} is not in the table: {e}; remove {run} to run it again", member.name)
    };
    let recording = Recording::open(run).map_err(|e| failed(&e))?;
    let recorded = recording.stored_files().into_iter().find(|file| file.name == "scene.toml");
    let recorded = recorded.ok_or_else(|| failed(&"its recording has no scene"))?;
    let recorded = String::from_utf8_lossy(&recorded.bytes);
    let scene = scene_of(member, &recorded).map_err(|e| failed(&e))?;
    let without_scene = scene.is_none();
    let scene = scene.map_or_else(|| Scene::parse(&recorded), Ok).map_err(|e| failed(&e))?;
    let back = read_back::read(&recording);
    if let Some(complaint) = back.complaints.first() {
        return Err(failed(complaint));
    }
    let name = |found: &InvertedPacking| {
        let phase = found.packing.position.as_ref().and_then(|p| p.phase.checked_sub(1));
        phase.and_then(|n| scene.phases.get(n)).map_or_else(String::new, |p| p.name.clone())
    };
    let state = |found| State { member, phase: name(&found), found };
    Ok(Found { states: back.states.into_iter().map(state).collect(), without_scene })
}

/// Reads the scene of a member, and refuses a recording (`recorded`) of another scene, seed or value.
/// `None` if the file of the scene is not there, as on another machine: then only what is set in the scene is compared.
fn scene_of(member: &Member, recorded: &str) -> Result<Option<Scene>, String> {
    let read = |scene: &str| scenes::read(scene, &member.sets(), Some(member.seed));
    let is_file = member.scene.contains('/');
    let (expected, found) = if is_file && !Path::new(&member.scene).exists() {
        let plain = |scene: Scene| Scene { description: String::new(), fingerprint: 0, ..scene };
        let set = Scene::parse(recorded).map_err(|e| e.to_string())?;
        match read(recorded) {
            // Cycles are unrolled in a recording: their keys cannot be set again.
            Err(_) => return Ok(None),
            Ok(again) if plain(again.scene.clone()) == plain(set) => return Ok(None),
            Ok(again) => (again.text, None),
        }
    } else {
        let own = read(&member.scene).map_err(|e| e.to_string())?;
        (own.text, Some(own.scene))
    };
    if expected == recorded {
        return Ok(found);
    }
    let (other, scene) = (another_scene(recorded, &expected), &member.scene);
    Err(format!(
        "its recording has {other} than the campaign states: scene {scene}, seed {}, {}",
        member.seed,
        member.sets().join(", ")
    ))
}

/// Member, what was set in it, phase, every quantity of the packing, and what each model inferred from its data; and the
/// columns in which states of several seeds agree.
fn table(campaign: &Campaign, states: &[State<'_>]) -> (Dataset, Vec<String>) {
    let mut keys: Vec<&str> = Vec::new();
    for set in campaign.members.iter().flat_map(|m| &m.set) {
        if !keys.contains(&set.key.as_str()) {
            keys.push(&set.key);
        }
    }
    let value = |state: &State<'_>, key: &str| {
        state.member.set.iter().rfind(|s| s.key == key).map(|s| s.value.clone())
    };
    let settings = keys.iter().map(|key| typed(states.iter().map(|s| value(s, key)).collect()));
    let settings: Vec<Vec<Cell>> = settings.collect();
    // The source is the member, and a recording has no time of a measurement.
    let origin = || ORIGIN.iter().filter(|q| !["source", "wall_time_s"].contains(&q.key));
    let inferred: Vec<BTreeMap<String, Cell>> = states.iter().map(|s| inferred(&s.found.results)).collect();
    let mut names: Vec<&String> = inferred.iter().flat_map(BTreeMap::keys).collect();
    names.sort();
    names.dedup();
    let head = ["member", "scene", "seed"].map(str::to_owned).into_iter();
    let keys: Vec<String> = keys.iter().map(|key| format!("set.{key}")).collect();
    let head = head.chain(keys.iter().cloned()).chain(["phase_name".to_owned()]);
    let mut table = Dataset::new(
        head.chain(columns(origin())).chain(columns(QUANTITIES)).chain(names.iter().map(|n| (*n).clone())),
    );
    for (n, (state, inferred)) in states.iter().zip(&inferred).enumerate() {
        let member = state.member;
        let text = |text: &str| Cell::Text(text.to_owned());
        let head = [text(&member.name), text(member.scene_name()), Cell::Count(member.seed)].into_iter();
        let settings = settings.iter().map(|values| values[n].clone());
        let packing = &state.found.packing;
        let measured = typed_cells(origin(), packing).chain(typed_cells(QUANTITIES, &packing.report));
        let models = names.iter().map(|name| inferred.get(*name).cloned().unwrap_or_default());
        table.row(head.chain(settings).chain([text(&state.phase)]).chain(measured).chain(models));
    }
    let alike = ["scene", "phase_name", "phase"].map(str::to_owned).into_iter().chain(keys);
    (table, alike.collect())
}

/// The values of a setting: numbers if all are, else text.
fn typed(values: Vec<Option<String>>) -> Vec<Cell> {
    let plain = |text: &str| text.replace('_', "");
    let count = |text: &str| plain(text).parse().ok().map(Cell::Count);
    let number = |text: &str| plain(text).parse().ok().filter(|v: &f64| v.is_finite()).map(Cell::Number);
    let flag = |text: &str| text.parse().ok().map(Cell::Flag);
    let as_one = |of: &dyn Fn(&str) -> Option<Cell>| -> Option<Vec<Cell>> {
        values.iter().map(|value| value.as_deref().map_or(Some(Cell::Unknown), of)).collect()
    };
    let found = as_one(&count).or_else(|| as_one(&number)).or_else(|| as_one(&flag));
    found.unwrap_or_else(|| values.into_iter().map(|v| v.map_or(Cell::Unknown, Cell::Text)).collect())
}

/// Estimates of each model: `MODEL.k`, its standard deviation `MODEL.k_stddev`, …, `MODEL.status`. Data other than the report of the packing and
/// the name of a node, where several infer, precede the model.
fn inferred(results: &[Inference]) -> BTreeMap<String, Cell> {
    let mut cells = BTreeMap::new();
    for r in results {
        let data = r.origin.source.as_deref().filter(|source| *source != topics::PACKING_REPORT.name);
        // Reports of several programs need their topic, too.
        let data = if r.origin.measurement.is_some() { r.origin.source.as_deref() } else { data };
        let measurement = r.origin.measurement.as_ref().map(|m| m.label.as_str());
        let by = r.origin.by.as_deref().filter(|by| !by.ends_with("emt_inversion"));
        let parts = [data, measurement, by, Some(&r.model)];
        let prefix = parts.into_iter().flatten().collect::<Vec<_>>().join(".");
        let number = |v: Option<f64>| v.map_or(Cell::Unknown, Cell::Number);
        for q in InferredQuantity::ALL {
            if let Some(value) = r.values[q] {
                cells.insert(format!("{prefix}.{q}"), Cell::Number(value));
                cells.insert(format!("{prefix}.{q}_stddev"), number(r.sigma(q)));
            }
        }
        cells.insert(format!("{prefix}.status"), Cell::Text(r.status.to_string()));
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_campaign::Setting;

    fn member(scene: &str, seed: u64, friction: &str) -> Member {
        let set = vec![Setting { key: "friction".into(), value: friction.into() }];
        Member { name: "m".into(), scene: scene.into(), seed, set }
    }

    fn recorded(member: &Member) -> String {
        scenes::read(&member.scene, &member.sets(), Some(member.seed)).unwrap().text
    }

    #[test]
    fn a_recording_of_another_scene_seed_or_value_is_not_that_of_the_member() {
        let own = member("demo", 1, "0.3");
        assert!(scene_of(&own, &recorded(&own)).unwrap().is_some_and(|scene| scene.phases.len() > 1));
        for other in [member("demo", 1, "0.1"), member("demo", 2, "0.3"), member("s2", 1, "0.3")] {
            let error = scene_of(&own, &recorded(&other)).unwrap_err();
            assert!(error.contains("another scene (line") && error.contains("friction=0.3"), "{error}");
        }
    }

    #[test]
    fn what_is_set_is_compared_without_the_file_of_the_scene_and_all_of_it_with_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let write =
            |more: &str| std::fs::write(&path, format!("base = 'demo'\nname = 'mine'\n{more}")).unwrap();
        write("");
        let of = |friction: &str| member(&path.to_string_lossy(), 1, friction);
        let texts = ["0.1", "0.3"].map(|friction| recorded(&of(friction)));
        write("grains.count = 77");
        assert!(scene_of(&of("0.1"), &texts[0]).unwrap_err().contains("another scene"));
        std::fs::remove_file(&path).unwrap();
        assert_eq!(scene_of(&of("0.1"), &texts[0]), Ok(None));
        assert!(scene_of(&of("0.1"), &texts[1]).unwrap_err().contains("another scene"));
    }

    #[test]
    fn a_setting_is_a_number_where_every_value_is_one_and_keeps_its_text_elsewhere() {
        let of = |values: &str| typed(values.split(' ').map(|v| Some(v.to_owned())).collect());
        assert_eq!(of("1_000 20"), [1000, 20].map(Cell::Count));
        assert_eq!(of("0.1 3 -1e2"), [0.1, 3.0, -100.0].map(Cell::Number));
        // An infinite number would be an empty cell.
        assert_eq!(of("0.1 inf"), ["0.1", "inf"].map(|text| Cell::Text(text.to_owned())));
        assert_eq!(typed(vec![None, Some("true".into())]), [Cell::Unknown, Cell::Flag(true)]);
    }
}
