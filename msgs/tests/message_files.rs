//! Message files that the build refuses.

#[allow(dead_code, reason = "the build script itself")]
#[path = "../generator/main.rs"]
mod generator;

#[test]
fn a_fault_of_a_message_file_names_file_line_and_problem() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["msg", "std", "interfaces"] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
    }
    std::fs::write(folder.path().join("msg/Outer.msg"), "Broken[] inner\n").unwrap();
    for (declaration, problem) in [
        // Types that other tools read differently: bounded arrays, wide strings, characters.
        ("float64[<=3] x", "array length"),
        ("float64[0] x", "array length"),
        ("wstring x", "unknown type wstring"),
        ("char x", "unknown type char"),
        ("string X=\"a\"", "literal"),
        ("uint8 X=256", "literal"),
        ("float64 x nan", "literal"),
        ("float64[2] x 1", "only a single primitive"),
        ("float64 Force", "lower_snake_case"),
        ("uint8 Limit=1", "UPPER_SNAKE_CASE"),
        ("bool first", "the name first exists already"),
        ("float64", "expected a type and a name"),
        ("Missing x", "no message file defines grainlab_msgs/Missing"),
        ("Broken x", "contains Broken"),
        ("Outer x", "grainlab_msgs/Outer contains Broken"),
    ] {
        let text = format!("# A comment.\nbool first\n{declaration}\n");
        std::fs::write(folder.path().join("msg/Broken.msg"), text).unwrap();
        let fault = generator::generate(folder.path()).unwrap_err();
        assert!(fault.starts_with("msg/Broken.msg:3: ") && fault.contains(problem), "{declaration}: {fault}");
    }
    std::fs::write(folder.path().join("msg/Broken.msg"), "# nothing else\n").unwrap();
    let fault = generator::generate(folder.path()).unwrap_err();
    assert_eq!(fault, "msg/Broken.msg:1: a message needs at least one field");
}
