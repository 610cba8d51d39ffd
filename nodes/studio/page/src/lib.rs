//! What pages and files of results share: plots, elements of HTML, tables of typed columns.
//!
//! - [`plot`]: plots as SVG and as text
//! - [`html`]: elements of HTML pages
//! - [`Dataset`]: typed columns, as CSV and Parquet

mod dataset;
pub mod html;
pub mod plot;

pub use dataset::Dataset;
