//! `grainlab scene`: scenes, and their faults.

use clap::Subcommand;
use grainlab_console::{Failure, Table, print, say, worse};
use grainlab_core::{ServoLaw, non_rattlers};
use grainlab_micromechanics::unbalanced_force_ratio;
use grainlab_node_kit::Exit;
use grainlab_recordings::scenes::{self, SceneText};
use grainlab_scene::{BUILT_IN, Condition, Measure, Phase, PhaseKind, Scene};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;

/// Commands for scenes.
#[derive(Debug, Subcommand)]
pub(crate) enum SceneCommand {
    /// List the built-in scenes.
    List,
    /// Show the complete scene: bases applied, every default written out.
    Show(Show),
    /// Read scenes and list all their faults, and what to know of the others; exit 2 if there are any faults.
    Check(Check),
    /// Write a template of a scene, with comments.
    New(New),
    /// Show every key of the format with its unit, default and range, as Markdown.
    Keys,
}

/// A scene and its overrides.
#[derive(Debug, clap::Args)]
pub(crate) struct Show {
    /// Scene: a built-in name or a file
    #[arg(value_name = "SCENE")]
    scene: String,
    /// Set a key of the scene, as in grains.count=500; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Seed of every random choice [default: the one of the scene]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
}

/// Scenes to read.
#[derive(Debug, clap::Args)]
pub(crate) struct Check {
    /// Scenes: files or built-in names
    #[arg(value_name = "FILE", required = true)]
    scenes: Vec<String>,
}

/// A scene to write.
#[derive(Debug, clap::Args)]
pub(crate) struct New {
    /// Name of the scene; the file is NAME.toml, which must not exist
    #[arg(value_name = "NAME")]
    name: String,
    /// Write changes of this scene instead of a complete one
    #[arg(long, value_name = "SCENE")]
    base: Option<String>,
}

pub(crate) fn run(command: &SceneCommand) -> Result<Exit, Failure> {
    match command {
        SceneCommand::List => list(),
        SceneCommand::Show(show) => {
            print(&scenes::load(&show.scene, &show.set, show.seed)?.text)?;
            Ok(Exit::Done)
        }
        SceneCommand::Check(check) => check_all(&check.scenes),
        SceneCommand::New(new) => create(new),
        SceneCommand::Keys => {
            print(&grainlab_scene::reference())?;
            Ok(Exit::Done)
        }
    }
}

fn list() -> Result<Exit, Failure> {
    let mut lines = String::new();
    for (name, _) in BUILT_IN {
        lines += &format!("{name:10}{}\n", scenes::load(name, &[], None)?.scene.description);
    }
    print(&lines)?;
    Ok(Exit::Done)
}

/// Reads every scene, also after one with faults.
fn check_all(names: &[String]) -> Result<Exit, Failure> {
    let mut table = Table::new(["scene", "grains", "phases", "packings"]);
    let (mut exit, mut sound, mut notes) = (Exit::Done, false, Vec::new());
    for name in names {
        match scenes::load(name, &[], None) {
            Ok(found) => {
                let (scene, published) = (&found.scene, found.scene.phases.iter().filter(|p| p.publish));
                let numbers = [scene.grains as usize, scene.phases.len(), published.count()];
                table.row([name.clone()].into_iter().chain(numbers.map(|n| n.to_string())));
                notes.extend(notes_on(&found).into_iter().map(|note| format!("note: {name}, {note}\n")));
                sound = true;
            }
            Err(failure) => {
                say!("grainlab: {failure}");
                exit = worse(exit, failure.exit);
            }
        }
    }
    if sound {
        print(&(table.text() + &notes.concat()))?;
    }
    Ok(exit)
}

/// Notes on a scene, and on the packing that it starts from where no phase would call it at rest.
pub(super) fn notes_on(found: &SceneText) -> Vec<String> {
    let mut notes = found.scene.notes();
    let limit = |c: &Condition| match *c {
        Condition::AtMost(Measure::Unbalanced, limit) => Some(limit),
        _ => None,
    };
    let limits = found.scene.phases.iter().flat_map(|phase| phase.until.all.iter().filter_map(limit));
    let unbalanced = found.start.as_ref().and_then(|p| unbalanced_force_ratio(p, &non_rattlers(p)));
    if let (Some(found), Some(limit)) = (unbalanced, limits.reduce(f64::max))
        && found > limit
    {
        notes.push(format!(
            "forces of the packing to start from do not balance: the mean net force of a grain is {found:.1e} of the mean contact \
             force, and phases end at {limit:e} or less; the run begins with its motion"
        ));
    }
    notes
}

fn changes_of(base: &str, name: &str, scene: &Scene) -> String {
    let is_undamped = |phase: &Phase| {
        matches!(phase.kind, PhaseKind::Servo { law: ServoLaw::Normalised { leak: 0.0, .. }, .. })
    };
    let damped = "# The stress control of the base has leak = 0. If the stress swings about its target, damp it:\n# phase.\"*\".leak = 0.01\n";
    format!(
        "# What differs from {base}; `grainlab scene show {name}.toml` shows the whole.\nbase = {base:?}\nname = {name:?}\n{}",
        if scene.phases.iter().any(is_undamped) { damped } else { "" }
    )
}

fn create(new: &New) -> Result<Exit, Failure> {
    let name = &new.name;
    let text = match &new.base {
        None => grainlab_scene::template(name),
        Some(base) => changes_of(base, name, &scenes::load(base, &[], None)?.scene),
    };
    let path = PathBuf::from(format!("{name}.toml"));
    // An invalid name is refused before the file is created.
    grainlab_scene::assignment(&format!("name={name}"))
        .and_then(|name| {
            let mut draft = grainlab_scene::Draft::of_text(&grainlab_scene::template("new"))?;
            draft.set(name)?;
            draft.resolve()
        })
        .map_err(Failure::usage)?;
    let file = OpenOptions::new().write(true).create_new(true).open(&path);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(Failure::at(&path))?;
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Done)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene with a built-in base takes over its undamped stress control, which the default does not have.
    #[test]
    fn a_new_scene_from_an_undamped_base_has_the_line_that_damps_it() {
        let demo = Scene::parse(grainlab_scene::built_in("demo").unwrap()).unwrap();
        let text = changes_of("demo", "mine", &demo);
        let leaks = |text: &str| -> Vec<f64> {
            let leak = |phase: &Phase| match phase.kind {
                PhaseKind::Servo { law: ServoLaw::Normalised { leak, .. }, .. } => Some(leak),
                _ => None,
            };
            Scene::parse(text).unwrap().phases.iter().filter_map(leak).collect()
        };
        assert_eq!((leaks(&text), leaks(&text.replace("# phase.", "phase."))), (vec![0.0; 5], vec![0.01; 5]));
        let damped = Scene::parse(&grainlab_scene::template("new")).unwrap();
        assert!(!changes_of("new.toml", "mine", &damped).contains("leak"));
    }
}
