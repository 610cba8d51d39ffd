use super::*;

fn parse(text: &str) -> Result<Campaign, String> {
    Campaign::parse(text, Path::new("/nowhere")).map_err(|e| e.to_string())
}

fn names(campaign: &Campaign) -> Vec<&str> {
    campaign.members.iter().map(|m| m.name.as_str()).collect()
}

#[test]
fn scenes_values_and_seeds_are_combined_in_this_order() {
    let campaign = parse(
        "name = 'x'\nscenes = ['s1', 's2']\nseeds = { first = 3, count = 2 }\nset = { grains.count = 500 }\n\
         vary = { friction = [0.05, 0.1] }",
    )
    .unwrap();
    assert_eq!(
        names(&campaign),
        [
            "s1-friction=0.05-3",
            "s1-friction=0.05-4",
            "s1-friction=0.1-3",
            "s1-friction=0.1-4",
            "s2-friction=0.05-3",
            "s2-friction=0.05-4",
            "s2-friction=0.1-3",
            "s2-friction=0.1-4"
        ]
    );
    assert_eq!(campaign.members[0].sets(), ["grains.count=500", "friction=0.05"]);
    assert_eq!((campaign.launch.as_str(), campaign.members[7].seed), ("demo", 4));
}

#[test]
fn groups_have_scenes_seeds_and_values_of_their_own() {
    let campaign = parse(
        "name = 'x'\nscenes = ['s1']\nseeds = [1]\nset = { grains.count = 500 }\n\
         [[group]]\nscenes = ['s2']\nseeds = [7, 8]\nset = { friction = 0.2 }\n[[group]]\nscenes = ['s3']\nseeds = [1]",
    )
    .unwrap();
    assert_eq!(names(&campaign), ["s1-1", "s2-friction=0.2-7", "s2-friction=0.2-8", "s3-1"]);
    assert_eq!(campaign.members[1].sets(), ["grains.count=500", "friction=0.2"]);
}

#[test]
fn single_runs_and_tables_add_members() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("runs.csv"), "seed,scene,friction\n1,s3,0.2\n2,mine.toml,\n").unwrap();
    std::fs::write(folder.path().join("mine.toml"), "base = 's1'").unwrap();
    let text = "name = 'x'\ntable = 'runs.csv'\nset = { name = 'n' }\n[[group]]\nscenes = ['s1']\nseeds = [7]\nset = { phase.rest.drag = 1e3 }";
    let campaign = Campaign::parse(text, folder.path()).unwrap();
    assert_eq!(names(&campaign), ["s1-phase.rest.drag=1000-7", "s3-friction=0.2-1", "mine-2"]);
    assert_eq!(campaign.members[2].sets(), ["name=n"]);
    assert_eq!(campaign.members[2].scene, folder.path().join("mine.toml").to_string_lossy());
    std::fs::write(folder.path().join("runs.csv"), "seed,scene,friction,friction\n1,s3,0.2,0.3\n").unwrap();
    let error = Campaign::parse(text, folder.path()).unwrap_err().to_string();
    assert!(error.contains("runs.csv: the column friction occurs twice"), "{error}");
}

#[test]
fn tables_are_read_with_commas_semicolons_and_tabs_and_with_comments() {
    let folder = tempfile::tempdir().unwrap();
    let read = |table: &str| {
        std::fs::write(folder.path().join("runs.csv"), table).unwrap();
        Campaign::parse("name = 'x'\ntable = 'runs.csv'", folder.path()).map_err(|e| e.to_string())
    };
    let expected = read("scene,seed,friction\ns1,1,0.2\n").unwrap();
    assert_eq!(names(&expected), ["s1-friction=0.2-1"]);
    for other in [
        "scene;seed;friction\ns1;1;0,2\n",
        "scene\tseed\tfriction\ns1\t1\t0.2\n",
        "\u{feff}# Sand\nscene, seed, friction\ns1, 1, 0.2\n",
    ] {
        assert_eq!(read(other).unwrap().members, expected.members, "{other}");
    }
    let error = read("# Sand\nscene,seed\ns1,one\n").unwrap_err();
    assert!(error.contains("line 3: seed \"one\" is not a number"), "{error}");
    let error = read("scene|seed\ns1|1\n").unwrap_err();
    assert!(error.contains("it has no column scene; its columns are: scene|seed"), "{error}");
}

#[test]
fn keys_of_one_table_vary_in_step_and_are_combined_with_the_others() {
    let campaign = parse(
        "name = 'x'\nscenes = ['s1']\nseeds = [1]\nvary = { friction = [0.1, 0.2] }\n\
         [[together]]\npressure = [50e3, 1e5]\n'phase.*.drag' = [1, 2]\n[[group]]\nscenes = ['s2']\nseeds = [1]\n\
         [[group.together]]\nphase.'*'.drag = [3]\nphase.'a.b'.drag = [4]",
    )
    .unwrap();
    let rows = ["drag=1-pressure=50000", "drag=2-pressure=100000"];
    let each = ["0.1", "0.2"].map(|mu| rows.map(|row| format!("s1-friction={mu}-{row}-1"))).concat();
    assert_eq!(names(&campaign)[..4], each);
    assert_eq!(names(&campaign)[4], "s2-drag=3-phase._a.b_.drag=4-1");
    assert_eq!(campaign.members[0].sets(), ["friction=0.1", "phase.*.drag=1", "pressure=50000.0"]);
    assert_eq!(campaign.members[4].sets(), ["phase.*.drag=3", "phase.\"a.b\".drag=4"]);
}

#[test]
fn faults_are_named() {
    for (text, named) in [
        ("name = 'x'", "no members"),
        ("name = 'x y'\nscenes = ['s1']\nseeds = [1]", "letters, digits"),
        ("name = 'x'\nscenes = ['s1']", "both are needed"),
        ("name = 'x'\nscenes = ['s1']\nseeds = [-1]", "whole numbers"),
        ("name = 'x'\nscenes = ['s1']\nseeds = [1]\nset = { seed = 2 }", "seed is no key to set"),
        ("name = 'x'\nscenes = ['s1']\nseeds = [1, 1]", "two members are called s1-1"),
        ("name = 'x'\nscenes = ['s1']\nseeds = [1]\nvary = { friction = 0.1 }", "vary.friction is 0.1"),
        ("name = 'x'\nscenes = ['s1']\nseed = [1]", "seed: unknown key; known here: name, description"),
        ("name = 'x'\nscenes = 's1'", "scenes is \"s1\": it must be a list of texts"),
        ("name = 'x'\nscenes = ['s1']\nseeds = { first = 1, count = 2, step = 2 }", "seeds is {"),
        (
            "name = 'x'\n[[group]]\nseeds = [1]\nscene = ['s1']",
            "group[0].scene: unknown key; known here: scenes,",
        ),
        ("name = 'x'\n[[group]]\nset = { friction = 1 }", "group[0].scenes and seeds: both are needed"),
        (
            "name = 'x'\nscenes = ['s1']\nseeds = [1]\n[[together]]\npressure = [1, 2]\nfriction = [1]",
            "together[0].pressure has 2 values, and another key of its table 1:",
        ),
        (
            "name = 'x'\n[[group]]\nscenes = ['s1']\nseeds = [1]\nvary = { friction = [1] }\n[[group.together]]\nfriction = [2]",
            "group[0].together[0].friction is in group[0].vary, too",
        ),
        ("name = 'x'\nscenes = ['s1']\nseeds = [1]\nvary = { friction = [] }", "vary.friction is []"),
        ("name = 'x'\ntable = 'lost.csv'", "lost.csv"),
        ("name = 'x'\ntable = 'runs.csv'\nvary = { friction = [0.1, 0.2] }", "vary.friction has no effect"),
        ("name = 'x'\nscenes = ['s1']\nseeds = { first = 1, count = 200000 }", "more than 100000"),
    ] {
        let error = parse(text).unwrap_err();
        assert!(error.contains(named), "{text}: {error}");
    }
}
