//! Messages of `geometry_msgs`.

mod point;
mod pose;
mod quaternion;
mod transform;
mod transform_stamped;
mod vector3;

pub use point::Point;
pub use pose::Pose;
pub use quaternion::Quaternion;
pub use transform::Transform;
pub use transform_stamped::TransformStamped;
pub use vector3::Vector3;
