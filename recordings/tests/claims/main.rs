//! Claims about recordings, tested on whole files.

mod damage;
mod support;
mod write_and_read;
