//! Contacts listed in a file: once or from both grains, with forces of the stated law, another law, or the wrong sign.

use grainlab_core::Material;
use grainlab_recordings::import::{ImportError, ImportOptions, Imported, csv};

/// Twelve pairs of grains of 1 mm with overlaps of 1 to 12 µm.
const PAIRS: usize = 12;
const RADIUS: f64 = 1e-3;

fn overlap(pair: usize) -> f64 {
    1e-6 * (pair + 1) as f64
}

fn hertz(overlap: f64) -> f64 {
    Material::GLASS.normal_force(0.5 * RADIUS, overlap)
}

/// A row of the contact of a pair, as its first grain has it, or its second one.
fn row(pair: usize, from_second: bool, force: f64) -> String {
    let (i, j, side) = if from_second { (1, 0, -1.0) } else { (0, 1, 1.0) };
    let tangential = 0.01 * force * side;
    format!(
        "c,{},{},{},0,0,{:e},{force:e},0,{tangential:e},0\n",
        2 * pair + i,
        2 * pair + j,
        -side,
        2.0 * RADIUS - (2.0 * RADIUS - overlap(pair)),
    )
}

fn text(contacts: &str) -> String {
    let grain = |n: usize| {
        let x = if n.is_multiple_of(2) { 0.0 } else { 2.0 * RADIUS - overlap(n / 2) };
        format!("p,{n},{x:e},0,{:e},{RADIUS:e},1.0471975511965976e-5,0,0,0,0,0,0\n", 0.01 * (n / 2) as f64)
    };
    (0..2 * PAIRS).map(grain).collect::<String>() + contacts
}

fn read(contacts: &str, law: &str) -> Result<Imported, ImportError> {
    let about = format!(
        "{{\"G\": 29e9, \"nu\": 0.2, \"density\": 2500, \"friction\": 0.3, \"box_L\": [0.12, 0.12, 0.12]{law}}}"
    );
    csv::packing(&text(contacts), Some(&about), &ImportOptions::default())
}

fn refused(contacts: &str, law: &str) -> String {
    read(contacts, law).unwrap_err().to_string()
}

fn once(force: impl Fn(f64) -> f64) -> String {
    (0..PAIRS).map(|n| row(n, false, force(overlap(n)))).collect()
}

const LINEAR: &str = ", \"contact_law\": \"linear\", \"contact_law_parameters\": [7e6, 0.3]";
const HERTZ: &str = ", \"contact_law\": \"hertz_mindlin\"";

#[test]
fn contacts_listed_from_both_grains_are_taken_once_and_said() {
    let expected = read(&once(hertz), "").unwrap();
    assert!(expected.notes.is_empty(), "{:?}", expected.notes);
    let second: String = (0..PAIRS).map(|n| row(n, true, hertz(overlap(n)))).collect();
    let both = read(&(once(hertz) + &second), "").unwrap();
    assert_eq!(both.packing, expected.packing);
    assert_eq!(both.notes, ["12 contacts are listed from both of their grains, and were taken once"]);
    let one = read(&(once(hertz) + &row(3, true, hertz(overlap(3)))), "").unwrap();
    assert_eq!(one.packing, expected.packing);
    assert_eq!(one.notes, ["1 contact is listed from both of its grains, and was taken once"]);
}

#[test]
fn a_contact_listed_twice_is_refused_unless_its_forces_are_equal_and_opposite() {
    let unequal = refused(&(once(hertz) + &row(3, true, 1.1 * hertz(overlap(3)))), "");
    let expected = "line 37: the contact of grains 7 and 6 is listed from both grains, and the two forces are not equal and opposite, \
                    first in line 28";
    assert!(unequal.starts_with(expected), "{unequal}");
    let again = refused(&(once(hertz) + &row(3, false, hertz(overlap(3)))), "");
    assert!(again.contains("the contact of grains 6 and 7 is listed twice, first in line 28"), "{again}");
}

#[test]
fn forces_that_all_pull_are_refused_as_those_on_the_other_grain_and_a_few_that_pull_are_not() {
    let reversed = refused(&once(|overlap| -hertz(overlap)), "");
    assert!(reversed.contains("12 of 12 contacts pull although the grains overlap"), "{reversed}");
    assert!(reversed.contains("act on the second grain of each contact"), "{reversed}");
    let one = once(|d| if d < 1.5e-6 { -hertz(d) } else { hertz(d) });
    let notes = read(&one, "").unwrap().notes;
    assert!(notes.iter().any(|n| n.contains("1 contact pulls")), "{notes:?}");
}

#[test]
fn normals_that_all_point_the_wrong_way_are_named_and_a_wrong_angle_is_its_angle() {
    let reverse = |row: &str| {
        let mut words: Vec<String> = row.split(',').map(str::to_owned).collect();
        words[3] = (-words[3].parse::<f64>().unwrap()).to_string();
        words.join(",") + "\n"
    };
    let reversed = |rows: &str| rows.lines().map(reverse).collect::<String>();
    let all = refused(&reversed(&once(hertz)), "");
    let expected =
        "line 25: the normals of 12 of 12 contacts point the wrong way, the first of grains 0 and 1";
    assert!(all.starts_with(expected) && all.contains("reverse the signs of these normals"), "{all}");
    let (first, others) = (row(0, false, hertz(overlap(0))), 1..PAIRS);
    let others: String = others.map(|n| row(n, false, hertz(overlap(n)))).collect();
    let one = refused(&(reversed(&first) + &others), "");
    assert!(one.contains("the normals of 1 of 12 contacts point the wrong way"), "{one}");
    let across = first.replacen(",-1,0,0,", ",0,1,0,", 1);
    assert_ne!(across, first);
    let angle = refused(&(across + &others), "");
    assert!(angle.contains("angle of the normal (rad)") && angle.contains("positions give 1.57"), "{angle}");
}

#[test]
fn forces_that_are_all_zero_although_grains_overlap_are_named() {
    for law in ["", HERTZ] {
        let zero = refused(&once(|_| 0.0), law);
        assert!(zero.contains("no contact carries a force, although 12 pairs of grains overlap"), "{zero}");
    }
}

/// Hertz's forces grow with the square of the lengths.
#[test]
fn lengths_in_millimetres_are_named_and_the_factor_keeps_its_digits() {
    let diameter = 2.0 * 1e3 * RADIUS;
    let apart = |n: usize| diameter - 1e3 * overlap(n);
    let grains = (0..2 * PAIRS).map(|n| {
        let (x, z) = (if n.is_multiple_of(2) { 0.0 } else { apart(n / 2) }, 10.0 * (n / 2) as f64);
        format!("p,{n},{x:e},0,{z:e},{:e},1e-5,0,0,0,0,0,0\n", 0.5 * diameter)
    });
    let contacts = (0..PAIRS).map(|n| {
        let (i, j) = (2 * n, 2 * n + 1);
        format!("c,{i},{j},-1,0,0,{:e},{:e},0,0,0\n", diameter - apart(n), hertz(overlap(n)))
    });
    let about = r#"{"G": 29e9, "nu": 0.2, "density": 2500, "friction": 0.3, "box_L": [120, 120, 120]}"#;
    let text = grains.chain(contacts).collect::<String>();
    let error = csv::packing(&text, Some(about), &ImportOptions::default()).unwrap_err().to_string();
    assert!(error.contains("normal forces are 1.00e-6 times those of hertz_mindlin contacts"), "{error}");
    assert!(error.contains("if its lengths are in mm: convert"), "{error}");
}

#[test]
fn forces_of_another_law_are_refused_with_its_stiffness_unless_the_file_states_a_law() {
    let linear = once(|overlap| 7e6 * overlap);
    let error = refused(&linear, "");
    assert!(error.contains("states no contact law") && error.contains("linear:7.0000e6,RATIO"), "{error}");
    let packing = read(&linear, LINEAR).unwrap().packing;
    assert_eq!(packing.law.name(), "linear");
    // A law that is stated is the user's own word.
    let notes = read(&linear, HERTZ).unwrap().notes;
    assert!(notes.iter().any(|n| n.contains("of another contact law")), "{notes:?}");
    let far = refused(&once(|overlap| 20.0 * hertz(overlap)), "");
    assert!(
        far.contains("20.000 times those of hertz_mindlin contacts") && !far.contains("linear:"),
        "{far}"
    );
    // Forces of a packing in motion, or of a material that is known to some per cent.
    assert!(read(&once(|overlap| 3.0 * hertz(overlap)), "").is_ok());
}

/// At small overlaps the force of linear springs, and of a dashpot, exceeds Hertz's by any factor.
#[test]
fn one_contact_with_a_tiny_overlap_does_not_refuse_the_packing() {
    let tiny = once(|d| if d < 1.5e-6 { 3.0 * hertz(overlap(PAIRS - 1)) } else { hertz(d) });
    assert!(3.0 * hertz(overlap(PAIRS - 1)) > 100.0 * hertz(overlap(0)));
    assert!(read(&tiny, HERTZ).is_ok());
    let error = refused(&once(|d| if d < 1.5e-6 { 1e5 * hertz(d) } else { hertz(d) }), HERTZ);
    assert!(error.contains("times that of hertz_mindlin contacts at its overlap"), "{error}");
}

/// The two rows of a contact of a grain with its own image have the same ids, and name opposite images.
#[test]
fn a_contact_of_a_grain_with_its_own_image_that_is_listed_from_both_sides_is_taken_once() {
    let (edge, force) = (2.0 * RADIUS - overlap(0), hertz(overlap(0)));
    let depth = 2.0 * RADIUS - edge;
    let side = |sign: f64, tangential: f64| {
        format!("c,0,0,{sign},0,0,{depth:e},{force:e},0,{:e},0\n", tangential * force)
    };
    let one = |contacts: &str| {
        let about = format!(
            "{{\"G\": 29e9, \"nu\": 0.2, \"density\": 2500, \"friction\": 0.3, \"box_L\": [{edge:e}, 0.12, 0.12]}}"
        );
        let grain = format!("p,0,0,0,0,{RADIUS:e},1.0471975511965976e-5,0,0,0,0,0,0\n");
        csv::packing(&(grain + contacts), Some(&about), &ImportOptions::default())
    };
    let expected = one(&side(-1.0, 0.01)).unwrap();
    let both = one(&(side(-1.0, 0.01) + &side(1.0, -0.01))).unwrap();
    assert_eq!(both.packing, expected.packing);
    assert_eq!(both.notes, ["1 contact is listed from both of its grains, and was taken once"]);
    let unequal = one(&(side(-1.0, 0.01) + &side(1.0, 0.01))).unwrap_err().to_string();
    assert!(unequal.contains("from both grains, and the two forces are not equal and opposite"), "{unequal}");
}
