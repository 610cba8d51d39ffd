//! The machine of the measurement.

use super::peak::peak;
use grainlab_console::Failure;
use grainlab_dem::Simd;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Properties of the machine that affect the timings.
#[derive(Debug, Serialize)]
pub(crate) struct Machine {
    pub(crate) processor: String,
    pub(crate) cores: usize,
    /// Over one minute, at the start: above zero other processes were running.
    pub(crate) load_average: Option<f64>,
    pub(crate) simd_available: Vec<String>,
    /// Independent additions and multiplications of one core per second, without fused ones, which the
    /// contact law does not use; measured in this run.
    pub(crate) peak_operations_per_second: BTreeMap<String, f64>,
}

impl Machine {
    /// Queries the system, and measures the peak of each instruction set.
    pub(crate) fn measured(sets: &[Simd]) -> Result<Self, Failure> {
        let mut peak_operations_per_second = BTreeMap::new();
        for set in sets {
            peak_operations_per_second.insert(set.to_string(), peak(*set)?);
        }
        let load = read("/proc/loadavg").and_then(|t| t.split_whitespace().next()?.parse().ok());
        Ok(Self {
            processor: processor(&read("/proc/cpuinfo").unwrap_or_default()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            load_average: load,
            simd_available: Simd::available().iter().map(Simd::to_string).collect(),
            peak_operations_per_second,
        })
    }

    /// Operations per second of one core with this instruction set, if measured.
    pub(crate) fn peak(&self, set: Simd) -> Option<f64> {
        self.peak_operations_per_second.get(&set.to_string()).copied()
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} cores", self.processor, self.cores)?;
        if let Some(load) = self.load_average {
            write!(f, ", load average {load}")?;
        }
        for (set, operations) in &self.peak_operations_per_second {
            write!(f, "; peak {set} {:.1} G operations/s a core", operations * 1e-9)?;
        }
        writeln!(f)
    }
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

fn processor(cpuinfo: &str) -> String {
    let model = cpuinfo.lines().find(|l| l.starts_with("model name"));
    model.and_then(|l| Some(l.split_once(':')?.1.trim().to_owned())).unwrap_or_else(|| "unknown".to_owned())
}

/// Memory of this process in use, bytes; `None` where the system does not report it.
pub(crate) fn resident_bytes() -> Option<f64> {
    #[cfg(target_env = "gnu")]
    // SAFETY: no pointers are involved; only free memory is returned to the system.
    unsafe {
        libc::malloc_trim(0);
    }
    // Counted page by page; statm omits memory that a core has not reported yet.
    let rollup = read("/proc/self/smaps_rollup")?;
    let line = rollup.lines().find(|l| l.starts_with("Rss:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_named_by_its_first_model_line() {
        assert_eq!(processor("processor : 0\nmodel name\t: Fast 9000\nmodel name\t: other\n"), "Fast 9000");
        assert_eq!(processor(""), "unknown");
    }

    #[test]
    fn memory_that_is_touched_shows() {
        let Some(before) = resident_bytes() else { return };
        let block = std::hint::black_box(vec![1u8; 64 << 20]);
        let after = resident_bytes().unwrap();
        assert!(after - before > (32 << 20) as f64, "{before} {after} {}", block.len());
    }
}
