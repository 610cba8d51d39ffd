//! A page that shows packings in three dimensions.
//!
//! - [`View`]: one packing as it is drawn
//! - [`Film`]: the states of a run, few enough for a page
//! - [`figure`], [`page`], [`STYLE`], [`SCRIPTS`]: the parts of a page; [`empty_figure`], [`states`]: those of a page that
//!   receives packings later; `encode`: the states as bytes

mod encode;
mod film;
mod page;
mod view;

pub use film::Film;
pub use page::{SCRIPTS, STYLE, empty_figure, figure, page, states};
pub use view::View;
