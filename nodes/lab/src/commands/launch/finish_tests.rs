use super::*;

#[test]
fn a_summary_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    write_whole(&path, "{}\n").unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "{}\n");
    // A folder in its place cannot be replaced, and nothing is left beside it.
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert!(write_whole(&path, "{}").unwrap_err().to_string().contains("summary.json"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn only_the_directory_of_a_run_that_left_nothing_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    for (file, content, kept) in
        [("logs/servo.log", "", false), ("logs/servo.log", "why", true), ("a_0.mcap", "", true)]
    {
        let run = folder.path().join("run");
        std::fs::create_dir_all(run.join("logs")).unwrap();
        std::fs::write(run.join("scene.toml"), "name = 'x'").unwrap();
        std::fs::write(run.join(file), content).unwrap();
        remove_if_unused(&run);
        assert_eq!(run.exists(), kept, "{file} {content:?}");
        let _ = std::fs::remove_dir_all(&run);
    }
}
