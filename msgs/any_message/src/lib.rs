//! Messages of any ROS 2 type: a schema as text (`ros2msg`), and CDR decoded by it.
//!
//! - [`Schema`]: the types of a schema text, as MCAP files contain it
//! - [`Schema::decode`]: bytes to a [`Message`], a tree of [`Value`]s
//! - [`Schema::compare`]: a definition compared with the one that is wanted, and [`Mapping`]: messages of the one as those of the other
//! - [`Schema::given`]: values that a user writes to a [`Message`], and [`Message::encode`]: values to bytes
//! - [`Shown`]: a message as JSON, or as the text of `ros2 topic echo`
//!
//! Bytes are CDR (XCDR1) of either byte order, with their encapsulation header. No bytes and no schema cause a panic; memory
//! is bounded (see [`Schema::decode`]).
//!
//! ```
//! use grainlab_any_message::{Schema, Shown};
//! let schema = Schema::parse("demo_msgs/msg/Point", "float64 x  # m\nuint8[<=3] tags\n")?;
//! let bytes = [0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f, 2, 0, 0, 0, 7, 9];
//! let message = schema.decode(&bytes)?;
//! assert_eq!(Shown::new(&message).json(), r#"{"x":1.5,"tags":[7,9]}"#);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cursor;
mod decode;
mod encode;
mod given;
mod lines;
mod literals;
mod mapping;
mod names;
mod schema;
mod shown;
mod types;
mod value;

pub use decode::DecodeError;
pub use mapping::{Comparison, Mapping};
pub use schema::{Schema, SchemaError};
pub use shown::Shown;
pub use types::{Constant, Element, Field, FieldType, Length, MessageType, Primitive};
pub use value::{Array, Message, Value};
