//! Many files at once, with a few packings of them in memory.

use super::Measure;
use super::bar::Bar;
use super::outlet::Outlet;
use super::sink::{Ending, Place, Sink};
use grainlab_console::{Failure, Signals, count, worse};
use grainlab_node_kit::Exit;
use grainlab_recordings::Recording;
use grainlab_recordings::import::{ImportError, ImportOptions, Imported, each};
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Measures every packing of every file on all cores. A worker without a packing reads the next file. A
/// reader measures the packings that it reads once two per core are queued, which limits the memory.
pub(crate) fn run<M: Measure>(
    files: &[PathBuf],
    options: &ImportOptions,
    measure: &M,
    outlet: Outlet<M::Found>,
) -> Result<Exit, Failure> {
    let mut sink = Sink::new(outlet);
    let signals = Signals::install().map_err(Failure::failed)?;
    let stop = signals.flag();
    sink.bar = Bar::of(files.len());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let shop = Shop {
        files,
        options,
        measure,
        stop: &stop,
        room: 2 * workers,
        desk: Mutex::new(Desk::default()),
        news: Condvar::new(),
        sink: Mutex::new(sink),
        failure: Mutex::new(None),
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| shop.work());
        }
    });
    let Shop { desk, sink, failure, .. } = shop;
    if let Some(failure) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(failure);
    }
    let desk = desk.into_inner().unwrap_or_else(PoisonError::into_inner);
    let sink = sink.into_inner().unwrap_or_else(PoisonError::into_inner);
    let measured = sink.measured();
    let exit = sink.finish()?;
    // A signal after the end of all work has no effect.
    if desk.read_to_end == files.len() && desk.packings.is_empty() {
        return Ok(exit);
    }
    let left = files.len() - desk.read_to_end;
    grainlab_console::say!(
        "grainlab: interrupted: {} measured, {} not read to the end",
        count(measured, "packing"),
        count(left, "file")
    );
    Ok(worse(exit, Exit::Interrupted))
}

struct Job {
    place: Place,
    imported: Imported,
}

/// The state of the work.
#[derive(Default)]
struct Desk {
    /// The next file to read.
    next: usize,
    reading: usize,
    read_to_end: usize,
    packings: VecDeque<Job>,
}

enum Task {
    Measure(Box<Job>),
    Read(usize),
}

struct Shop<'a, M: Measure> {
    files: &'a [PathBuf],
    options: &'a ImportOptions,
    measure: &'a M,
    /// A signal arrived, or results cannot be written.
    stop: &'a AtomicBool,
    /// Maximum number of queued packings.
    room: usize,
    desk: Mutex<Desk>,
    news: Condvar,
    sink: Mutex<Sink<M::Found>>,
    failure: Mutex<Option<Failure>>,
}

impl<M: Measure> Shop<'_, M> {
    fn work(&self) {
        while let Some(task) = self.task() {
            match task {
                Task::Measure(job) => self.measure(&job),
                Task::Read(file) => self.read(file),
            }
        }
    }

    fn task(&self) -> Option<Task> {
        let mut desk = self.desk();
        loop {
            if self.stopped() {
                return None;
            }
            if let Some(job) = desk.packings.pop_front() {
                return Some(Task::Measure(Box::new(job)));
            }
            if desk.next < self.files.len() {
                desk.next += 1;
                desk.reading += 1;
                return Some(Task::Read(desk.next - 1));
            }
            if desk.reading == 0 {
                return None;
            }
            desk = self.news.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn measure(&self, job: &Job) {
        let source = self.files[job.place.0].display().to_string();
        let found = self.measure.measure(&source, &job.imported);
        let put = lock(&self.sink).put(job.place, found);
        self.check(put);
    }

    fn read(&self, file: usize) {
        let mut reading = Reading { desk: &self.desk, news: &self.news, to_end: false };
        let mut packings = 0;
        let (complaints, exit) = read(&self.files[file], self.options, &mut |imported| {
            let job = Job { place: (file, packings), imported };
            packings += 1;
            lock(&self.sink).found();
            let mut desk = self.desk();
            if desk.packings.len() < self.room {
                desk.packings.push_back(job);
                drop(desk);
                self.news.notify_one();
            } else {
                drop(desk);
                self.measure(&job);
            }
            if self.stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        if !self.stopped() {
            reading.to_end = true;
            let end = lock(&self.sink).end(file, Ending { packings, complaints, exit });
            self.check(end);
        }
    }

    /// All workers stop when results cannot be printed or recorded.
    fn check(&self, result: Result<(), Failure>) {
        if let Err(failure) = result {
            lock(&self.failure).get_or_insert(failure);
            self.stop.store(true, Ordering::Relaxed);
            self.news.notify_all();
        }
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn desk(&self) -> MutexGuard<'_, Desk> {
        lock(&self.desk)
    }
}

/// A file being read. Dropping it informs the waiting workers that no more packings come, also after a panic.
struct Reading<'a> {
    desk: &'a Mutex<Desk>,
    news: &'a Condvar,
    to_end: bool,
}

impl Drop for Reading<'_> {
    fn drop(&mut self) {
        let mut desk = lock(self.desk);
        desk.reading -= 1;
        desk.read_to_end += usize::from(self.to_end);
        drop(desk);
        self.news.notify_all();
    }
}

/// A worker that panicked ends the process at the end of the scope; until then the others continue.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Reads one file; returns its warnings and their exit code.
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
            let mut exit = match without_path(&error) {
                ImportError::Missing(_)
                | ImportError::Cell(_)
                | ImportError::HasItsOwn(_)
                | ImportError::ForcesBeside => Exit::Usage,
                _ => Exit::Failure,
            };
            let mut complaints = Vec::new();
            // A recording without a packing may be cut off before it, or the chunk with the packing may be
            // damaged: then data were lost.
            if let Ok(recording) = Recording::open(path) {
                complaints = lines(&recording.check().warnings);
                exit = if complaints.is_empty() { exit } else { Exit::DataLoss };
            }
            complaints.push(error.to_string());
            (complaints, exit)
        }
    }
}

fn without_path(error: &ImportError) -> &ImportError {
    match error {
        ImportError::In { source, .. } => without_path(source),
        other => other,
    }
}

#[cfg(test)]
mod tests;
