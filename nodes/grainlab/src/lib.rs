//! Packings of elastic spheres: simulated, measured, and their microstructure inferred from their stiffness. One process,
//! without DDS; the laboratory of processes is the command `grainlab`.
//!
//! From a gas to the inferred microstructure:
//!
//! ```
//! use grainlab::{InferredQuantity, Observation, invert, measure, simulate};
//!
//! # fn main() -> Result<(), grainlab::Error> {
//! let packing = simulate("demo", &["grains.count=200", "seed=2"])?.last().expect("the last packing is published")?;
//! let report = measure(&packing)?;
//! println!("{} contacts at {:.0} Pa", packing.contacts.len(), report.pressure());
//! report.notes.iter().for_each(|doubt| eprintln!("{doubt}"));
//!
//! let observation = Observation::of(&report).expect("a jammed packing").with_relative_error(0.01);
//! let estimate = invert(&observation)?;
//! for q in InferredQuantity::countable() {
//!     println!("{}: inferred {:?}, counted {:?}", q.symbol(), estimate.values[q], report.counted(q));
//! }
//! # Ok(())
//! # }
//! ```
//!
//! A recording by `grainlab launch`, or a packing by another program:
//!
//! ```no_run
//! # fn main() -> Result<(), grainlab::Error> {
//! for packing in grainlab::open("recordings/runs/demo-1-1")?.packings()? {
//!     println!("step {}", packing?.step);
//! }
//! let from_lammps = grainlab::load("dump.lammpstrj", &Default::default())?.packings;
//! # Ok(())
//! # }
//! ```
//!
//! SI units; stress is positive in compression. Everything else, such as settings of the measurement, other models and
//! priors, is in the crates of the kernels: `grainlab_micromechanics`, `grainlab_emt`, `grainlab_dem`.

mod error;
mod measure;
mod recording;
mod simulation;
mod state;

pub use error::Error;
pub use grainlab_core::contact::ContactLaw;
pub use grainlab_core::notes::{Note, Status};
pub use grainlab_core::results::{Estimate, InferredQuantity, Microstructure, PackingReport};
pub use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Stiffness, Vec3};
pub use grainlab_emt::{Conditions, Measured, Moduli, Observation, StrainRatio};
pub use grainlab_recordings::import::ImportOptions;
pub use measure::{Measurement, measure};
pub use recording::{Loaded, Recording, load, open};
pub use simulation::{Simulation, resume, simulate};
pub use state::State;

/// The microstructure of a packing by the recommended model, `relaxed`, with its calibration.
///
/// # Errors
/// If the data lack something that the model needs, or no packing can have them.
pub fn invert(observation: &Observation) -> Result<Estimate, Error> {
    let model = grainlab_emt::model("relaxed").expect("the recommended model exists");
    let inversion = model.infer(observation, model.default_calibration());
    inversion.map(|found| found.estimate()).map_err(|e| Error::Inversion(e.to_string()))
}
