//! Common to every process: its terminal, its signals, the end of a command.
//!
//! - [`Failure`], [`worse`]: the end of a command
//! - [`Format`], [`Table`], [`print()`], [`say!`]: its output
//! - [`write_whole`], [`has_name_of`]: files that are written whole or not at all, and their names
//! - [`Cell`]: a typed value of a table
//! - [`program()`]: the words that start this program again
//! - [`wrapped()`]: text in lines of a terminal; [`count()`]: counts with their noun; [`duration()`]: times; [`Pace`]: rates and the time left
//! - [`Terminal`]: its width and colours, and a line that is drawn again; [`Signals`]: SIGINT, SIGTERM and SIGHUP

mod cell;
mod count;
mod duration;
mod failure;
mod output;
mod pace;
mod program;
mod signals;
mod terminal;
mod whole_file;
mod wrap;

pub use cell::Cell;
pub use count::{and, count};
pub use duration::duration;
pub use failure::{Failure, worse};
pub use output::{CsvText, Format, Table, exact, fixed, json, json_element, print, print_more, say_line};
pub use pace::Pace;
pub use program::{called, program, set_program};
pub use signals::Signals;
pub use terminal::{Terminal, colour_wanted, draw_live_line, erase_live_line, write_above_live_line};
pub use whole_file::{has_name_of, write_whole};
pub use wrap::{COLUMNS, wrapped};
