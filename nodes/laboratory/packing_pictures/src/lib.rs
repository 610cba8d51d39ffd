//! A node that publishes pictures of packings for viewers, while somebody subscribes to them.
//!
//! [`PackingPictures`] is the node. It has no parameters.

mod node;

pub use node::PackingPictures;
