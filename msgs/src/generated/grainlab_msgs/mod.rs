//! Messages of `grainlab_msgs`.

mod estimate;
mod fabric;
mod microstructure;
mod moduli;
mod packing;
mod packing_chunk;
mod packing_credit;
mod run_state;
mod strain_rate;
mod stress;
mod symmetric_tensor;
mod wave_speed;
mod wave_speeds;
mod waveform;

pub use estimate::Estimate;
pub use fabric::Fabric;
pub use microstructure::Microstructure;
pub use moduli::Moduli;
pub use packing::Packing;
pub use packing_chunk::PackingChunk;
pub use packing_credit::PackingCredit;
pub use run_state::RunState;
pub use strain_rate::StrainRate;
pub use stress::Stress;
pub use symmetric_tensor::SymmetricTensor;
pub use wave_speed::WaveSpeed;
pub use wave_speeds::WaveSpeeds;
pub use waveform::Waveform;
