//! The command of a member.

use crate::campaign::Campaign;
use crate::folder::Folder;
use crate::member::Member;
use grainlab_console::{Failure, program};
use grainlab_results::brief::quoted;

/// Program and arguments that begin, continue or keep the run of a member, in one process or several.
pub(crate) fn command(campaign: &Campaign, folder: &Folder, member: &Member) -> Result<Vec<String>, Failure> {
    let program = program().map_err(|e| Failure::failed(format!("own path: {e}")))?;
    let mut words: Vec<String> = program.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    words.extend(["launch".into(), campaign.launch.clone()]);
    words.extend(campaign.arguments.iter().cloned());
    words.extend(["--scene".into(), member.scene.clone(), "--seed".into(), member.seed.to_string()]);
    for set in member.sets() {
        words.extend(["--set".into(), set]);
    }
    let record = if campaign.record_all { "all" } else { "results" };
    words.extend(["--record".into(), record.into()]);
    let flags = [("--one-process", !campaign.processes), ("--no-report", !campaign.report)];
    words.extend(flags.into_iter().filter(|(_, given)| *given).map(|(flag, _)| flag.to_owned()));
    words.extend(["--run".into(), folder.run(member).to_string_lossy().into_owned()]);
    Ok(words)
}

/// A command as a line for a shell.
pub(crate) fn line(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_line_says_scene_seed_settings_and_directory() {
        let root = tempfile::tempdir().unwrap();
        let text =
            "name = 'x'\nscenes = ['s1']\nseeds = [7]\nset = { description = \"it's\" }\nlaunch = 'acoustic'";
        let campaign = Campaign::parse(text, Path::new("")).unwrap();
        let folder = Folder::create(root.path(), &campaign).unwrap();
        let line = line(&command(&campaign, &folder, &campaign.members[0]).unwrap());
        let end = format!(
            " launch acoustic --scene s1 --seed 7 --set 'description=it'\\''s' --record results --one-process --no-report --run {}/members/s1-7",
            folder.root().display()
        );
        assert!(line.ends_with(&end), "{line}");
    }
}
