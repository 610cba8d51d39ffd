//! Members as an array of tasks of a scheduler.

use crate::campaign::Campaign;
use crate::command::{command, line};
use crate::folder::Folder;
use grainlab_console::{Failure, say};
use grainlab_results::brief::quoted;
use std::slice::Chunks;

/// The members of each task, at least `wished` of them, where an array has at most `most` tasks.
pub(super) fn tasks(members: &[usize], wished: Option<u32>, most: usize) -> Chunks<'_, usize> {
    let (wished, needed) = (wished.map_or(1, |n| n as usize), members.len().div_ceil(most));
    if needed > wished {
        say!("grainlab: an array has at most {most} tasks here: each runs {needed} members in turn");
    }
    members.chunks(wished.max(needed))
}

/// The script of a task, whose number is `task` in a shell, with these options for sbatch.
pub(super) fn script(
    campaign: &Campaign,
    folder: &Folder,
    tasks: Chunks<'_, usize>,
    task: &str,
    options: &[String],
) -> Result<String, Failure> {
    let mut script = "#!/bin/sh\n".to_owned();
    options.iter().for_each(|option| script += &format!("#SBATCH {}\n", quoted(option)));
    let logs = quoted(&folder.logs().to_string_lossy());
    script += &format!("logs={logs}\n{}case \"{task}\" in\n", include_str!("task.sh"));
    for (n, members) in tasks.enumerate() {
        script += &format!("{})\n", n + 1);
        for member in members.iter().map(|m| &campaign.members[*m]) {
            script +=
                &format!("    run {} {}\n", quoted(&member.name), line(&command(campaign, folder, member)?));
        }
        script += "    ;;\n";
    }
    Ok(script + &format!("*) echo \"no task {task}\" >&2; exit 2 ;;\nesac\nexit $code\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_member_does_not_end_the_others_of_its_task_and_the_exit_code_says_it() {
        let root = tempfile::tempdir().unwrap();
        let campaign =
            Campaign::parse("name = 'x'\nscenes = ['a', 'b', 'c']\nseeds = [1]", root.path()).unwrap();
        let folder = Folder::at(&root.path().join("a folder")).unwrap();
        let script =
            script(&campaign, &folder, tasks(&[0, 1, 2], None, 2), "$TASK", &["--comment=it's".into()]);
        let script = script.unwrap();
        assert!(script.starts_with("#!/bin/sh\n#SBATCH '--comment=it'\\''s'\n"), "{script}");
        // The program of this test has no option --scene, and ends with 101.
        let sh =
            |task| std::process::Command::new("sh").args(["-c", &script]).env("TASK", task).output().unwrap();
        assert_eq!(["1", "2", "3"].map(|task| sh(task).status.code()), [101, 101, 2].map(Some));
        for member in &campaign.members {
            let log = std::fs::read_to_string(folder.logs().join(format!("{}.log", member.name))).unwrap();
            assert!(log.contains("scene"), "{log}");
        }
    }
}
