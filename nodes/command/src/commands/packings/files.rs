//! Many files at once, with a few packings of them in memory.

use super::writer::ResultWriter;
use super::{Found, import};
use crate::offline_recording::OfflineRecording;
use grainlab_console::{Failure, Format, Signals, count, worse};
use grainlab_msgs::Topic;
use grainlab_node_kit::Exit;
use grainlab_recordings::Recording;
use grainlab_recordings::import::{ImportOptions, Imported, each};
use grainlab_results::{Printed, Printer};
use indicatif::{ProgressBar, ProgressStyle};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel, sync_channel};
use std::time::Duration;

/// Period of the updates while a large packing is measured.
const TICK: Duration = Duration::from_millis(250);

/// A step of the output, in the order of the files and of their packings.
enum Event<R> {
    /// The result of a packing, once it is measured; without one if the work was stopped.
    Measured(Receiver<Result<Found<R>, String>>),
    /// The warnings of a file that was read to its end, and their exit code.
    FileRead(Vec<String>, Exit),
}

/// Files to measure, data that they lack, and the form of the results.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// Recordings (directory or .mcap), CSV with its JSON sidecar, LAMMPS dump or data files, YADE text exports; text also
    /// as .gz
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    import: import::Args,
    /// Also record the messages that the node of this measurement would publish, into this new directory
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Columns of --format csv, in this order [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    columns: Vec<String>,
}

impl Args {
    /// Measures every packing of the files for `grainlab COMMAND`, whose node publishes these topics.
    pub(crate) fn measured<R: Printed + Send>(
        &self,
        command: &'static str,
        topics: &[Topic],
        measure: impl Fn(&str, &Imported) -> Result<Found<R>, String> + Sync,
    ) -> Result<Exit, Failure> {
        self.import.topic_has_use(&self.files)?;
        let options = self.import.options()?;
        let printer = Printer::new(self.format, self.columns.clone())?;
        let create = |at: &PathBuf| OfflineRecording::create(at, topics, command);
        let recording = self.record.as_ref().map(create).transpose()?;
        run(&self.files, &options, measure, ResultWriter::new(printer, recording))
    }
}

/// Measures on all cores while the next packings are read; at most two a core wait, which limits the memory.
fn run<R: Printed + Send>(
    files: &[PathBuf],
    options: &ImportOptions,
    measure: impl Fn(&str, &Imported) -> Result<Found<R>, String> + Sync,
    mut writer: ResultWriter<R>,
) -> Result<Exit, Failure> {
    let signals = Signals::install().map_err(Failure::failed)?;
    let (stop, measure) = (signals.flag(), &measure);
    let bar = progress(files.len());
    writer.bar = bar.clone();
    let (mut found, mut read_to_end) = (0, 0);
    let (events, output) = sync_channel(2 * rayon::current_num_threads());
    let writer = std::thread::scope(|threads| {
        let writing = threads.spawn(|| write(writer, output, &stop));
        rayon::in_place_scope(|pool| {
            for file in files {
                let source = file.display().to_string();
                let mut of_file = 0;
                let (complaints, exit) = read(file, options, &mut |imported| {
                    let (sender, receiver) = channel();
                    let (stop, source) = (&*stop, source.clone());
                    // Without a writer, all stops.
                    if is_set(stop) || events.send(Event::Measured(receiver)).is_err() {
                        return ControlFlow::Break(());
                    }
                    pool.spawn(move |_| {
                        if !is_set(stop) {
                            let _ = sender.send(measure(&source, &imported));
                        }
                    });
                    // One packing of each file is expected from the start.
                    bar.inc_length(u64::from(of_file > 0));
                    (found, of_file) = (found + 1, of_file + 1);
                    ControlFlow::Continue(())
                });
                if is_set(&stop) || events.send(Event::FileRead(complaints, exit)).is_err() {
                    break;
                }
                read_to_end += 1;
                bar.set_message(format!("{read_to_end} of {} read", count(files.len(), "file")));
            }
        });
        drop(events);
        writing.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })?;
    let measured = writer.measured;
    let exit = writer.finish()?;
    // A signal after the end of all work has no effect.
    if read_to_end == files.len() && measured == found {
        return Ok(exit);
    }
    grainlab_console::say!(
        "grainlab: interrupted: {} measured, {} not read to the end",
        count(measured, "packing"),
        count(files.len() - read_to_end, "file")
    );
    Ok(worse(exit, Exit::Interrupted))
}

fn is_set(flag: &AtomicBool) -> bool {
    flag.load(Ordering::Relaxed)
}

/// Passes on the results; the work stops when they cannot be printed or recorded.
fn write<R: Printed>(
    mut writer: ResultWriter<R>,
    output: Receiver<Event<R>>,
    stop: &AtomicBool,
) -> Result<ResultWriter<R>, Failure> {
    for event in output {
        match event {
            Event::Measured(result) => {
                if let Ok(found) = result.recv() {
                    writer.put(found).inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
                }
            }
            Event::FileRead(complaints, exit) => writer.complain(&complaints, exit),
        }
    }
    Ok(writer)
}

/// A bar on a terminal: packings measured, of those found and one for each file that was not read.
fn progress(files: usize) -> ProgressBar {
    let bar = ProgressBar::new(files as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} packings, {msg}, {elapsed}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(TICK);
    bar
}

fn read(
    path: &Path,
    options: &ImportOptions,
    take: &mut dyn FnMut(Imported) -> ControlFlow<()>,
) -> (Vec<String>, Exit) {
    let lines =
        |warnings: &[grainlab_recordings::Warning]| warnings.iter().map(ToString::to_string).collect();
    match each(path, options, take) {
        Ok(warnings) => {
            let exit = if warnings.is_empty() { Exit::Done } else { Exit::DataLoss };
            (lines(&warnings), exit)
        }
        Err(error) => {
            let failure = error.failure();
            let mut exit = failure.exit;
            let mut complaints = Vec::new();
            // A recording without a packing may be cut off before it, or the chunk with the packing may be
            // damaged: then data were lost.
            if let Ok(recording) = Recording::open(path) {
                complaints = lines(&recording.check().warnings);
                exit = if complaints.is_empty() { exit } else { Exit::DataLoss };
            }
            complaints.push(failure.to_string());
            (complaints, exit)
        }
    }
}

#[cfg(test)]
mod tests;
