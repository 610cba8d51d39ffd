//! Common to every process: its terminal, its signals, the end of a command.
//!
//! - [`Failure`], [`worse`]: the end of a command
//! - [`Format`], [`Table`], [`print()`], [`say!`]: its output
//! - [`write_whole`], [`replace_whole`], [`has_name_of`]: files that are written whole or not at all, and their names
//! - [`append_to`], [`append_in`]: files that grow, of directories that grainlab keeps
//! - [`input`]: external files, regular and of bounded size; [`refuse_input`]: no output replaces one of them
//! - [`separated`]: tables with commas, semicolons or tabs; [`memory`]: whether this machine has enough of it, and settings of the allocator
//! - [`escape_controls`], [`escape_name`]: text from outside, which a terminal must not obey
//! - [`Cell`]: a typed value of a table
//! - [`program()`]: the words that start this program again
//! - [`wrapped()`]: text in lines of a terminal; [`count()`]: counts with their noun; [`duration()`]: times; [`Pace`]: rates and the time left
//! - [`Terminal`]: its width and colours, and a line that is drawn again; [`Signals`]: SIGINT, SIGTERM and SIGHUP

mod cell;
mod count;
mod duration;
mod escape;
mod failure;
pub mod input;
pub mod memory;
mod output;
mod pace;
mod program;
pub mod separated;
mod signals;
mod terminal;
mod whole_file;
mod wrap;

pub use cell::Cell;
pub use count::{and, count};
pub use duration::duration;
pub use escape::{escape_controls, escape_name};
pub use failure::{Failure, worse};
pub use output::{
    CsvText, Format, Output, Table, decimals_of, exact, fixed, json, json_element, print, print_more,
    say_line, three_digits,
};
pub use pace::Pace;
pub use program::{called, program, set_program};
pub use signals::Signals;
pub use terminal::{Terminal, colour_wanted, draw_live_line, erase_live_line, write_above_live_line};
pub use whole_file::{append_in, append_to, has_name_of, refuse_input, replace_whole, write_whole};
pub use wrap::{COLUMNS, wrapped};
