//! Packings as the standard messages that viewers draw without a plugin: RViz, Foxglove, Lichtblick, Rerun.
//!
//! - [`Drawn`]: a packing as it is drawn, with the grains folded into the cell; [`DrawnContact`]
//! - [`points`]: `sensor_msgs/PointCloud2`, one point a grain
//! - [`markers`]: `visualization_msgs/MarkerArray`: grains as spheres, contacts as lines, the edges of the cell
//! - [`Picture`]: either of them by name, as bytes; [`packing`]: a packing from bytes
//! - [`RAMP`], [`ramp`], [`by_coordination`]: colours, distinct under colour blindness
//!
//! Both messages have the stamp and the frame of the packing, `cell`. They are functions of the packing alone.

mod colours;
mod drawn;
mod markers;
mod picture;
mod points;

pub use colours::{Colour, MOST_CONTACTS, RAMP, RATTLER, by_coordination, ramp};
pub use drawn::{Drawn, DrawnContact};
pub use markers::markers;
pub use picture::{Picture, packing};
pub use points::points;
