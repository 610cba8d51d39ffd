use super::*;

#[test]
fn a_summary_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    write_whole(&path, "{}\n").unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "{}\n");
    // A folder in its place cannot be replaced, and no temporary file remains.
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert!(write_whole(&path, "{}").unwrap_err().to_string().contains("summary.json"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
