//! Messages of `std_msgs`.

mod color_rgba;
mod header;

pub use color_rgba::ColorRGBA;
pub use header::Header;
