//! The states of a campaign in one table, from the recordings alone.

use grainlab_campaign::{Campaign, Folder, Member, Standing};
use grainlab_console::{Cell, Failure, count, print};
use grainlab_core::quantity::{Quantity, Shape};
use grainlab_core::results::{InferredQuantity, QUANTITIES};
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_page::Dataset;
use grainlab_recordings::{METADATA_RECORD, Recording, scenes};
use grainlab_results::quantities::{columns, typed_cells};
use grainlab_results::read_back::{self, InvertedPacking};
use grainlab_results::{Inference, ORIGIN};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Columns that differ from run to run of the same campaign.
const OF_RUN: [&str; 4] = ["grainlab_version", "commit", "host", "begun"];

/// The state of a member at the end of a phase.
pub(crate) struct State<'a> {
    pub(crate) member: &'a Member,
    /// Name of the phase; empty if it is not known.
    pub(crate) phase: String,
    pub(crate) found: InvertedPacking,
    /// Cells of [`OF_RUN`].
    of_run: [Cell; 4],
}

/// Writes the tables beside the members. The exit is 3 if a member is missing.
pub(super) fn run(campaign: &Campaign, folder: &Folder) -> Result<Exit, Failure> {
    let _lock = folder.lock_tables()?;
    let (states, exit) = states(campaign, folder)?;
    print(&write(campaign, folder, &states)?)?;
    Ok(exit)
}

/// Writes the tables; a line for each, with the paths of its files.
pub(crate) fn write(campaign: &Campaign, folder: &Folder, states: &[State<'_>]) -> Result<String, Failure> {
    let (mut table, keys) = table(campaign, states);
    let by: Vec<&str> = keys.iter().map(String::as_str).collect();
    // An axis has no sign, so that components of several have no mean: that of their fabric has the direction.
    let axes = QUANTITIES.iter().filter(|q| matches!(q.shape, Shape::Vector)).flat_map(Quantity::columns);
    let without: Vec<String> = axes.chain(["seed".to_owned()]).collect();
    let without: Vec<&str> = without.iter().map(String::as_str).collect();
    let groups = table.means(&by, &without);
    let csv = folder.write("states.csv", table.csv())?;
    table.extend(OF_RUN.map(str::to_owned).into(), states.iter().map(|s| s.of_run.to_vec()));
    let states = [csv, folder.write("states.parquet", table.parquet()?)?];
    let means =
        [folder.write("groups.csv", groups.csv())?, folder.write("groups.parquet", groups.parquet()?)?];
    let line = |n: usize, name: &str, [csv, parquet]: [PathBuf; 2]| {
        format!("{}: {}, {}\n", count(n, name), csv.display(), parquet.display())
    };
    Ok(line(table.len(), "state", states) + &line(groups.len(), "group", means))
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
    let found: Vec<Result<Vec<State<'a>>, String>> =
        finished.into_par_iter().map(|(member, _)| of_member(member, &folder.run(member))).collect();
    let mut exit = if missing.is_empty() { Exit::Done } else { Exit::DataLoss };
    let (mut states, mut empty, mut unread) = (Vec::new(), 0, 0);
    for member in found {
        match member {
            Ok(found) => {
                empty += usize::from(found.is_empty());
                states.extend(found);
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
    if empty > 0 {
        let members = count(empty, "member");
        grainlab_console::say!(
            "grainlab: {members} published no packing at the end of a phase: set publish = true in one"
        );
    }
    Ok((states, exit))
}

fn of_member<'a>(member: &'a Member, run: &Path) -> Result<Vec<State<'a>>, String> {
    let failed = |e: &dyn std::fmt::Display| {
        let run = run.display();
        format!("member {} is not in the table: {e}; remove {run} to run it again", member.name)
    };
    let recording = Recording::open(run).map_err(|e| failed(&e))?;
    let path = run.join("scene.toml");
    let scene = scenes::load(&path.to_string_lossy(), &[], None).map_err(|e| failed(&e))?;
    let recorded = recording.stored_files().into_iter().find(|file| file.name == "scene.toml");
    if recorded.is_none_or(|file| file.bytes != scene.text.as_bytes()) || scene.scene.seed != member.seed {
        return Err(failed(&"its recording has another scene or seed"));
    }
    let scene = scene.scene;
    let back = read_back::read(&recording);
    if let Some(complaint) = back.complaints.first() {
        return Err(failed(complaint));
    }
    let name = |found: &InvertedPacking| {
        let phase = found.packing.position.and_then(|p| p.phase.checked_sub(1));
        phase.and_then(|n| scene.phases.get(n)).map_or_else(String::new, |p| p.name.clone())
    };
    let metadata = recording.metadata(METADATA_RECORD).unwrap_or_default();
    let cell = |text: Option<String>| text.map_or(Cell::Unknown, Cell::Text);
    let stored = |key: &str| cell(metadata.get(key).cloned());
    let of_run = [stored("grainlab"), stored("commit"), stored("host"), cell(recording.begun())];
    let state = |found| State { member, phase: name(&found), found, of_run: of_run.clone() };
    Ok(back.states.into_iter().map(state).collect())
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
                cells.insert(format!("{prefix}.{q}_stddev"), number(r.sigma[q]));
            }
        }
        cells.insert(format!("{prefix}.status"), Cell::Text(r.status.to_owned()));
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

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
