//! Malformed files of every format: an error that names file and line, never a panic or an endless search.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::support::in_cube;
use flate2::Compression;
use flate2::write::GzEncoder;
use grainlab_core::contact_search::SearchError;
use grainlab_recordings::import::{ImportError, ImportOptions, load};
use std::io::Write;

const CSV: &str = "# particles: id,x,y,z,radius,mass,vx,vy,vz,wx,wy,wz\np,1,0.1,0,0,0.1,1,0,0,0,0,0,0\np,2,0.25,0,0,0.1,1,0,0,0,0,0,0\n";
const YADE: &str = "#format id_x_y_z_r_matId\n# cell 1 1 1\n1\t0.1\t0\t0\t0.1\t0\n2\t0.25\t0\t0\t0.1\t0\n";
const DATA: &str = "LAMMPS data file\n\n2 atoms\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\nAtoms # sphere\n\n1 1 0.2 2500 0.1 0 0\n2 1 0.2 2500 0.25 0 0\n";
const DUMP: &str = "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\nITEM: ATOMS id x y z radius\n1 0.1 0 0 0.1\n2 0.25 0 0 0.1\n";

const ALL: [&str; 4] = [CSV, YADE, DATA, DUMP];

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// The error of a file named `bad.txt` with this content: it must name the file.
    fn refusal(&self, bytes: impl AsRef<[u8]>, options: &ImportOptions) -> String {
        let error = load(&self.write("bad.txt", bytes), options).unwrap_err().to_string();
        assert!(error.contains("bad.txt"), "{error}");
        assert!(error.len() < 600, "an error is for people: {} bytes", error.len());
        error
    }
}

#[test]
fn the_content_determines_the_format_for_any_name() {
    let folder = Folder::new();
    for (text, source) in ALL.into_iter().zip(["CSV", "YADE", "data file", "dump"]) {
        for name in ["a.txt", "a.csv", "a.dump", "data.a", "a.sphere", "a"] {
            let packings = load(&folder.write(name, text), &in_cube(1.0)).unwrap().packings;
            assert!(packings[0].source.contains(source), "{name}: {}", packings[0].source);
            assert_eq!(
                (packings[0].packing.ids.as_slice(), packings[0].packing.contacts.len()),
                (&[1, 2][..], 1)
            );
        }
    }
}

#[test]
fn windows_line_ends_byte_order_marks_blank_and_comment_lines_change_nothing() {
    let folder = Folder::new();
    for text in ALL {
        let plain = load(&folder.write("plain", text), &in_cube(1.0)).unwrap().packings;
        let dressed = format!("\u{feff}{}\r\n", text.replace('\n', "\r\n"));
        assert_eq!(load(&folder.write("dressed", dressed), &in_cube(1.0)).unwrap().packings, plain);
    }
    for text in [CSV, YADE] {
        let plain = load(&folder.write("plain", text), &in_cube(1.0)).unwrap().packings;
        let commented = text.replacen("\n", "\n# made on a Tuesday\n\n  # twice\n", 1);
        assert_eq!(load(&folder.write("commented", commented), &in_cube(1.0)).unwrap().packings, plain);
    }
}

#[test]
fn a_fault_of_any_format_is_named_with_its_line() {
    let folder = Folder::new();
    for (text, from, to, expected) in [
        (CSV, "id,x,y,z", "id,z,y,x", "line 1: the comment names z as column 2 of the particles"),
        (CSV, "p,2,", "p,1,", "line 3: grain 1 occurs twice, before in line 2"),
        (YADE, "2\t0.25", "1\t0.25", "line 4: grain 1 occurs twice, before in line 3"),
        (DATA, "2 1 0.2", "1 1 0.2", "line 11: grain 1 occurs twice, before in line 10"),
        (DUMP, "2 0.25", "1 0.25", "line 11: grain 1 occurs twice, before in line 10"),
        (CSV, "0.25,0,0,0.1,", "0.25,0,0,0,", "line 3: the radius of grain 2 is"),
        (YADE, "0.25\t0\t0\t0.1", "0.25\t0\t0\t0", "line 4: the radius of grain 2 is"),
        (DATA, "2 1 0.2", "2 1 -0.2", "line 11: the radius of grain 2 is"),
        (DUMP, "0.25 0 0 0.1", "0.25 0 0 0", "line 11: the radius of grain 2 is"),
    ] {
        let error = folder.refusal(text.replacen(from, to, 1), &in_cube(1.0));
        assert!(error.contains(expected), "{error}");
    }
    for (text, separator, line) in [(CSV, ",", 3), (YADE, "\t", 4), (DATA, " ", 11), (DUMP, " ", 11)] {
        for bad in ["nan", "inf", "1e999"] {
            let error = folder.refusal(text.replacen("0.25", bad, 1), &in_cube(1.0));
            assert!(error.contains(&format!("line {line}: position is not finite")), "{error}");
        }
        // A column too few, and one too many.
        let text = text.trim_end();
        let (shorter, _) = text.rsplit_once(separator).unwrap();
        for text in [shorter.to_owned(), format!("{text}{separator}1")] {
            let error = folder.refusal(&text, &in_cube(1.0));
            assert!(error.contains(&format!("line {line}: ")), "{error}");
        }
    }
    for header in
        ["# particles: p,id,x,y,z,radius", "# particles: made by y, z", "# particles: id, x, y, z, r"]
    {
        let text = CSV.replacen(CSV.lines().next().unwrap(), header, 1);
        assert!(load(&folder.write("a", text), &in_cube(1.0)).is_ok(), "{header}");
    }
}

#[test]
fn a_missing_cell_is_answered_with_the_flag_that_gives_it() {
    let folder = Folder::new();
    let without = ImportOptions { cell: None, ..in_cube(1.0) };
    for text in [CSV.to_owned(), YADE.replace("# cell 1 1 1\n", ""), DATA.replace("0 1 zlo zhi\n", "")] {
        let error = folder.refusal(text, &without);
        assert!(error.contains("--cell"), "{error}");
    }
}

#[test]
fn a_cell_far_smaller_than_its_grains_is_refused_at_once() {
    let folder = Folder::new();
    let begin = Instant::now();
    for edge in [1e-2, 1e-6, 1e-12] {
        let path = folder.write("small.csv", CSV);
        let error = load(&path, &in_cube(edge)).unwrap_err();
        let ImportError::In { source, .. } = &error else { panic!("{error}") };
        assert!(matches!(**source, ImportError::Contacts(SearchError::Crowded { .. })), "{edge}: {error}");
        assert!(error.to_string().contains("small.csv") && error.to_string().contains("units"), "{error}");
    }
    // Narrow in one direction only, and a cell of the right size with radii in micrometres.
    let mut narrow = in_cube(1e6);
    narrow.cell = narrow.cell.map(|mut c| {
        c[(2, 2)] = 1e-9;
        c
    });
    assert!(folder.refusal(CSV, &narrow).contains("too small for its grains, or too skewed"));
    let thousands: String =
        (0..5000).map(|k| format!("p,{k},0.{k:04},0.5,0.5,100,1,0,0,0,0,0,0\n")).collect();
    assert!(folder.refusal(thousands, &in_cube(1.0)).contains("too small for its grains, or too skewed"));
    assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", begin.elapsed());
}

#[test]
fn a_file_that_is_nothing_known_is_named_with_its_first_line() {
    let folder = Folder::new();
    let error = folder.refusal("\n\nhello there\n", &in_cube(1.0));
    assert!(error.contains("line 3, \"hello there\"") && error.contains("YADE"), "{error}");
    let error = folder.refusal("1 2 3 4\n1 2 3 4\n", &in_cube(1.0));
    assert!(error.contains("line 1, \"1 2 3 4\""), "{error}");
}

#[test]
fn an_empty_file_is_refused_under_every_name() {
    let folder = Folder::new();
    for name in ["a.csv", "a.dump", "a.data", "a.txt", "a"] {
        for content in ["", "\n  \r\n"] {
            let error = load(&folder.write(name, content), &in_cube(1.0)).unwrap_err();
            assert!(error.to_string().contains("it contains no packing"), "{name}: {error}");
        }
    }
    // Comments and headers alone are not a packing, either.
    for text in ["# particles\n", "#format x_y_z_r\n"] {
        assert!(folder.refusal(text, &in_cube(1.0)).contains("no packing"));
    }
}

#[test]
fn a_line_of_many_megabytes_is_refused_with_a_short_message() {
    let folder = Folder::new();
    let huge = "7".repeat(8 << 20);
    for text in ALL {
        let error = folder.refusal(text.replacen("0.25", &format!("x{huge}"), 1), &in_cube(1.0));
        assert!(error.contains("line ") && error.contains('…'), "{error}");
    }
    assert!(folder.refusal(&huge, &in_cube(1.0)).contains('…'));
}

#[test]
fn a_truncated_or_wrong_compressed_file_is_refused_with_the_reason() {
    let folder = Folder::new();
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(CSV.repeat(100).as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    let error = folder.refusal(&packed[..packed.len() / 2], &in_cube(1.0));
    assert!(error.contains("cut off"), "{error}");
    let mut damaged = packed.clone();
    damaged[packed.len() / 2] ^= 0x55;
    assert!(folder.refusal(damaged, &in_cube(1.0)).contains("damaged"));
    for magic in [&b"BZh91AY"[..], b"\xfd7zXZ\0\0", b"\x28\xb5\x2f\xfd\0", b"PK\x03\x04\0"] {
        let error = folder.refusal(magic, &in_cube(1.0));
        assert!(error.contains("unpack it first"), "{error}");
    }
    let error = folder.refusal(b"p,1\n\xff\xfe", &in_cube(1.0));
    assert!(error.contains("line 2: it is not text"), "{error}");
}
