//! The message files read by independent libraries.

use std::path::Path;
use system_tests::python;

#[test]
fn message_files_parse_and_hash_alike_in_independent_libraries() {
    let Some(python) = python::with("mcap_ros2, rosbags") else { return };
    let msgs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../msgs");
    let (ours, standard) = (msgs.join("msg"), msgs.join("std"));
    let arguments = [ours.to_str().unwrap(), "--package", "grainlab_msgs", standard.to_str().unwrap()];
    let check = python::tool(&python, "check_msgs.py", &arguments);
    let out = String::from_utf8_lossy(&check.stdout);
    assert!(check.status.success(), "{out}\n{}", String::from_utf8_lossy(&check.stderr));
    let mut checked = 0;
    for line in out.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (name, hash) = (words[0], words[words.len() - 1]);
        let info =
            grainlab_msgs::TypeInfo::by_name(name).unwrap_or_else(|| panic!("{name} is not generated"));
        assert_eq!(info.hash, hash, "{name}");
        checked += 1;
    }
    assert!(checked >= 12, "{checked} types checked:\n{out}");
}
