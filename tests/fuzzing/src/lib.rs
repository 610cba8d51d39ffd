//! Mutated inputs for decoders and file formats.
//!
//! A [`Target`] has seeds, a bound of memory, and a function that must neither panic nor exceed the bound.
//! Inputs that once failed are kept under `corpus/<target>/` and always run first. `GRAINLAB_FUZZ_SECONDS`
//! sets the duration; without it, some hundred inputs are tried, the same in every run.
//!
//! The mutation loop is implemented here, without coverage: it runs with `cargo test` on stable Rust and
//! needs no other crate. `cargo-fuzz` needs a nightly compiler, and `bolero` a separate tool and some forty
//! crates for more than that.

mod memory;
mod mutate;

pub use memory::Counting;
pub use mutate::Mutator;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A decoder of bytes from outside.
pub struct Target<'a> {
    /// Name of the target and of its folder in the corpus.
    pub name: &'a str,
    /// Valid or nearly valid inputs.
    pub seeds: Vec<Vec<u8>>,
    /// Words of the format.
    pub words: &'a [&'a str],
    /// Memory in bytes that any input may need, plus a number per byte of the input.
    pub memory: (usize, usize),
    /// The decoder under test.
    pub decode: &'a mut dyn FnMut(&[u8]),
}

/// Number of inputs per target without `GRAINLAB_FUZZ_SECONDS`.
const INPUTS: u64 = 400;

/// Maximum time for a single input.
const SLOW: Duration = Duration::from_secs(20);

impl Target<'_> {
    /// Tries the corpus, the seeds and their mutations.
    ///
    /// # Panics
    /// If one of them panics, needs too much memory or too long; the input is stored in a file named in the
    /// message.
    pub fn run(mut self) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(self.name);
        for path in files(&folder) {
            let bytes = std::fs::read(&path).unwrap_or_default();
            self.attempt(&bytes, &path.display().to_string());
        }
        for n in 0..self.seeds.len() {
            let seed = self.seeds[n].clone();
            self.attempt(&seed, &format!("seed {n}"));
        }
        let seconds = std::env::var("GRAINLAB_FUZZ_SECONDS").ok().and_then(|s| s.parse::<f64>().ok());
        let start = Instant::now();
        // A longer run tries other inputs than the last one.
        let first = seconds
            .map_or(1, |_| std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(1, |d| d.as_nanos() as u64));
        let mut tried = 0;
        while seconds.map_or(tried < INPUTS, |s| start.elapsed().as_secs_f64() < s) {
            let number = first.wrapping_add(tried);
            let bytes = Mutator::new(number).mutate(&self.seeds, self.words);
            self.attempt(&bytes, &format!("input {number}"));
            tried += 1;
        }
        println!("{}: {tried} inputs in {:.1} s", self.name, start.elapsed().as_secs_f64());
    }

    fn attempt(&mut self, bytes: &[u8], what: &str) {
        let (least, each) = self.memory;
        let most = least + each * bytes.len();
        let before = memory::reset();
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.decode)(bytes)));
        let (peak, time) = (memory::peak().saturating_sub(before), start.elapsed());
        let problem = match outcome {
            Err(_) => "it panicked".to_owned(),
            Ok(()) if peak > most => format!("{peak} bytes of memory, {most} are allowed"),
            Ok(()) if time > SLOW => format!("{:.1} s", time.as_secs_f64()),
            Ok(()) => return,
        };
        let kept = keep(self.name, bytes);
        panic!(
            "{}, {what} ({} bytes): {problem}; the input is in {}",
            self.name,
            bytes.len(),
            kept.display()
        );
    }
}

fn keep(name: &str, bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("fuzzing-{name}-{}", std::process::id()));
    // The message names the file; if it cannot be written, the number of the input reproduces it.
    let _ = std::fs::write(&path, bytes);
    path
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    files.sort();
    files
}
