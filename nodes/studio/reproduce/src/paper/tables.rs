//! Tables I, II and III of La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012), as printed.

/// Number of samples.
pub const SAMPLES: usize = 4;

/// Number of pressures.
pub const PRESSURES: usize = 4;

/// The pressures, Pa.
pub const PRESSURE: [f64; PRESSURES] = [50e3, 100e3, 250e3, 500e3];

/// Solid fraction of the reference state of the strains.
pub const REFERENCE_SOLID_FRACTION: f64 = 0.607;

/// One sample: a row of Table I, a row of Table II, four rows of Table III.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Name of the table.
    pub name: &'static str,
    /// Friction coefficient of the cycles and of the compression, mu2.
    pub mu2: f64,
    /// Diagonal of the fabric tensor at 50 kPa (Table I).
    pub fabric: [f64; 3],
    /// Solid fraction at 50 kPa (Table I).
    pub solid_fraction: f64,
    /// γ/Δ at each pressure (Table II).
    pub gamma_over_delta: [f64; PRESSURES],
    /// Coordination number and anisotropy at each pressure, simulated and inferred (Table III).
    pub states: [State; PRESSURES],
}

/// A row of Table III.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// k of the simulation.
    pub k_sim: f64,
    /// k by the effective medium theory.
    pub k_emt: f64,
    /// k by the ratios of moduli.
    pub k_ratio: f64,
    /// k̂, that of the equivalent isotropic packing.
    pub k_hat: f64,
    /// ε of the simulation.
    pub eps_sim: f64,
    /// ε by the ratios of moduli.
    pub eps_ratio: f64,
}

const fn state(k_sim: f64, k_emt: f64, k_ratio: f64, k_hat: f64, eps_sim: f64, eps_ratio: f64) -> State {
    State { k_sim, k_emt, k_ratio, k_hat, eps_sim, eps_ratio }
}

/// The samples, in the order of their names.
pub const PAPER: [Sample; SAMPLES] = [
    Sample {
        name: "S1",
        mu2: 0.05,
        fabric: [0.33, 0.329, 0.341],
        solid_fraction: 0.636,
        gamma_over_delta: [-0.0623, -0.0603, -0.0577, -0.0545],
        states: [
            state(5.58, 0.31, 5.73, 5.63, 0.03, 0.016),
            state(5.65, 0.41, 5.78, 5.77, 0.03, 0.012),
            state(5.74, 0.58, 5.89, 5.87, 0.03, 0.025),
            state(5.84, 0.75, 6.0, 5.94, 0.029, 0.039),
        ],
    },
    Sample {
        name: "S2",
        mu2: 0.1,
        fabric: [0.328, 0.326, 0.346],
        solid_fraction: 0.636,
        gamma_over_delta: [-0.073, -0.0711, -0.0678, -0.0643],
        states: [
            state(5.27, 0.27, 5.44, 5.31, 0.046, 0.031),
            state(5.37, 0.36, 5.55, 5.44, 0.051, 0.039),
            state(5.48, 0.52, 5.68, 5.58, 0.05, 0.047),
            state(5.59, 0.69, 5.79, 5.73, 0.048, 0.044),
        ],
    },
    Sample {
        name: "S3",
        mu2: 0.3,
        fabric: [0.321, 0.323, 0.356],
        solid_fraction: 0.636,
        gamma_over_delta: [-0.0759, -0.0745, -0.0719, -0.0691],
        states: [
            state(4.87, 0.18, 4.92, 4.49, 0.084, 0.171),
            state(4.98, 0.26, 5.11, 4.73, 0.08, 0.168),
            state(5.11, 0.41, 5.31, 4.99, 0.08, 0.154),
            state(5.25, 0.56, 5.47, 5.22, 0.077, 0.12),
        ],
    },
    Sample {
        name: "S4",
        mu2: 0.15,
        fabric: [0.324, 0.323, 0.353],
        solid_fraction: 0.636,
        gamma_over_delta: [-0.0763, -0.075, -0.0724, -0.0695],
        states: [
            state(4.96, 0.19, 5.03, 4.63, 0.072, 0.153),
            state(5.05, 0.28, 5.21, 4.87, 0.076, 0.142),
            state(5.19, 0.43, 5.37, 5.19, 0.071, 0.094),
            state(5.31, 0.59, 5.56, 5.31, 0.073, 0.112),
        ],
    },
];
