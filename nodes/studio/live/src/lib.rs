//! `grainlab view --live`: a page that follows a running laboratory.
//!
//! - [`run`]: joins the bus, serves the page, follows one run after the other; [`Options`]: what it needs
//! - `domain`: where to look for a run; `follower`: subscriptions; [`Laboratory`]: what is known of a run
//! - `markup`, `status`: a laboratory as parts of the page; `snapshot`: the parts that browsers receive; `page`: what stays
//! - [`Server`]: HTTP and server-sent events on the loopback interface; `connections`: the open connections
//!
//! It belongs to no run, and nothing waits for it: `/stress` is read as the samples on `/stress_sampled`, packings and results
//! as latched topics keep them. A browser that reads slowly receives fewer snapshots; none are queued for it.

mod connections;
mod domain;
mod follower;
mod laboratory;
mod live;
mod markup;
mod page;
mod server;
mod snapshot;
mod status;

pub use laboratory::Laboratory;
pub use live::{Options, run};
pub use page::page;
pub use server::{DEFAULT_PORT, Server};
pub use snapshot::{Pictures, Snapshot};
