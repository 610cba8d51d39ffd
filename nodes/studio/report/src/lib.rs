//! Reports of runs: one HTML page for a run, with plots and its packings in three dimensions, and one for many runs.
//!
//! - [`Run`]: what a report is made of, from the files of a run; `timeline`, `phased`, `decimated`: against time, in one pass
//!   over the recording; `summary_file`: how the run ended
//! - `page`: the page of a run; `against_time`, `structure`, `moduli`, `inferred`, `waves`, `energy`, `health`: its sections
//! - [`overview`]: the page of many runs; `numbers`: the columns of its table; `outliers`: values far from those of runs alike;
//!   `settings`, `over_settings`: in which settings they differ, and their quantities over these
//! - [`Timeline`], [`curves`], [`STYLE`], [`SCRIPT`]: what the page of a running laboratory has in common with a report
//! - [`series_page`]: the page of the wave speeds of a sample over pressure
//! - [`write_report`]: the file

mod against_time;
mod decimated;
mod energy;
mod health;
mod inferred;
mod many;
mod moduli;
mod numbers;
mod outliers;
mod over_settings;
mod page;
mod phased;
mod run;
mod series;
mod settings;
mod stress_path;
mod structure;
mod summary_file;
mod timeline;
mod waves;
mod write;

pub use against_time::curves;
pub use many::overview;
pub use page::{SCRIPT, STYLE};
pub use run::Run;
pub use series::{InferredSample, series_page};
pub use timeline::{Timeline, view};
pub use write::{FILE, ReportError, default_page, write_report};
