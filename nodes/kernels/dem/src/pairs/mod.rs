//! Pairs of grains: from neighbours to the blocks that the force kernel works on.
//!
//! - `neighbours`, `grid`: all pairs within the Verlet skin, and the bins to find them
//! - `contacts`: pairs that touch or soon may, with their history
//! - `subdomain_pairs`: the pairs of one thread
//! - `types`, `images`: blocks of pairs, and the periodic images they reach to
//! - `displacement_bound`: how long a list of pairs stays valid

pub(crate) mod contacts;
pub(crate) mod displacement_bound;
mod grid;
pub(crate) mod images;
pub(crate) mod neighbours;
pub(crate) mod subdomain_pairs;
pub(crate) mod types;
