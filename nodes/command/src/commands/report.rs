//! `grainlab report`: pages of recorded runs.

use grainlab_console::{Failure, count, has_name_of, print, say, worse, write_whole};
use grainlab_node_kit::Exit;
use grainlab_report::{FILE, Run, default_page, overview};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  grainlab report recordings/runs/demo-1-1                 the page of a run: report.html in its folder
  grainlab report recordings/runs/demo-1-1 -o demo.html
  grainlab report recordings/runs/*                        a page for each, and runs.html with one row per run
  grainlab report recordings/campaigns/friction/members/*  also with figures over the settings in which runs differ

Runs that differ in one setting or two, of which one is a number, have figures: each quantity over the setting with most values, as mean with
standard error over seeds, and a curve for each value of the other one. Keys that change together are one setting.";

/// Page of many runs, beside the present folder's other files.
const OVERVIEW: &str = "runs.html";

/// Runs to report.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Run directories, or recordings
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// File of the page [default: report.html in the folder of the run, RECORDING.html beside a recording; of many runs, runs.html here]
    #[arg(short, long, alias = "out", value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    args.output.as_ref().map_or(Ok(()), |path| has_name_of("-o", path, "html"))?;
    if let [run] = args.runs.as_slice() {
        let found = read(run)?;
        let path = args.output.clone().map_or_else(|| default_page(beside(run)), Ok)?;
        write(&found, &path)?;
        print(&format!("{}\n", path.display()))?;
        return Ok(standing(run, &found));
    }
    let output = args.output.clone().map_or_else(|| default_page(OVERVIEW.into()), Ok)?;
    let mut all = Vec::with_capacity(args.runs.len());
    let (mut exit, mut repeated) = (Exit::Done, 0);
    for directory in &args.runs {
        match read(directory).and_then(|run| Ok((run, default_page(beside(directory))?))) {
            Ok((run, path)) => {
                write(&run, &path)?;
                exit = worse(exit, standing(directory, &run));
                if all.iter().any(|(other, _)| run.repeats(other)) {
                    repeated += 1;
                } else {
                    all.push((run.without_series(), link(&output, &path)));
                }
            }
            Err(failure) => {
                say!("grainlab: {failure}");
                exit = worse(exit, Exit::Failure);
            }
        }
    }
    if repeated > 0 {
        let repeated = count(repeated, "run");
        say!("grainlab: left out of the page: {repeated} with the scene, seed and packings of another one");
    }
    if all.is_empty() {
        return Err(Failure::failed("there is no run to report"));
    }
    write_whole(&output, overview(&all))?;
    print(&format!("{}: {}, each with its page\n", output.display(), count(all.len(), "run")))?;
    Ok(exit)
}

fn read(path: &Path) -> Result<Run, Failure> {
    path.metadata().map_err(Failure::at(path))?;
    let run = Run::read(path);
    if let Some(several) = run.several_runs() {
        return Err(Failure::failed(several));
    }
    match run.nothing() {
        Some(why) => Err(Failure::failed(format!("{} is no run: {why}", path.display()))),
        None => Ok(run),
    }
}

/// Data were lost if something could not be read, or it is unknown which are right.
fn standing(path: &Path, run: &Run) -> Exit {
    if run.is_incomplete() {
        say!("grainlab: {}: not all of it can be read: the page names what is missing", path.display());
        return Exit::DataLoss;
    }
    if run.is_disputed() {
        say!(
            "grainlab: {}: messages of one run contradict each other: the page names their processes",
            path.display()
        );
        return Exit::DataLoss;
    }
    Exit::Done
}

fn write(run: &Run, path: &Path) -> Result<(), Failure> {
    let page = run.html().map_err(Failure::failed)?;
    write_whole(path, &page)
}

/// The page of a run: in its folder, or beside its recording and named after it, since a folder may have several.
fn beside(run: &Path) -> PathBuf {
    if run.is_dir() {
        return run.join(FILE);
    }
    let mut name = run.file_name().unwrap_or_default().to_owned();
    name.push(".html");
    run.with_file_name(name)
}

/// The path of a page from the folder of another, for a link.
fn link(from: &Path, to: &Path) -> String {
    let absolute = |p: &Path| std::path::absolute(p).unwrap_or_else(|_| p.to_owned());
    let (from, to) = (absolute(from), absolute(to));
    let folder: Vec<_> = from.parent().into_iter().flat_map(Path::components).collect();
    let target: Vec<_> = to.components().collect();
    let common = folder.iter().zip(&target).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..".to_owned(), folder.len() - common);
    let down = target[common..].iter().map(|c| percent(&c.as_os_str().to_string_lossy()));
    up.chain(down).collect::<Vec<_>>().join("/")
}

/// A part of a path in a link: other characters than letters, digits and `-._~` as percent codes.
fn percent(part: &str) -> String {
    let code = |byte: u8| match byte {
        b if b.is_ascii_alphanumeric() || b"-._~".contains(&b) => char::from(b).to_string(),
        b => format!("%{b:02X}"),
    };
    part.bytes().map(code).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_of_one_folder_have_a_page_each() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str| beside(&folder.path().join(name));
        assert_eq!(of("a.mcap"), folder.path().join("a.mcap.html"));
        assert_ne!(of("a.mcap"), of("b.mcap"));
        assert_eq!(beside(folder.path()), folder.path().join("report.html"));
    }

    #[test]
    fn a_link_leads_from_one_page_to_the_other() {
        let of = |from: &str, to: &str| link(Path::new(from), Path::new(to));
        assert_eq!(of("/a/runs.html", "/a/runs/x 1/report.html"), "runs/x%201/report.html");
        assert_eq!(of("/a/b/runs.html", "/a/c/report.html"), "../c/report.html");
        assert_eq!(of("runs.html", "report.html"), "report.html");
    }
}
