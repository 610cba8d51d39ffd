//! `grainlab calibrate`: from measured packings to a file that `grainlab invert` takes.

use crate::grainlab;

const ENSEMBLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/ensembles");
const BUILTIN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kernels/emt/src/calibration/grainlab.toml");

fn ensemble(name: &str) -> String {
    format!("{ENSEMBLES}/{name}.csv")
}

/// Words and numbers of a text, separately.
fn words_and_numbers(text: &str) -> (Vec<String>, Vec<f64>) {
    let tokens = text.split(|c: char| c.is_whitespace() || "[],=".contains(c)).filter(|t| !t.is_empty());
    let (numbers, words): (Vec<&str>, Vec<&str>) = tokens.partition(|t| t.parse::<f64>().is_ok());
    (words.into_iter().map(str::to_owned).collect(), numbers.iter().map(|n| n.parse().unwrap()).collect())
}

#[test]
fn the_built_in_calibration_is_learned_from_its_packings() {
    let (isotropic, anisotropic) = (ensemble("isotropic"), ensemble("anisotropic"));
    let files = ["--isotropic", &isotropic, "--anisotropic", &anisotropic];
    let [wide, recipes] = ["wide", "recipes"].map(ensemble);
    let others = ["--other", &wide, "--other", &recipes];
    let learned =
        grainlab(&[&["calibrate"], &files[..], &others, &["--name", "grainlab", "--out", "-"]].concat())
            .assert_code(0);
    let (words, numbers) = words_and_numbers(&learned.stdout);
    let (known_words, known) = words_and_numbers(&std::fs::read_to_string(BUILTIN).unwrap());
    assert_eq!(words, known_words);
    assert_eq!(numbers.len(), known.len());
    let largest = known.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    assert!(largest > 1e9, "the modulus of the grains is there");
    for (i, (found, expected)) in numbers.iter().zip(&known).enumerate() {
        // Rounding differs between processors, and the minimum of a fit is flat.
        assert!((found - expected).abs() <= 1e-4 * expected.abs() + 1e-9, "number {i}: {found} {expected}");
    }
}

#[test]
fn a_calibration_written_is_one_to_invert_with() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml").to_string_lossy().into_owned();
    grainlab(&["calibrate", "--isotropic", &ensemble("isotropic"), "--out", &path]).assert_code(0);
    let state = ["--g12=1.2e8", "--g13=1.25e8", "--theta=1.44e8", "--pressure=5e4", "--format=json"];
    let inverted = grainlab(&[&["invert", "--model=ratio", "--calibration", &path][..], &state].concat());
    let answer: serde_json::Value = inverted.json();
    assert_eq!(answer["results"][0]["calibration"], "mine", "the name of the file");
    let own = grainlab(&[&["invert", "--model=ratio", "--calibration=grainlab"][..], &state].concat());
    let own: serde_json::Value = own.json();
    let k = |a: &serde_json::Value| a["results"][0]["k"].as_f64().unwrap();
    assert!((k(&answer) - k(&own)).abs() < 1e-6, "the same isotropic packings, the same constants");
}

#[test]
fn packings_that_determine_no_constants_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read_to_string(ensemble("isotropic")).unwrap();
    let head = |lines: usize| whole.lines().take(lines).collect::<Vec<_>>().join("\n");
    let third = whole.lines().nth(2).unwrap();
    let (_, after_phi) = third.split_once(",0.64").unwrap();
    let torn =
        head(2) + "\n" + &third.replace(&format!(",0.64{}", after_phi.split(',').next().unwrap()), ",");
    for (name, table, code, words) in [
        ("few", head(3), 4, &["no calibration", "isotropic packings"][..]),
        ("torn", torn, 2, &["line 3: phi is not known", "1 rows are not valid packings"]),
        ("empty", head(1), 2, &["no packing below the header"]),
        ("narrow", whole.replace(",phi,", ",_phi,"), 2, &["the header: no column phi"]),
        ("foreign", whole.replace("mu2", "friction"), 2, &["no column mu2 to group by"]),
    ] {
        let path = folder.path().join(name).to_string_lossy().into_owned();
        std::fs::write(&path, table).unwrap();
        grainlab(&["calibrate", "--isotropic", &path]).assert_code(code).assert_says(words);
    }
}

#[test]
fn tables_of_a_campaign_are_taken_as_they_are_and_exchanged_ones_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [isotropic, anisotropic] = ["isotropic", "anisotropic"].map(|name| {
        let path = folder.path().join(name).to_string_lossy().into_owned();
        let text = std::fs::read_to_string(ensemble(name)).unwrap();
        let gathered = text.lines().enumerate().map(|(line, row)| {
            let [scene, friction, seed, _] = &row.splitn(4, ',').collect::<Vec<_>>()[..] else {
                panic!("{row}")
            };
            let member = format!("{scene}-friction={friction}-{seed}");
            let row = row.replace("preparation,mu2", "scene,set.friction");
            if line == 0 { format!("member,{row}\n") } else { format!("{member},{row}\n") }
        });
        std::fs::write(&path, gathered.collect::<String>()).unwrap();
        path
    });
    for (files, code, words) in [
        (
            [&isotropic, &anisotropic],
            0,
            &["; alpha = ", "24 packings (144 states)", "96 packings (384 states)"][..],
        ),
        ([&anisotropic, &isotropic], 2, &["it is not isotropic", "anisotropic, line "]),
    ] {
        let ended = grainlab(&["calibrate", "--isotropic", files[0], "--anisotropic", files[1]]);
        ended.assert_code(code).assert_says(words);
    }
}
