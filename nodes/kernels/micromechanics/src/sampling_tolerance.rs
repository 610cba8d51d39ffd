//! The scatter of the stiffness of one packing.

/// Residual of an isotropic preparation, times the root of the number of grains.
const SCATTER: f64 = 1.1;

/// A stiffness with a larger residual is not of the class, however few the grains.
const LARGEST: f64 = 0.05;

/// Relative residual (Mandel norm) up to which the stiffness of a packing of `grains` grains counts as that
/// of a symmetry class, for [`grainlab_core::symmetry()`]: 1.1/√grains, at most 5 %.
///
/// Residuals of 60 packings prepared isotropically (500 grains, μ = .1, z 5.3, 50 kPa): that of the isotropic class times √500
/// had a median of .89 and exceeded 1.07 in one of ten; that of the transversely isotropic one had .59. Of 24 with 2,000
/// grains, times √2000: .90, 1.01 and .59.
/// `cargo run --release -p grainlab_experiment --example fabric_noise nodes/scenes/demo.toml 1-60
/// gas,rest,load,settle` repeats it. A network closer to isostaticity scatters more. A lattice of few grains
/// does not scatter, hence the bound.
pub fn sampling_tolerance(grains: u32) -> f64 {
    (SCATTER / f64::from(grains.max(1)).sqrt()).min(LARGEST)
}
