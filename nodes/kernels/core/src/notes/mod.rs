//! Notes on results: limitations, contradictions, and why there is no result.
//!
//! - `table`: every note of this program: code, status, names, numbers, sentence
//! - `code`: the [`Code`] of a note, and its sentence; `note`: a [`Note`] with its names and numbers
//! - `status`: the [`Status`] that notes give an estimate
//! - `shown`: numbers in sentences, and their ranges where several notes are alike
//!
//! To add a note, write its row in the table. Messages, JSON, pages and findings follow from the row.

mod code;
mod note;
mod shown;
mod status;
mod table;

pub use code::Code;
pub use note::{Note, texts};
pub use status::Status;
