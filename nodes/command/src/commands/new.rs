//! `grainlab new`: programs to begin with.

use clap::Subcommand;
use grainlab_console::{Failure, print};
use grainlab_launcher::BUILT_IN;
use grainlab_msgs::{INTERFACES, TypeInfo};
use grainlab_node_kit::Exit;
use grainlab_recordings::NewPath;
use std::fs;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  grainlab new node my_probe --python     # an instrument: sends wave speeds, and prints what is inferred from them
  grainlab new node my_servo --servo      # a servo of your own, in the laboratory
  grainlab new node my_probe --rust

Writes a folder with the program, a launch file and a test, which work as they are: README.md in it has the commands. A program in
Python needs no ROS and no source of grainlab: the message types for CycloneDDS are in ./msgs. One in Rust is built with the source.";

/// Commands that write programs.
#[derive(Debug, Subcommand)]
pub(crate) enum NewCommand {
    /// Write a node of your own, with a launch file and a test.
    #[command(after_help = EXAMPLES)]
    Node(Args),
}

/// Arguments of `grainlab new node`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Name of the node, and of its folder: lower-case letters, digits and underscores
    #[arg(value_parser = name)]
    name: String,
    /// In Python, with CycloneDDS [default]
    #[arg(long, conflicts_with_all = ["rust", "servo"])]
    python: bool,
    /// In Rust, with the library of grainlab's own nodes
    #[arg(long, conflicts_with = "servo")]
    rust: bool,
    /// A servo in Python: it answers stresses with strain rates
    #[arg(long)]
    servo: bool,
    /// Source of grainlab, for --rust [default: where this program was built]
    #[arg(long, value_name = "DIR", requires = "rust")]
    source: Option<PathBuf>,
    /// New folder [default: NAME]
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Modules that a Python file in the folder of the node would hide: the standard library (`sys.stdlib_module_names`), and what the templates import.
const MODULES: &str = "\
    abc aifc argparse array ast asynchat asyncio asyncore atexit audioop base64 bdb binascii bisect builtins bz2 calendar \
    cgi cgitb chunk cmath cmd code codecs codeop collections colorsys compileall concurrent configparser contextlib \
    contextvars copy copyreg crypt csv ctypes curses dataclasses datetime dbm decimal difflib dis distutils doctest email \
    encodings ensurepip enum errno faulthandler fcntl filecmp fileinput fnmatch fractions ftplib functools gc genericpath \
    getopt getpass gettext glob graphlib grp gzip hashlib heapq hmac html http idlelib imaplib imghdr imp importlib \
    inspect io ipaddress itertools json keyword lib2to3 linecache locale logging lzma mailbox mailcap marshal math \
    mimetypes mmap modulefinder msilib msvcrt multiprocessing netrc nis nntplib nt ntpath nturl2path numbers opcode \
    operator optparse os ossaudiodev pathlib pdb pickle pickletools pipes pkgutil platform plistlib poplib posix posixpath \
    pprint profile pstats pty pwd py_compile pyclbr pydoc pydoc_data pyexpat queue quopri random re readline reprlib \
    resource rlcompleter runpy sched secrets select selectors shelve shlex shutil signal site smtpd smtplib sndhdr socket \
    socketserver spwd sqlite3 sre_compile sre_constants sre_parse ssl stat statistics string stringprep struct subprocess \
    sunau symtable sys sysconfig syslog tabnanny tarfile telnetlib tempfile termios test textwrap threading time timeit \
    tkinter token tokenize tomllib trace traceback tracemalloc tty turtle turtledemo types typing unicodedata unittest \
    urllib uu uuid venv warnings wave weakref webbrowser winreg winsound wsgiref xdrlib xml xmlrpc zipapp zipfile \
    zipimport zlib zoneinfo \
    msgs grainlab grainlab_msgs cyclonedds numpy pytest";

/// Names that cargo refuses for a program, and the crates that the template depends on.
const CRATES: &str = "build deps examples incremental grainlab_msgs grainlab_node_kit";

fn name(text: &str) -> Result<String, String> {
    let is_one = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let first = text.starts_with(|c: char| c.is_ascii_lowercase());
    if !(first && text.chars().all(is_one)) {
        return Err("lower-case letters, digits and underscores, a letter first, as my_probe".to_owned());
    }
    // No two nodes of a launch file have one name.
    let is_node = BUILT_IN.iter().any(|(_, launch)| launch.contains(&format!("name: {text}\n")));
    if is_node || [MODULES, CRATES].iter().any(|list| list.split(' ').any(|taken| taken == text)) {
        return Err(format!(
            "{text} is the name of a node of grainlab, of a module of Python or of a folder of cargo: choose another one, such as my_{text}"
        ));
    }
    Ok(text.to_owned())
}

/// Fails if the folder exists or cannot be written, or the source is not there.
pub(crate) fn run(command: &NewCommand) -> Result<Exit, Failure> {
    let NewCommand::Node(args) = command;
    let folder = args.output.clone().unwrap_or_else(|| args.name.clone().into());
    let files = if args.rust { rust(args)? } else { python(args) };
    let new = NewPath::begin(&folder).map_err(Failure::usage)?;
    let wrong = |e: std::io::Error| Failure::failed(format!("{}: {e}", folder.display()));
    let mut written = String::new();
    for (path, text) in files {
        let file = new.partial().join(&path);
        fs::create_dir_all(file.parent().unwrap_or(new.partial())).map_err(wrong)?;
        fs::write(&file, text).map_err(wrong)?;
        if !path.starts_with("msgs/") {
            written += &format!("  {path}\n");
        }
    }
    new.finish().map_err(wrong)?;
    print(&format!("{}:\n{written}README.md has the commands.\n", folder.display()))?;
    Ok(Exit::Done)
}

fn python(args: &Args) -> Vec<(String, String)> {
    let name = &args.name;
    let program = if args.servo {
        include_str!("../../../launch/servo.py").replace("my_servo", name)
    } else {
        include_str!("../../../launch/instrument.py").replace("instrument.py ", &format!("{name}.py "))
    };
    let run = format!("python3 $(dirname)/{name}.py");
    let launch = if args.servo { lab_with_servo(name, &run) } else { inversion_with(name, &run) };
    let test = if args.servo {
        "    done = launched(\"--scene\", \"demo\", \"--set\", \"grains.count=100\", \"--format\", \"json\")\n    \
         states = json.loads(done.stdout)[\"states\"]\n    assert states and all(s[\"pressure_pa\"] > 0 for s in states)\n"
    } else {
        "    done = launched()\n    lines = [line for line in done.stdout.splitlines() if line.endswith(\"  ok\")]\n    assert lines, done.stdout\n"
    };
    let program = program.replace("../../msgs", "./msgs");
    let test = include_str!("new/test_node.py").replace("NAME", name).replace("    TEST\n", test);
    let pip = "python3 -m pip install -r requirements.txt\n";
    let mut files = vec![
        (format!("{name}.py"), program),
        (format!("{name}.launch.yaml"), launch),
        (format!("test_{name}.py"), test),
        ("requirements.txt".into(), "./msgs\npytest\n".into()),
        ("README.md".into(), readme(name, &format!("{name}.py"), pip, "python3 -m pytest")),
        ("msgs/pyproject.toml".into(), include_str!("../../../../msgs/pyproject.toml").into()),
        (
            "msgs/python/grainlab_msgs/__init__.py".into(),
            include_str!("../../../../msgs/python/grainlab_msgs/__init__.py").into(),
        ),
    ];
    files.extend(messages());
    files
}

/// The message files, where the package of types expects them.
fn messages() -> Vec<(String, String)> {
    let own = TypeInfo::all().iter().map(|info| {
        let folder = if info.type_name.starts_with("grainlab_msgs/") { "" } else { "std/" };
        let path = info.type_name.strip_prefix("grainlab_msgs/").unwrap_or(info.type_name);
        // The text of the type itself stands before those of the types that it uses.
        let text = info.definition.split("\n====").next().unwrap_or_default();
        (format!("msgs/{folder}{path}.msg"), text.to_owned())
    });
    let common = INTERFACES.iter().filter(|(path, _)| path.ends_with(".msg"));
    own.chain(common.map(|(path, text)| (format!("msgs/interfaces/{path}"), (*text).to_owned()))).collect()
}

fn rust(args: &Args) -> Result<Vec<(String, String)>, Failure> {
    let name = &args.name;
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let source = args.source.as_deref().unwrap_or(&built);
    let source =
        source.canonicalize().ok().filter(|s| s.join("nodes/kit/node_kit").is_dir()).ok_or_else(|| {
            Failure::usage(format!(
                "{} is not the source of grainlab: give it with --source",
                source.display()
            ))
        })?;
    let main = include_str!("../../../kit/node_kit/examples/node.rs");
    let end_of_comment = main.find("\nuse ").unwrap_or(0);
    let main = format!(
        "//! An instrument of your own: sends wave speeds, and prints what the inversion infers from them.\n{}",
        main[end_of_comment..].replace("my_node", name)
    );
    let run = "cargo run --quiet --release --manifest-path $(dirname)/Cargo.toml";
    let manifest =
        include_str!("new/node.toml").replace("NAME", name).replace("SOURCE", &source.display().to_string());
    Ok(vec![
        ("Cargo.toml".into(), manifest),
        ("src/main.rs".into(), main),
        ("tests/launch.rs".into(), include_str!("new/test_node.txt").replace("NAME", name)),
        (format!("{name}.launch.yaml"), inversion_with(name, run)),
        ("README.md".into(), readme(name, "src/main.rs", "cargo build --release\n", "cargo test --release")),
    ])
}

/// The inversion, and the node, with whose end all ends.
fn inversion_with(name: &str, run: &str) -> String {
    include_str!("new/node.launch.yaml").replace("NAME", name).replace("RUN", run)
}

fn lab_with_servo(name: &str, run: &str) -> String {
    let (_, demo) = BUILT_IN[0];
    demo.replace("grainlab run servo_controller --ros-args -p min_readers:=2", run)
        .replace("name: servo_controller", &format!("name: {name}"))
        .replace("nodes/launch/demo.launch.yaml", &format!("{name}.launch.yaml"))
}

fn readme(name: &str, file: &str, prepare: &str, test: &str) -> String {
    let text = include_str!("new/README.txt").replace("NAME", name);
    text.replace("FILE", file).replace("PREPARE", prepare).replace("TEST", test)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_launch_files_start_the_new_node_and_names_that_python_cannot_import_are_refused() {
        let servo = lab_with_servo("mine", "python3 $(dirname)/mine.py");
        assert!(servo.contains("cmd: python3 $(dirname)/mine.py\n    name: mine\n"), "{servo}");
        assert!(!servo.contains("servo_controller\n"), "{servo}");
        for text in [servo, inversion_with("mine", "mine")] {
            assert!(!text.contains("NAME") && !text.contains("RUN"), "{text}");
        }
        assert!(["my_probe", "a1"].map(name).iter().all(Result::is_ok));
        assert!(
            ["1a", "My", "a-b", "msgs", "json", "random", "deps", "build", "recorder", "", "é"]
                .map(name)
                .iter()
                .all(Result::is_err)
        );
    }

    #[test]
    fn every_message_file_is_written_as_it_is_in_the_source() {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let files = messages();
        assert!(files.len() > 100, "{}", files.len());
        for (path, text) in files {
            let there = fs::read_to_string(source.join(&path)).unwrap_or_else(|e| panic!("{path}: {e}"));
            assert_eq!(text.trim_end(), there.trim_end(), "{path}");
        }
    }
}
