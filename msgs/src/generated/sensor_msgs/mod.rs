//! Messages of `sensor_msgs`.

mod compressed_image;
mod point_cloud2;
mod point_field;

pub use compressed_image::CompressedImage;
pub use point_cloud2::PointCloud2;
pub use point_field::PointField;
