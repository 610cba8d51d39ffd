//! The inversion of a series: wave speeds of one sample over pressure, with a contact law that is not known.
//!
//! Unknown at each pressure: z, and ε where the speeds have directions. Unknown for the sample: the contact law with its
//! crossover, k_t/k_n, the level of the moduli, the preparation, and the noise. A prior of the contact and of z over pressure, from
//! simulated preparations, makes z identifiable: K/G under one k_t/k_n determines it, and the level of the moduli determines the
//! contact.
//!
//! - `sample`: the speeds; `prior`: what is known before them; `gain`: contact laws by their stiffness over pressure
//! - `forward`: speeds and their slopes; `corrections`: contacts that the laws were not learned from; `component`: a normal approximation of the posterior for each cell of the prior;
//!   `draws`: their correction by importance sampling
//! - `plan`: experiments before they are made
//! - `check`: pressures and rows left out, contradictions; `estimate`: what is stated; `single`: of one pressure, for the model
//!   `free-contact`
//! - `doubted`: z without rows that the others contradict; `sensitivity`: z under other assumptions

mod check;
mod component;
mod corrections;
mod doubted;
mod draws;
mod estimate;
mod forward;
mod gain;
mod plan;
mod prior;
mod sample;
mod sensitivity;
mod single;
#[cfg(test)]
mod tests;

pub use check::LeftOut;
pub use corrections::ContactCorrections;
pub use doubted::Doubted;
pub use estimate::{Interval, LawEstimate, PressureEstimate, RowEstimate, SeriesEstimate, infer_series};
pub use forward::{OTHER_CONTACTS, SCATTER_TREND};
pub use gain::ContactKind;
pub use plan::{SampleQuantity, series_stddev, simulate_series};
pub use prior::{ContactPrior, PreparationPrior, SeriesPrior};
pub use sample::{SeriesRow, SpeedMode, SpeedSeries};
pub use sensitivity::Sensitivity;
pub(crate) use single::SingleEstimate;
