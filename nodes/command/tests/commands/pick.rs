//! `grainlab pick`: speeds from the files of an oscilloscope.

use crate::grainlab_in;
use std::path::Path;

/// A sine of two periods of 10 kHz under a window, `late` seconds after time 0.
fn burst(time: f64, late: f64) -> f64 {
    let u = (time - late) * 10e3 / 2.0 - 0.5;
    if u.abs() < 0.5 {
        (std::f64::consts::PI * u).cos().powi(2) * (4.0 * std::f64::consts::PI * u).sin()
    } else {
        0.0
    }
}

/// The lines of a wave that arrives after `late` seconds, in columns that `line` makes.
fn file(folder: &Path, name: &str, late: f64, line: impl Fn(f64, f64, f64) -> String) {
    let one = |k: i32| {
        let time = f64::from(k - 200) * 1e-6;
        // Hum with the frequency of the source.
        let ripple = 0.01 * (f64::from(k * k % 97) / 48.5 - 1.0);
        line(time, 5.0 * burst(time, 0.0), burst(time, late) + ripple) + "\n"
    };
    let text: String = (0..1200).map(one).collect();
    std::fs::write(folder.join(name), format!("Model,SDS1104\nSource,CH1,CH2\nSecond,Volt,Volt\n{text}"))
        .unwrap();
}

fn records(folder: &Path) {
    file(folder, "p.csv", 0.1 / 500.0, |t, s, r| format!("{t:e},{s:.5},{r:.5}"));
    // Decimal commas, times in microseconds, the receiver first.
    let german = |t: f64, s: f64, r: f64| format!("{:.3};{r:.5};{s:.5}", 1e6 * t).replace('.', ",");
    file(folder, "s.csv", 0.1 / 300.0, german);
    std::fs::write(
        folder.join("records.csv"),
        "file,mode,direction,distance,diameter,source_column,receiver_column,time_unit,pressure_pa,density\n\
         p.csv,p,along,0.1,1e-4,2,3,s,1e5,1550\ns.csv,s,along,0.1,1e-4,3,2,us,1e5,1550\n",
    )
    .unwrap();
}

#[test]
fn records_become_the_speeds_that_the_inversion_reads() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path());
    let out = grainlab_in(
        folder.path(),
        &["pick", "records.csv", "--out", "speeds.csv", "--plot", "picked", "--format", "csv"],
    )
    .assert_code(0);
    let text = std::fs::read_to_string(folder.path().join("speeds.csv")).unwrap();
    assert_eq!(text, out.stdout);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    for (row, truth) in rows.iter().zip([500.0, 300.0]) {
        let [speed, sigma] = ["speed", "speed_sigma"].map(|name| row[column(name)].parse::<f64>().unwrap());
        assert!((speed - truth).abs() < 3.0 * sigma && sigma < 0.03 * truth, "{speed} +- {sigma} of {truth}");
        assert_eq!(&row[column("pressure_pa")], "1e5");
    }
    assert!(rows.iter().all(|row| row[column("speed_shared_sigma")].parse::<f64>().unwrap() > 0.0));
    let note = "the delay of the electronics was taken as 0: all records";
    assert!(out.stderr.contains(note));
    let drawn = std::fs::read_to_string(folder.path().join("picked/002-p-p-along.svg")).unwrap();
    assert!(
        ["first_arrival", "peak", "cross_correlation"]
            .iter()
            .any(|by| drawn.contains(&format!("m/s by {by}"))),
        "{drawn}"
    );
    assert_eq!(std::fs::read_dir(folder.path().join("picked")).unwrap().count(), 2);
    let invert = ["invert", "--speeds", "speeds.csv", "--grain-shear-modulus", "29e9", "--poisson", "0.2"];
    grainlab_in(folder.path(), &invert).assert_code(0);
}

#[test]
fn a_file_that_would_replace_an_input_or_have_the_name_of_another_format_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path());
    let speeds =
        "angle_deg,mode,speed,speed_sigma\n0,p,439,4\n90,p,426,4\n45,p,430,4\n0,sv,268,3\n90,sh,265,3\n";
    std::fs::write(folder.path().join("h.csv"), speeds).unwrap();
    let content = || {
        let read = |name| std::fs::read(folder.path().join(name)).unwrap();
        ["records.csv", "p.csv", "s.csv", "h.csv"].map(read)
    };
    let before = content();
    let draws = "invert --speeds h.csv --contact hertz --density 1498 --pressure 50e3 --stress-ratio 0 --size-spread 0 --model relaxed --draws h.csv";
    let draws: Vec<&str> = draws.split(' ').collect();
    for words in [
        &["pick", "records.csv", "--out", "./records.csv"][..],
        &["pick", "records.csv", "--out", "p.csv"],
        &draws,
        &["view", "p.csv", "-o", "p.csv"],
        &["report", "records.csv", "-o", "page.pdf"],
        &["invert", "--table", "records.csv", "--plot", "p.svg"],
        &["invert", "--table", "records.csv", "--judge", "--plot", "p.html"],
    ] {
        assert_eq!(grainlab_in(folder.path(), words).code, Some(2), "{words:?}");
    }
    assert_eq!(content(), before);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4, "no file is written");
}

#[test]
fn a_record_that_ends_soon_after_the_pick_is_noted_and_the_note_goes_with_the_speed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    file(folder.path(), "s.csv", 0.1 / 300.0, |t, s, r| format!("{t:e},{s:.5},{r:.5}"));
    let lines = std::fs::read_to_string(path("s.csv")).unwrap();
    let short: Vec<&str> = lines.lines().take(800).collect();
    std::fs::write(path("short.csv"), short.join("\n")).unwrap();
    let table = "file,mode,distance,diameter,delay,pressure_pa,density\nshort.csv,s,0.1,1e-4,0,1e5,1550\ns.csv,s,0.1,1e-4,0,4e5,1550\n";
    std::fs::write(path("records.csv"), table).unwrap();
    grainlab_in(folder.path(), &["pick", "records.csv", "--out", "speeds.csv"]).assert_code(0);
    let speeds = std::fs::read_to_string(path("speeds.csv")).unwrap();
    let rows: Vec<&str> = speeds.lines().collect();
    assert!(
        rows[0].ends_with(",_notes") && rows[1].contains("the record ends soon after the pick"),
        "{speeds}"
    );
    assert!(!rows[2].contains("ends soon"), "{speeds}");
    let invert = ["invert", "--speeds", "speeds.csv", "--grain-shear-modulus", "29e9", "--poisson", "0.2"];
    assert_eq!(grainlab_in(folder.path(), &invert).code, Some(0));
}

#[test]
fn a_fault_is_named_with_its_file_and_line_and_a_refused_record_keeps_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    records(folder.path());
    file(folder.path(), "silent.csv", 1.0, |t, s, r| format!("{t:e},{s},{r}"));
    let text = std::fs::read_to_string(path("p.csv")).unwrap();
    let wide = text.encode_utf16().flat_map(u16::to_le_bytes);
    std::fs::write(path("wide.csv"), [0xff, 0xfe].into_iter().chain(wide).collect::<Vec<u8>>()).unwrap();
    let channels = |row: &str| format!("file,mode,distance,diameter,source_column,receiver_column\n{row}\n");
    let plain = |rows: &str| format!("file,distance,diameter\n{rows}\n");
    for (table, code, words) in [
        ("file,distance\np.csv,0.1\n".into(), 2, &["no column diameter; columns are file, distance"][..]),
        ("file,distance,diameter,distence_sigma\n".into(), 2, &["did you mean distance_sigma?"]),
        (plain("p.csv,ten,1e-4"), 2, &["t.csv", "line 2", "column distance: \"ten\" is not a number"]),
        (channels("p.csv,P-wave,0.1,1e-4,2,3"), 2, &["mode is \"P-wave\"; it must be one of p, s, sv, sh"]),
        (plain("p.csv,-0.1,1e-4"), 2, &["line 2: distance is -0.1", "5 diameters or more"]),
        (channels("p.csv,p,0.1,1e-4,2,7"), 2, &["p.csv", "no lines of numbers in the columns 1, 2 and 7"]),
        (plain("silent.csv,0.1,1e-4\np.csv,0.1,1e-4"), 4, &["no arrival: ", ": silent.csv", "p.csv"]),
        (plain("silent.csv,0.1,1e-4\np.csv,0.1,1e-4"), 4, &["1 of 2 records have no speed"]),
        (plain("none.csv,0.1,1e-4\np.csv,0.1,1e-4"), 2, &["(os error 2): none.csv", "cross_correlation *"]),
        (plain("none.csv,0.1,1e-4\np.csv,0.1,1e-4"), 2, &["1 of 2 records could not be read"]),
        (plain("/dev/null,0.1,1e-4"), 2, &["it is a device"]),
        (channels("p.csv,p,0.1,1e-4,2,2"), 4, &["source and receiver are the same signal"]),
        (channels("p.csv,p,0.1,1e-4,3,2"), 4, &["the receiver has the wave before the source has it"]),
        (channels("wide.csv,p,0.1,1e-4,2,3"), 2, &["it is UTF-16 text: save it as UTF-8"]),
    ] {
        std::fs::write(path("t.csv"), &table).unwrap();
        let out = grainlab_in(folder.path(), &["pick", "t.csv"]);
        let text = format!("{}{}", out.stdout, out.stderr);
        assert_eq!(out.code, Some(code), "{table}{text}");
        words.iter().for_each(|word| assert!(text.contains(word), "{word}: {table}{text}"));
    }
}

/// Two strong waves: the later one arrives when S may, so the earlier one may be P.
#[test]
fn another_wave_that_may_be_the_one_of_the_mode_is_noted_with_its_speed() {
    let folder = tempfile::tempdir().unwrap();
    let (early, late) = (0.1 / 250.0, 0.1 / 150.0);
    let two = |t: f64, s: f64, r: f64| format!("{t:e},{s:.5},{:.5}", r + 1.2 * burst(t, late));
    file(folder.path(), "s.csv", early, two);
    let table = "file,mode,distance,diameter,delay,pressure_pa,density\ns.csv,s,0.1,1e-4,0,1e5,1550\n";
    std::fs::write(folder.path().join("records.csv"), table).unwrap();
    grainlab_in(folder.path(), &["pick", "records.csv", "--out", "speeds.csv"]).assert_code(0);
    let speeds = std::fs::read_to_string(folder.path().join("speeds.csv")).unwrap();
    for words in ["a strong wave (1", "follows the first strong one (2", "the later was taken", "may be P"] {
        assert!(speeds.contains(words), "{words:?}: {speeds}");
    }
}
