//! Contact forces dumped by LAMMPS, for a packing from LAMMPS (`tests/golden/lammps/make.in`).

use crate::support::{assert_says, golden};
use grainlab_core::stress::stress;
use grainlab_core::{Material, Packing, Vec3};
use grainlab_recordings::import::{self, Frames, ImportError, ImportOptions, lammps_dump, load};

/// With these contact forces and columns.
fn options(forces: String, columns: &[&str]) -> ImportOptions {
    ImportOptions {
        contact_forces: Some(forces),
        contact_columns: columns.iter().map(|c| (*c).to_owned()).collect(),
        ..ImportOptions::of_grains(&Material::GLASS, 0.3)
    }
}

fn forces() -> String {
    import::text(&golden("lammps/forces.dump.gz")).unwrap()
}

fn packing(options: &ImportOptions) -> Result<Packing, ImportError> {
    let imported = load(&golden("lammps/grains.dump.gz"), options)?.packings.remove(0);
    assert!(imported.notes.is_empty(), "{:?}", imported.notes);
    Ok(imported.packing)
}

fn problem(options: &ImportOptions) -> String {
    load(&golden("lammps/grains.dump.gz"), options).unwrap_err().to_string()
}

#[test]
fn normal_and_tangential_forces_of_lammps_give_its_stress_and_balance_every_grain() {
    let p = packing(&options(forces(), &[])).unwrap();
    assert_eq!((p.grains(), p.contacts.len()), (400, 847));
    let known = std::fs::read_to_string(golden("lammps/stress.txt")).unwrap();
    let known: Vec<f64> = known.split_whitespace().map(|v| v.parse().unwrap()).collect();
    let s = stress(&p).tensor.voigt();
    // LAMMPS's order is xx yy zz xy xz yz.
    for (found, k) in s.into_iter().zip([0, 1, 2, 5, 4, 3]) {
        assert!((found - known[k]).abs() < 1e-6 * known[0], "{found} {}", known[k]);
    }
    let (mut net, mut mean) = (vec![Vec3::zeros(); p.grains()], 0.0);
    for c in &p.contacts {
        let on_j = c.normal * c.normal_force - c.tangential_force;
        net[c.j as usize] += on_j;
        net[c.i as usize] -= on_j;
        mean += on_j.norm() / p.contacts.len() as f64;
    }
    let worst = net.iter().map(Vec3::norm).fold(0.0, f64::max);
    assert!(worst < 1e-9 * mean, "{worst:e} of {mean:e}");
    let limit = p.contacts.iter().map(|c| c.tangential_force.norm() / c.normal_force).fold(0.0, f64::max);
    assert!((0.25..0.3001).contains(&limit), "{limit}");
}

#[test]
fn forces_in_other_units_than_si_are_refused() {
    let with = |units: &str| options(format!("ITEM: UNITS\n{units}\n{}", forces()), &[]);
    assert!(packing(&with("si")).is_ok());
    let fault = problem(&with("cgs"));
    assert!(fault.contains("line 2: units cgs is not supported"), "{fault}");
}

#[test]
fn columns_are_found_by_the_names_given_too() {
    let expected = packing(&options(forces(), &[])).unwrap();
    let default = "c_pl[1] c_pl[2] c_pf[1] c_pf[2] c_pf[3] c_pf[4] c_pf[5] c_pf[6] c_pf[7]";
    let named = forces().replace(default, "patom1 patom2 dist fx fy fz p1 p2 p3");
    assert_ne!(named, forces());
    assert_eq!(packing(&options(named, &[])).unwrap(), expected);
    let other = forces().replace(default, "a b d n1 n2 n3 t1 t2 t3");
    let columns = ["a", "b", "n1", "n2", "n3", "t1", "t2", "t3"];
    assert_eq!(packing(&options(other.clone(), &columns)).unwrap(), expected);
    let wrong = problem(&options(other.clone(), &["a", "b", "n1", "n2", "n3", "t1", "t2", "u"]));
    assert!(wrong.contains("no column u") && wrong.contains("t3"), "{wrong}");
    assert!(problem(&options(other, &columns[..4])).contains("five or eight"), "four columns");
}

const HEADER: &str = "c_pl[1] c_pl[2] c_pf[1] c_pf[2] c_pf[3] c_pf[4] c_pf[5] c_pf[6] c_pf[7]";

#[test]
fn columns_that_are_not_a_normal_and_a_tangential_force_are_refused_with_those_that_fit() {
    // compute pair/local dist fx fy fz force p1 p2 p3: force takes the place of p1.
    let wide = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        match words.len() {
            9.. if line.starts_with(|c: char| c.is_ascii_digit()) => {
                format!("{} 0.001 {}", words[..6].join(" "), words[6..].join(" "))
            }
            _ => line.replace(HEADER, &format!("{HEADER} c_pf[8]")),
        }
    };
    let with_force: Vec<String> = forces().lines().map(|line| wide(line.trim_end())).collect();
    let error = problem(&options(with_force.join("\n"), &[]));
    let expected = "--contact-columns 'c_pl[1],c_pl[2],c_pf[2],c_pf[3],c_pf[4],c_pf[6],c_pf[7],c_pf[8]'";
    assert!(error.contains("the tangential force is not across it (c_pf[5] c_pf[6] c_pf[7])"), "{error}");
    assert!(error.contains(expected), "{error}");
    // One column to the side, and ids that are not those of the grains.
    for (columns, expected) in [
        (
            ["c_pl[1]", "c_pl[2]", "c_pf[1]", "c_pf[2]", "c_pf[3]", "c_pf[5]", "c_pf[6]", "c_pf[7]"],
            "c_pf[5],c_pf[6],c_pf[7]'",
        ),
        (
            ["c_pl[1]", "c_pl[2]", "c_pf[5]", "c_pf[6]", "c_pf[7]", "c_pf[2]", "c_pf[3]", "c_pf[4]"],
            "c_pf[5],c_pf[6],c_pf[7]'",
        ),
    ] {
        let error = problem(&options(forces(), &columns));
        assert!(error.contains("the normal force is not along") && error.contains(expected), "{error}");
    }
    let exchanged: Vec<String> = forces().lines().map(|l| l.replacen("55 155 ", "55 156 ", 1)).collect();
    assert!(problem(&options(exchanged.join("\n"), &[])).contains("in 1 of 847 contacts"));
}

#[test]
fn columns_in_another_number_or_twice_or_of_forces_that_pull_are_refused() {
    // compute pair/local fx fy fz p1 p2 p3.
    let renumbered = HEADER.replace(" c_pf[7]", "");
    let without_dist: Vec<String> = forces()
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>().as_slice() {
            [a, b, _, rest @ ..] if rest.len() >= 6 && !line.starts_with("ITEM") => {
                format!("{a} {b} {}", rest.join(" "))
            }
            _ => line.replace(HEADER, &renumbered),
        })
        .collect();
    assert!(problem(&options(without_dist.join("\n"), &[])).contains("6 columns c_pf[...]"));
    let twice = ["c_pl[1]", "c_pl[2]", "c_pf[2]", "c_pf[3]", "c_pf[4]"];
    let header = HEADER.replace("c_pf[5]", "c_pf[4]");
    assert!(problem(&options(forces().replace(HEADER, &header), &twice)).contains("c_pf[4] occurs twice"));
    let exchanged = ["c_pl[2]", "c_pl[1]", "c_pf[2]", "c_pf[3]", "c_pf[4]"];
    assert!(problem(&options(forces(), &exchanged)).contains("does not press the grains apart"));
    let pair = forces().lines().nth(9).unwrap().to_owned();
    let again = forces().replacen(&pair, &format!("{pair}\n{pair}"), 1);
    let count = forces().lines().nth(3).unwrap().trim().parse::<usize>().unwrap();
    let again = again.replacen(&format!("\n{count}\n"), &format!("\n{}\n", count + 1), 1);
    assert!(problem(&options(again, &[])).contains("is listed twice, first in line 10"));
}

#[test]
fn forces_on_the_second_grain_are_refused_by_their_sign_and_contacts_of_both_grains_are_taken_once() {
    let exchanged = ["c_pl[2]", "c_pl[1]", "c_pf[2]", "c_pf[3]", "c_pf[4]", "c_pf[5]", "c_pf[6]", "c_pf[7]"];
    let error = problem(&options(forces(), &exchanged));
    assert!(error.contains("847 of 847 contacts pull") && error.contains("--contact-columns"), "{error}");
    let whole = problem(&options(forces(), &exchanged[..5]));
    assert!(whole.contains("they act on the second grain of each contact"), "{whole}");
    let reversed = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let minus = words[3..].iter().map(|w| (-w.parse::<f64>().unwrap()).to_string());
        format!("{} {} {} {}", words[1], words[0], words[2], minus.collect::<Vec<_>>().join(" "))
    };
    // The dump also lists pairs that do not touch.
    let text = forces().replacen("\n1724\n", "\n3448\n", 1);
    let rows = text.lines().skip(9).filter(|line| !line.trim().is_empty()).map(reversed);
    let both = format!("{}\n{}\n", text.trim_end(), rows.collect::<Vec<_>>().join("\n"));
    let imported = load(&golden("lammps/grains.dump.gz"), &options(both, &[])).unwrap().packings.remove(0);
    assert_eq!(imported.packing, packing(&options(forces(), &[])).unwrap());
    assert!(imported.notes[0].starts_with("847 contacts are listed from both"), "{:?}", imported.notes);
}

/// These are all forces of a granular pair style from `compute pair/local dist fx fy fz`.
#[test]
fn normal_forces_alone_are_refused_where_friction_acts_and_the_columns_are_named() {
    let central = ["c_pl[1]", "c_pl[2]", "c_pf[2]", "c_pf[3]", "c_pf[4]"];
    let with = options(forces(), &central);
    let error = problem(&with);
    assert!(error.contains("p1 p2 p3") && error.contains("compute pf all pair/local"), "{error}");
    let smooth = ImportOptions { friction: Some(0.0), ..with };
    let notes = load(&golden("lammps/grains.dump.gz"), &smooth).unwrap().packings.remove(0).notes;
    assert!(
        notes.len() == 1 && notes[0].contains("more tangential force than a friction of 0 allows"),
        "{notes:?}"
    );
}

#[test]
fn forces_are_those_of_the_step_of_the_grains_and_of_another_step_or_cut_they_are_refused() {
    let later = forces().replacen("TIMESTEP\n1", "TIMESTEP\n9", 1);
    assert!(problem(&options(later.clone(), &[])).contains("same step"), "another step");
    let three = [later.as_str(), &forces(), &later.replacen("TIMESTEP\n9", "TIMESTEP\n17", 1)].concat();
    assert_eq!(packing(&options(three, &[])).unwrap(), packing(&options(forces(), &[])).unwrap());
    let error = problem(&options(format!("{later}{later}"), &[]));
    let text = forces();
    assert!(error.contains("of step 9") && error.contains("same step"), "{error}");
    assert!(problem(&options(format!("{text}{text}"), &[])).contains("a second frame"), "twice");
    let cut = text.trim_end().rfind('\n').unwrap();
    assert!(problem(&options(text[..cut].to_owned(), &[])).contains("truncated"), "a line less");
}

/// The dump of the grains with positions of `digits` significant digits.
fn grains_with_digits(digits: usize) -> String {
    let text = import::text(&golden("lammps/grains.dump.gz")).unwrap();
    let place = |name: &str| {
        let head = text.lines().find_map(|line| line.strip_prefix("ITEM: ATOMS ")).unwrap();
        head.split_whitespace().position(|column| column == name).unwrap()
    };
    let columns = ["x", "y", "z"].map(place);
    let row = |line: &str| {
        let words = line.split_whitespace().enumerate().map(|(k, word)| match columns.contains(&k) {
            true => format!("{:.*e}", digits - 1, word.parse::<f64>().unwrap()),
            false => word.to_owned(),
        });
        words.collect::<Vec<_>>().join(" ")
    };
    let mut is_row = false;
    let mut rows = String::new();
    for line in text.lines() {
        rows += &if is_row { row(line) } else { line.to_owned() };
        rows += "\n";
        is_row |= line.starts_with("ITEM: ATOMS");
    }
    rows
}

#[test]
fn forces_beside_positions_of_six_digits_are_refused_by_the_digits_and_with_nine_they_are_read() {
    let options = options(forces(), &[]);
    let error = lammps_dump::packings(&grains_with_digits(6), &options).unwrap_err().to_string();
    let apart = "contacts carry a force although their grains do not overlap";
    assert_says(&error, &[apart, "positions have 6 digits", "%.17g"]);
    let read = lammps_dump::packings(&grains_with_digits(9), &options).unwrap().remove(0);
    let expected = packing(&options).unwrap();
    assert!(read.packing.contacts.len() + 2 >= expected.contacts.len(), "{}", read.packing.contacts.len());
    let off = stress(&read.packing).tensor.mean() / stress(&expected).tensor.mean() - 1.0;
    assert!(off.abs() < 1e-4, "{off:e}");
    // Grains of another state are no matter of digits.
    let smaller = grains_with_digits(17).replace(" radius", " diameter");
    let error = lammps_dump::packings(&smaller, &options).unwrap_err().to_string();
    assert_says(&error, &["847 of 847 contacts carry a force", "not of the same state"]);
}

#[test]
fn a_dump_whose_forces_are_all_zero_is_refused_where_grains_overlap() {
    let zero = |line: &str| match line.split_whitespace().collect::<Vec<_>>()[..] {
        [a, b, distance, ref rest @ ..] if rest.len() == 6 && !line.starts_with("ITEM") => {
            format!("{a} {b} {distance} 0 0 0 0 0 0")
        }
        _ => line.to_owned(),
    };
    let text: Vec<String> = forces().lines().map(zero).collect();
    let error = problem(&options(text.join("\n"), &[]));
    assert!(error.contains("no contact carries a force, although 847 pairs of grains overlap"), "{error}");
    // A gas whose grains overlap by the rounding of their positions alone.
    let bounds = "ITEM: BOX BOUNDS pp pp pp\n0 2e-3\n0 2e-3\n0 2e-3\n";
    let gas = format!(
        "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n2\n{bounds}ITEM: ATOMS id x y z radius\n1 0.00100000 0.001 0.001 0.0001\n\
         2 0.00119999 0.001 0.001 0.0001\n"
    );
    let none = format!(
        "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ENTRIES\n1\n{bounds}ITEM: ENTRIES {HEADER}\n1 2 2e-4 0 0 0 0 0 0\n"
    );
    let read = lammps_dump::packings(&gas, &options(none, &[])).unwrap().remove(0);
    assert!(read.packing.contacts.is_empty());
}

/// The dump of a settling packing has many frames, and the forces are of one.
#[test]
fn forces_are_needed_at_the_step_that_is_read_alone() {
    let grains = import::text(&golden("lammps/grains.dump.gz")).unwrap();
    let (step, forces) = (grains.lines().nth(1).unwrap(), forces());
    let other = grains.replacen(step, "0", 1);
    let read = |text: &str, frames: Frames| {
        let found =
            import::lammps_dump::packings(text, &ImportOptions { frames, ..options(forces.clone(), &[]) });
        found.map(|all| all.into_iter().map(|one| one.packing).collect::<Vec<_>>())
    };
    let expected = read(&grains, Frames::All).unwrap();
    let own = Frames::Step(step.trim().parse().unwrap());
    for two in [format!("{other}{grains}"), format!("{grains}{other}")] {
        assert_eq!(read(&two, own).unwrap(), expected);
        assert!(read(&two, Frames::All).unwrap_err().to_string().contains("the grains of step 0"));
    }
    assert_eq!(read(&format!("{other}{grains}"), Frames::Last).unwrap(), expected);
    assert_eq!(read(&grains, Frames::Step(7)).unwrap(), []);
}
