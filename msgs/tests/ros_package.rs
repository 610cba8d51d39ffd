//! `package.xml` and `CMakeLists.txt`, by which a ROS 2 workspace builds the types, agree with the message files.

use std::collections::BTreeSet;
use std::path::Path;

fn read(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn message_files() -> BTreeSet<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("msg");
    let names = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    names.map(|name| format!("msg/{name}")).collect()
}

/// Packages whose types the message files use.
fn used_packages() -> BTreeSet<String> {
    let of_file = |file: &String| -> Vec<String> {
        let text = read(file);
        let types = text.lines().filter_map(|line| line.split('#').next()?.split_whitespace().next());
        types.filter_map(|name| Some(name.split_once('/')?.0.to_owned())).collect()
    };
    message_files().iter().flat_map(of_file).collect()
}

/// The words between the parentheses of a command of `CMakeLists.txt`, for each call.
fn calls(text: &str, command: &str) -> Vec<Vec<String>> {
    let open = format!("{command}(");
    let inside = text.split(&open).skip(1).map(|call| call.split(')').next().unwrap());
    inside.map(|words| words.split_whitespace().map(|w| w.trim_matches('"').to_owned()).collect()).collect()
}

/// The contents of the elements of this name.
fn elements(xml: &str, name: &str) -> BTreeSet<String> {
    let (open, close) = (format!("<{name}>"), format!("</{name}>"));
    xml.split(&open).skip(1).map(|rest| rest.split(&close).next().unwrap().to_owned()).collect()
}

#[test]
fn the_interfaces_of_the_ros_package_are_the_message_files() {
    let cmake = read("CMakeLists.txt");
    let generated = calls(&cmake, "rosidl_generate_interfaces");
    let [words] = generated.as_slice() else { panic!("{} calls", generated.len()) };
    let (files, dependencies) =
        words[1..].split_at(words[1..].iter().position(|w| w == "DEPENDENCIES").unwrap());
    assert_eq!(files.iter().cloned().collect::<BTreeSet<_>>(), message_files());
    assert_eq!(dependencies[1..].iter().cloned().collect::<BTreeSet<_>>(), used_packages());
}

#[test]
fn the_dependencies_of_the_ros_package_are_the_packages_used_by_the_message_files() {
    let (xml, cmake, used) = (read("package.xml"), read("CMakeLists.txt"), used_packages());
    assert!(used.contains("std_msgs"), "{used:?}");
    assert_eq!(elements(&xml, "depend"), used);
    let mut needed = elements(&xml, "buildtool_depend");
    needed.extend(used);
    let found: BTreeSet<String> =
        calls(&cmake, "find_package").into_iter().map(|words| words[0].clone()).collect();
    assert_eq!(found, needed);
    assert_eq!(elements(&xml, "name"), BTreeSet::from(["grainlab_msgs".to_owned()]));
    assert_eq!(elements(&xml, "version"), BTreeSet::from([env!("CARGO_PKG_VERSION").to_owned()]));
}

#[test]
fn the_page_lists_every_topic_and_its_quality_of_service() {
    let page = read("README.md");
    for topic in grainlab_msgs::topics::TOPICS {
        let name = format!("`{}`", topic.name);
        let rows = page.lines().filter(|line| line.starts_with("| ") && line.contains(&name)).count();
        // Those of ROS 2 have the quality of service that ROS 2 gives them.
        let expected = if topic.name.starts_with('/') { 1 } else { 2 };
        assert_eq!(rows, expected, "rows of README.md with {name}");
    }
}
