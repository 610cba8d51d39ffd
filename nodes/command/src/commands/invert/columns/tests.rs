//! Results of rows and headers.

use super::*;
use grainlab_emt::Conditions;

fn columns(header: &str) -> Columns {
    Columns::of_header(header.as_bytes(), &[], State::default()).unwrap()
}

fn state(header: &str, row: &str) -> Result<State, String> {
    columns(header).row(row.as_bytes()).unwrap().map(|r| r.state).map_err(|bad| bad.fault)
}

fn matrix_names() -> Vec<String> {
    (0..36).map(|n| format!("c{}{}_pa", n / 6 + 1, n % 6 + 1)).collect()
}

#[test]
fn the_probe_is_that_of_its_column_or_of_the_flag_and_our_own_tables_stick() {
    let probe = |header: &str, row: &str| state(header, row).unwrap().probe;
    assert_eq!(probe("p_pa,g12_pa", "5e4,300"), None);
    assert_eq!(probe("p_pa,g12_pa,probe", "5e4,300,sticking"), Some(Probe::Sticking));
    assert_eq!(probe("p_pa,g12_pa,probe", "5e4,300,"), None);
    assert_eq!(probe("p_pa,ti_c11_pa", "5e4,300"), None);
    assert_eq!(probe("p_pa,ti_c11_pa,eps_stiffness", "5e4,300,0"), Some(Probe::Sticking));
    assert_eq!(probe("p_pa,ti_c11_pa,eps_stiffness,method", "5e4,300,0,probe"), None);
    assert_eq!(probe("p_pa,ti_c11_pa,eps_stiffness,probe", "5e4,300,0,unknown"), Some(Probe::Unknown));
    assert!(state("p_pa,g12_pa,probe", "5e4,300,slid").unwrap_err().starts_with("column probe: no probe"));
    let flag = State { probe: Some(Probe::Unknown), ..State::default() };
    let columns = |header: &str| Columns::of_header(header.as_bytes(), &[], flag.clone());
    assert!(columns("p_pa,g12_pa,probe").err().unwrap().contains("--probe contradicts the column probe"));
    let row = columns("p_pa,ti_c11_pa,eps_stiffness").unwrap().row(b"5e4,300,0").unwrap().unwrap();
    assert_eq!(row.state.probe, Some(Probe::Unknown));
}

#[test]
fn three_constants_are_moduli_and_a_whole_stiffness_is_projected() {
    let few = state("p_pa,c11_pa,c33_pa,c13_pa", "5e4,300,200,100").unwrap();
    assert_eq!(few.moduli.values(), [None, None, None, Some(300.0), Some(200.0), Some(100.0)]);
    assert_eq!(few.asymmetry, None);

    // C11 ≠ C22: neither is the modulus of the projection.
    let mut entries = [0.0; 36];
    for (n, value) in [(0, 300.0), (7, 340.0), (14, 280.0), (21, 90.0), (28, 110.0), (35, 95.0)] {
        entries[n] = value;
    }
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        (entries[6 * i + j], entries[6 * j + i]) = (120.0, 120.0);
    }
    let row = entries.map(|e| e.to_string()).join(",");
    let full = state(&format!("p_pa,{}", matrix_names().join(",")), &format!("5e4,{row}")).unwrap();
    let medium = Stiffness::from_row_major(&entries).transverse_isotropy();
    assert_eq!(full.moduli, Moduli::of_medium(&medium));
    assert_eq!(full.asymmetry, Some(medium.residual));
    assert_ne!(full.moduli.get(Modulus::C11), Some(300.0));

    // About the axis of the row, which is in the columns of a packing measured about it.
    let axis = "reference_axis_x,reference_axis_y,reference_axis_z";
    let about = |cells: &str| {
        state(&format!("p_pa,{},{axis}", matrix_names().join(",")), &format!("5e4,{row},{cells}"))
    };
    let turned = Stiffness::from_row_major(&entries).transverse_isotropy_about(&Vec3::x());
    assert_eq!(about("2,0,0").unwrap().moduli, Moduli::of_medium(&turned));
    assert_eq!(about("0,0,1").unwrap().moduli, full.moduli);
    assert_eq!(about(",,").unwrap().moduli, full.moduli);
    assert!(about("0,0,0").unwrap_err().contains("not a direction"));

    // One half of the matrix suffices.
    let upper: Vec<usize> = (0..36).filter(|n| n / 6 <= n % 6).collect();
    let names = matrix_names();
    let header = upper.iter().map(|n| names[*n].clone()).collect::<Vec<_>>().join(",");
    let row = upper.iter().map(|n| entries[*n].to_string()).collect::<Vec<_>>().join(",");
    let half = state(&format!("p_pa,{header}"), &format!("5e4,{row}")).unwrap();
    assert_eq!(half, full);
}

#[test]
fn entries_in_the_frame_of_the_cell_are_no_moduli_about_another_axis() {
    let axis = "reference_axis_x,reference_axis_y,reference_axis_z";
    for (entry, modulus) in [("c11_pa", "ti_c11_pa"), ("c44_pa", "g13_pa"), ("c66_pa", "g12_pa")] {
        let row = |cells: &str| state(&format!("p_pa,theta_pa,{entry},{axis}"), &format!("5e4,1e8,{cells}"));
        let fault = row("3e8,1,0,0").unwrap_err();
        assert!(fault.contains(entry) && fault.contains(&format!("give {modulus},")), "{fault}");
        assert!(["3e8,0,0,-1", "3e8,,,", ",1,0,0"].iter().all(|cells| row(cells).is_ok()));
    }
    assert!(state(&format!("p_pa,ti_c11_pa,{axis}"), "5e4,3e8,1,0,0").is_ok());
}

#[test]
fn moduli_about_e3_for_want_of_an_axis_have_a_note() {
    let notes = |found: &str| state("p_pa,g12_pa,axis_found", &format!("5e4,1e8,{found}")).unwrap().notes;
    assert!(notes("false")[0].to_string().contains("no axis stood out"), "{:?}", notes("false"));
    assert!(notes("true").is_empty() && notes("").is_empty());
}

#[test]
fn the_projection_that_analyze_prints_is_that_of_a_stiffness() {
    let names = "p_pa,g12_pa,g13_pa,theta_pa,ti_c11_pa,ti_c33_pa,ti_c13_pa";
    let printed = state(names, "5e4,1,2,3,4,5,6").unwrap();
    assert_eq!(printed.moduli.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Some));
    assert!(printed.projected && !state("p_pa,c11_pa", "5e4,7").unwrap().projected);
}

#[test]
fn a_stiffness_that_contradicts_a_modulus_or_itself_is_refused_or_noted() {
    let mut entries = [0.0; 36];
    for i in 0..3 {
        (0..3).for_each(|j| entries[6 * i + j] = if i == j { 3e8 } else { 1e8 });
        entries[7 * (i + 3)] = 1e8;
    }
    let row = |entries: &[f64; 36], more: &str| {
        let cells: Vec<String> = entries.iter().map(f64::to_string).collect();
        state(
            &format!("p_pa,{},g12_pa", matrix_names().join(",")),
            &format!("5e4,{},{more}", cells.join(",")),
        )
    };
    let g12 = row(&entries, "").unwrap().moduli.get(Modulus::G12).unwrap();
    assert!(row(&entries, &g12.to_string()).unwrap().notes.is_empty());
    assert!(row(&entries, "1e6").unwrap_err().contains("is not that of the stiffness"));
    entries[1] *= 1.05;
    assert!(row(&entries, "").unwrap().notes[0].to_string().contains("not symmetric"));
    (entries[4], entries[24]) = (1e9, 1e9);
    assert!(row(&entries, "").unwrap_err().contains("not positive definite"));
}

/// C11 of the projection is not the entry c11 of a stiffness that is not isotropic about the axis.
#[test]
fn a_stiffness_beside_all_moduli_of_its_projection_is_read_as_an_analysis_prints_it() {
    let mut entries = [0.0; 36];
    for (n, value) in [(0, 3.0e8), (7, 3.4e8), (14, 2.8e8), (21, 0.9e8), (28, 1.1e8), (35, 0.95e8)] {
        entries[n] = value;
    }
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        (entries[6 * i + j], entries[6 * j + i]) = (1e8, 1e8);
    }
    let cells = entries.map(|e| e.to_string()).join(",");
    let matrix = matrix_names().join(",");
    let alone = state(&format!("p_pa,{matrix}"), &format!("5e4,{cells}")).unwrap();
    let names = "g12_pa,g13_pa,theta_pa,ti_c11_pa,ti_c33_pa,ti_c13_pa";
    let moduli = alone.moduli.values().map(|m| m.unwrap().to_string());
    let row = |moduli: &str| state(&format!("p_pa,{names},{matrix}"), &format!("5e4,{moduli},{cells}"));
    assert_eq!(row(&moduli.join(",")).unwrap().moduli, alone.moduli);
    let mut wrong = moduli;
    wrong[3] = "3e8".to_owned();
    assert!(row(&wrong.join(",")).unwrap_err().contains("C11 = 3e8 Pa is not that of the stiffness"));
}

#[test]
fn grains_are_counted_and_the_truth_is_a_number() {
    for grains in ["0", "-3", "2.5", "nan", "inf"] {
        assert!(
            state("p_pa,g12_pa,grains", &format!("5e4,1,{grains}")).unwrap_err().contains("number of grains")
        );
    }
    for (column, value) in [("k", "nan"), ("z", "-1"), ("z", "40"), ("eps", "7"), ("eps_stiffness", "inf")] {
        let fault = state(&format!("p_pa,g12_pa,{column}"), &format!("5e4,1,{value}")).unwrap_err();
        assert!(fault.contains(&format!("column {column}:")), "{fault}");
    }
}

#[test]
fn moduli_without_an_error_beside_ones_that_have_one_are_said_to_be_exact() {
    let notes = |header: &str, row: &str| state(header, row).unwrap().notes;
    let some = notes("p_pa,g12_pa,g13_pa,theta_pa,g12_sigma_pa", "5e4,1e8,1e8,1.3e8,1e6");
    assert!(some.len() == 1 && some[0].to_string().contains("G13, Theta"), "{some:?}");
    assert!(notes("p_pa,g12_pa,g12_sigma_pa", "5e4,1e8,1e6").is_empty());
    assert!(notes("p_pa,g12_pa,g13_pa", "5e4,1e8,1e8").is_empty());
}

#[test]
fn a_packing_without_stiffness_is_a_row_without_moduli() {
    let header = format!("p_pa,phi,{}", matrix_names().join(","));
    let empty = state(&header, &format!("5e4,0.6{}", ",".repeat(36))).unwrap();
    assert_eq!(empty.moduli, Moduli::NONE);
    let torn = state(&header, &format!("5e4,0.6,1{}", ",".repeat(35))).unwrap_err();
    assert!(torn.contains("c12_pa is empty"), "{torn}");
}

#[test]
fn pressures_are_in_the_unit_that_their_column_names() {
    for header in ["p_kpa,g12_pa", "p_pa,g12_pa", "pressure_pa,g12_pa"] {
        let unit = if header.starts_with("p_kpa") { 1e3 } else { 1.0 };
        assert_eq!(state(header, "50,1").unwrap().conditions.pressure.value, 50.0 * unit, "{header}");
    }
    assert!(state("p_pa,g12_pa", ",1").unwrap_err().contains("p_pa is empty"));
}

fn refused(header: &str) -> String {
    Columns::of_header(header.as_bytes(), &[], State::default()).err().unwrap_or_default()
}

#[test]
fn two_columns_of_one_modulus_are_refused_unless_one_is_an_entry_of_a_whole_stiffness() {
    let twice = refused("p_pa,g12_pa,c66_pa");
    assert!(twice.contains("g12_pa and c66_pa both contain g12_pa"), "{twice}");
    assert!(refused("p_pa,ti_c11_pa,c11_pa").contains("both contain"));
    assert!(refused("p_kpa,pressure_pa,g12_pa").contains("both contain"));
    assert_eq!(refused(&format!("p_pa,g12_pa,ti_c11_pa,{}", matrix_names().join(","))), "");
}

#[test]
fn a_column_that_is_almost_one_that_is_read_is_refused_by_both_names() {
    for (column, meant) in
        [("G13_PA", "g13_pa"), ("g12_sigma", "g12_sigma_pa"), ("q_over_p", "axial_q_over_p")]
    {
        let fault = refused(&format!("p_pa,g12_pa,{column}"));
        assert!(fault.contains(column) && fault.contains(&format!("almost {meant}:")), "{fault}");
        assert_eq!(refused(&format!("p_pa,g12_pa,_{column}")), "");
    }
    assert!(refused("p_pa,g12_pa,size_spread_percent").contains("almost size_spread:"));
    assert_eq!(refused("name,operator,mu2,p_pa,g12_pa,stddev_c11_pa"), "");
    assert!(refused("p_pa,c11_pa,c12_pa").contains("c12_pa is an entry of a stiffness"));
}

#[test]
fn smooth_grains_of_an_analysis_and_errors_of_what_is_not_there_are_not_overlooked() {
    assert!(
        ["true", "True"]
            .iter()
            .all(|yes| state("p_pa,g12_pa,smooth", &format!("5e4,1e8,{yes}")).unwrap().conditions.smooth)
    );
    assert!(!state("p_pa,g12_pa,smooth", "5e4,1e8,").unwrap().conditions.smooth);
    assert!(state("p_pa,g12_pa,smooth", "5e4,1e8,maybe").unwrap_err().contains("not true or false"));
    let lonely = state("p_pa,g12_pa,axial_q_over_p,axial_q_over_p_sigma", "5e4,1e8,,0.1").unwrap_err();
    assert!(lonely.contains("column axial_q_over_p_sigma is a standard deviation"), "{lonely}");
}

#[test]
fn a_flag_beside_its_column_is_refused_and_fills_a_missing_one() {
    let with = |header: &str| {
        let defaults = State {
            poisson: Some(0.3),
            conditions: Conditions { shear_modulus_stddev: 1e9, ..Conditions::default() },
            ..State::default()
        };
        Columns::of_header(header.as_bytes(), &[], defaults).err().unwrap_or_default()
    };
    assert!(with("p_pa,g12_pa,poisson").contains("--poisson contradicts the column poisson"));
    assert!(
        with("p_pa,g12_pa,grain_shear_modulus_sigma_pa").contains("--grain-shear-modulus-sigma contradicts")
    );
    assert_eq!(with("p_pa,g12_pa,grain_shear_modulus_pa"), "");
}

#[test]
fn frictionless_rows_without_a_word_on_springs_are_refused() {
    let fault = state("p_pa,g12_pa,friction", "5e4,1e8,0").unwrap_err();
    assert!(fault.contains("no tangential springs") && fault.contains("column smooth"), "{fault}");
    assert!(state("p_pa,g12_pa,friction", "5e4,1e8,0.3").is_ok());
    assert!(!state("p_pa,g12_pa,friction,smooth", "5e4,1e8,0,false").unwrap().conditions.smooth);
}

#[test]
fn an_error_in_pa_that_is_probably_a_share_has_a_note() {
    let notes = |sigma: &str| state("p_pa,g12_pa,g12_sigma_pa", &format!("5e4,1e8,{sigma}")).unwrap().notes;
    assert!(
        notes("0.01")[0].to_string().contains("g12_sigma_pa = 0.01 Pa is improbably small"),
        "{:?}",
        notes("0.01")
    );
    assert!(notes("1e6").is_empty() && notes("0").is_empty());
}

#[test]
fn negative_errors_are_refused() {
    let fault = state("p_pa,g12_pa,g12_sigma_pa", "5e4,1e8,-1e6").unwrap_err();
    assert!(fault.contains("g12_sigma_pa") && fault.contains("-1000000"), "{fault}");
}

#[test]
fn blank_lines_and_comments_are_no_rows() {
    let columns = columns("p_pa,g12_pa");
    for line in ["", "   ", "# 5e4,1e8"] {
        assert!(columns.row(line.as_bytes()).is_none(), "{line:?}");
    }
    assert!(columns.row(b"\xff,1").unwrap().unwrap_err().fault.contains("UTF-8"));
}

#[test]
fn pressures_as_a_servo_leaves_them_are_one_group_and_whole_numbers_stay() {
    for (cell, label) in [
        ("49998.31", "50000"),
        ("50012.7", "50000"),
        ("0.15", "0.15"),
        ("1017", "1017"),
        ("s1", "s1"),
        ("", ""),
    ] {
        assert_eq!(group_label(cell), label, "{cell}");
    }
}

#[test]
fn quoted_cells_hold_commas_and_quotes() {
    for (line, expected) in [
        ("a, b ,", &["a", "b", ""][..]),
        ("\"x, y\",1", &["x, y", "1"]),
        ("1,\"say \"\"no\"\"\",3", &["1", "say \"no\"", "3"]),
        ("\"\",", &["", ""]),
        ("1,a\"b,2", &["1", "a\"b", "2"]),
    ] {
        assert_eq!(cells(line.as_bytes()).unwrap().iter().collect::<Vec<_>>(), expected, "{line}");
    }
    for line in ["\"a,b", "1,\"a\"\""] {
        assert!(cells(line.as_bytes()).is_err(), "{line}");
    }
}
