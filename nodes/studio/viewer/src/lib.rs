//! Packings as pictures: a page that shows them in three dimensions, and PNG without a display.
//!
//! - [`View`]: one packing as it is drawn; [`Quantity`]: what the colours show; `palette`: the colours
//! - [`Film`]: the states of a run, few enough for a page
//! - [`figure`], [`page`], [`STYLE`], [`SCRIPTS`]: the parts of a page; [`empty_figure`], [`states`]: those of a page that
//!   receives packings later; `encode`: the states as bytes
//! - [`Picture`]: one view as pixels and as PNG, on a [`Ground`]; `section`: cuts and force chains; `raster`: samples and edges; `light`: shades; `legend`,
//!   `marks`: colours, scale bar and axes; `canvas`, `lettering`: pixels and letters

mod canvas;
mod encode;
mod film;
mod legend;
mod lettering;
mod light;
mod marks;
mod page;
mod palette;
mod picture;
mod raster;
mod section;
mod view;

pub use canvas::Ground;
pub use film::Film;
pub use page::{SCRIPTS, STYLE, empty_figure, figure, page, states};
pub use palette::Quantity;
pub use picture::{Parts, Picture, PictureError, Size};
pub use section::{Slice, SliceError};
pub use view::View;
