//! Finds contacts from positions, in time and memory proportional to the number of grains, for any shape of
//! the cell.

mod doubts;
mod error;
mod find;
mod grid;

pub use doubts::doubts;
pub use error::SearchError;
pub use find::{find, of_packing};
