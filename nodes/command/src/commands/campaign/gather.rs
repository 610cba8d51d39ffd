//! The states of a campaign in one table, from the recordings alone.

use grainlab_campaign::{Campaign, Folder, Member, MemberState};
use grainlab_console::{Cell, Failure, count, print};
use grainlab_core::results::{InferredQuantity, QUANTITIES};
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_page::Dataset;
use grainlab_recordings::{Recording, scenes};
use grainlab_results::quantities::{columns, typed_cells};
use grainlab_results::read_back::{self, InvertedPacking};
use grainlab_results::{Inference, ORIGIN};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The state of a member at the end of a phase.
pub(crate) struct State<'a> {
    pub(crate) member: &'a Member,
    /// Name of the phase; empty if it is not known.
    pub(crate) phase: String,
    pub(crate) found: InvertedPacking,
}

/// Writes the states of all finished members beside them. The exit is 3 if a member is missing.
pub(super) fn run(campaign: &Campaign, folder: &Folder) -> Result<Exit, Failure> {
    let (states, exit) = states(campaign, folder)?;
    let [csv, parquet] = write(campaign, folder, &states)?;
    print(&format!("{}: {}, {}\n", count(states.len(), "state"), csv.display(), parquet.display()))?;
    Ok(exit)
}

/// Writes the table; the paths of its files.
pub(crate) fn write(
    campaign: &Campaign,
    folder: &Folder,
    states: &[State<'_>],
) -> Result<[PathBuf; 2], Failure> {
    let table = table(campaign, states);
    Ok([folder.write("states.csv", table.csv())?, folder.write("states.parquet", table.parquet()?)?])
}

/// The states of all finished members, in their order, and 3 if a member is missing.
pub(crate) fn states<'a>(campaign: &'a Campaign, folder: &Folder) -> Result<(Vec<State<'a>>, Exit), Failure> {
    let (finished, missing): (Vec<&Member>, Vec<&Member>) =
        campaign.members.iter().partition(|m| folder.state(m) == MemberState::Finished);
    if !missing.is_empty() {
        let members = campaign.members.len();
        grainlab_console::say!(
            "grainlab: {} of {members} members are not finished and not in the table: `grainlab campaign status {}`",
            missing.len(),
            folder.root().display()
        );
    }
    let found: Vec<Result<Vec<State<'a>>, String>> =
        finished.into_par_iter().map(|member| of_member(member, &folder.run(member))).collect();
    let mut exit = if missing.is_empty() { Exit::Done } else { Exit::DataLoss };
    let mut states = Vec::new();
    for member in found {
        match member {
            Ok(found) => states.extend(found),
            Err(why) => {
                grainlab_console::say!("grainlab: {why}");
                exit = Exit::DataLoss;
            }
        }
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
    Ok(back.states.into_iter().map(|found| State { member, phase: name(&found), found }).collect())
}

/// Member, what was set in it, phase, every quantity of the packing, and what each model inferred from its data.
fn table(campaign: &Campaign, states: &[State<'_>]) -> Dataset {
    let mut keys: Vec<&str> = Vec::new();
    for set in campaign.members.iter().flat_map(|m| &m.set) {
        if !keys.contains(&set.key.as_str()) {
            keys.push(&set.key);
        }
    }
    // The source is the member, and a recording has no time of a measurement.
    let origin = || ORIGIN.iter().filter(|q| !["source", "seconds"].contains(&q.key));
    let inferred: Vec<BTreeMap<String, Cell>> = states.iter().map(|s| inferred(&s.found.results)).collect();
    let mut names: Vec<&String> = inferred.iter().flat_map(BTreeMap::keys).collect();
    names.sort();
    names.dedup();
    let head = ["member", "scene", "seed"].map(str::to_owned).into_iter();
    let head = head.chain(keys.iter().map(|key| format!("set.{key}"))).chain(["phase_name".to_owned()]);
    let mut table = Dataset::new(
        head.chain(columns(origin())).chain(columns(QUANTITIES)).chain(names.iter().map(|n| (*n).clone())),
    );
    for (state, inferred) in states.iter().zip(&inferred) {
        let member = state.member;
        let text = |text: &str| Cell::Text(text.to_owned());
        let value = |key: &&str| member.set.iter().rfind(|s| s.key == **key).map(|s| text(&s.value));
        let head = [text(&member.name), text(&member.scene), Cell::Count(member.seed)].into_iter();
        let settings = keys.iter().map(|key| value(key).unwrap_or_default());
        let packing = &state.found.packing;
        let measured = typed_cells(origin(), packing).chain(typed_cells(QUANTITIES, &packing.report));
        let models = names.iter().map(|name| inferred.get(*name).cloned().unwrap_or_default());
        table.row(head.chain(settings).chain([text(&state.phase)]).chain(measured).chain(models));
    }
    table
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
