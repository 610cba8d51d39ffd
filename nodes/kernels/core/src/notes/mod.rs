//! Notes on results: limitations, contradictions, and why there is no result.
//!
//! - `table`: every note of this program: code, status, names, numbers, sentence
//! - `note`: one [`Note`], and the [`Status`] that notes give an estimate
//! - `shown`: numbers in sentences, and their ranges where several notes are alike
//!
//! To add a note, write its row in the table. Messages, JSON, pages and findings follow from the row.

mod note;
mod shown;
mod table;

pub use note::{Note, Status, texts};
pub use table::Code;
