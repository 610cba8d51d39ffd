//! Common parts of pages and files of results: plots, elements of HTML, tables of typed columns.
//!
//! - [`Page`]: the frame of a page, with its [`Section`]s
//! - [`Html`], [`html!`]: markup, from texts and templates; [`table`], [`figure`], [`card`] and others: elements of pages
//! - [`fixed`], [`signed`], [`six_digits`]: numbers for readers
//! - [`plot`]: plots as SVG
//! - [`Dataset`]: typed columns, as CSV; [`Mean`]: a mean with its standard error; [`median`]

#[macro_use]
mod markup;

mod dataset;
mod elements;
mod mean;
mod page;
pub mod plot;

pub use dataset::Dataset;
pub use elements::{
    Cell, card, code, csv, data, details, figure, finding, fixed, grid, heading, lines, list, paragraph,
    plus_minus, signed, six_digits, slug, table, three_digits, verdict, with_unit,
};
pub use markup::Html;
#[doc(hidden)]
pub use markup::rendered;
pub use mean::{Mean, median};
#[doc(hidden)]
pub use minijinja;
pub use page::{Page, Section};
