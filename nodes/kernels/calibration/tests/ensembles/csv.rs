//! Stored measurements, written by `grainlab analyze` and the ensemble script.

use grainlab_calibration::CalibrationSample;
use grainlab_core::Material;
use grainlab_core::results::StrainRatios;
use grainlab_emt::{Conditions, Measured, Moduli, Observation, Probe, StrainRatio, StrainRatioSource};
use grainlab_testkit::golden::Table;

/// The packings of one ensemble; the path is the recipe.
pub(crate) fn samples(name: &str) -> Vec<CalibrationSample> {
    let t = Table::read(&format!("ensembles/{name}"));
    let sample = |row: &Vec<String>| {
        let number = |column| t.number(row, column);
        // Without these columns: isotropic stress, equal grains.
        let optional = |column| if t.has(column) { t.number(row, column) } else { 0.0 };
        let preparation = t.cell(row, "preparation").to_owned();
        let moduli = ["g12_pa", "g13_pa", "theta_pa", "ti_c11_pa", "ti_c33_pa", "ti_c13_pa"];
        CalibrationSample {
            packing: format!("{preparation} {} {}", t.cell(row, "mu2"), t.cell(row, "seed")),
            preparation,
            file: name.to_owned(),
            place: name.to_owned(),
            grains: number("grains") as u32,
            material: Material {
                shear_modulus: number("grain_shear_modulus_pa"),
                poisson_ratio: number("poisson"),
                ..Material::GLASS
            },
            pressure: number("pressure_pa"),
            solid_fraction: number("phi"),
            stress_ratio: optional("axial_q_over_p"),
            size_spread: optional("size_spread"),
            moduli: Moduli::of_values(moduli.map(|m| Some(number(m)))),
            gamma: StrainRatios {
                total: t.cell(row, "g_total").parse().ok(),
                elastic: t.cell(row, "g_elastic").parse().ok(),
                contact: t.cell(row, "g_contact").parse().ok(),
            },
            k: number("k"),
            z: number("z"),
            eps: number("eps"),
            eps_stiffness: number("eps_stiffness"),
        }
    };
    t.rows.iter().map(sample).collect()
}

/// The packings of other recipes that taught the calibration.
pub(crate) fn others() -> Vec<CalibrationSample> {
    ["wide.csv", "recipes.csv"].map(samples).concat()
}

/// The states of the paper's Table III, each with the ε counted in its simulation.
pub(crate) fn paper_rows() -> Vec<(Observation, f64)> {
    let t = Table::read("paper_rows.csv");
    let row = |row: &Vec<String>| {
        let n = |column| t.number(row, column);
        let g = StrainRatio::given(n("gamma_over_delta"));
        let o = Observation::from_g12_g13_theta(n("g12_pa"), n("g13_pa"), n("theta_pa"), 1e3 * n("p_kpa"), g);
        (o, n("eps"))
    };
    t.rows.iter().map(row).collect()
}

/// A measurement with the k, z, ε and ε weighted by stiffness that were counted; NaN if one was not.
pub(crate) struct Counted {
    pub(crate) observation: Observation,
    pub(crate) k: f64,
    pub(crate) z: f64,
    pub(crate) eps: f64,
    pub(crate) eps_stiffness: f64,
}

impl Counted {
    pub(crate) fn of(sample: &CalibrationSample) -> Self {
        let CalibrationSample { k, z, eps, eps_stiffness, .. } = *sample;
        Self { observation: sample.observation(StrainRatioSource::Zero), k, z, eps, eps_stiffness }
    }
}

/// Returns the states of the paper's Table III with everything that is known of them. Its k is compared with both k and z, because the
/// paper does not say whether it counts rattlers.
pub(crate) fn paper_counted(probe: Probe) -> Vec<Counted> {
    let t = Table::read("paper_rows.csv");
    let known = |(row, (mut observation, eps)): (&Vec<String>, (Observation, f64))| {
        observation.conditions.solid_fraction = Some(Measured::exact(t.number(row, "phi")));
        observation.conditions.stress_ratio = Some(Measured::exact(0.0));
        observation.conditions.size_spread = Some(0.0);
        observation.conditions.material = Some(Material::GLASS);
        (observation.grains, observation.probe) = (Some(2000), probe);
        let k = t.number(row, "k");
        Counted { observation, k, z: k, eps, eps_stiffness: f64::NAN }
    };
    t.rows.iter().zip(paper_rows()).map(known).collect()
}

/// Returns the packings that LAMMPS made, probed and counted, of the rows that `keep` chooses by contact law, friction of the probe and
/// share of the mean overlap.
pub(crate) fn lammps(probe: Probe, keep: impl Fn(&str, f64, f64) -> bool) -> Vec<Counted> {
    let t = Table::read("lammps/moduli.csv");
    let is_kept = |row: &&Vec<String>| {
        keep(t.cell(row, "law"), t.number(row, "strain_friction"), t.number(row, "share"))
    };
    let counted = |row: &Vec<String>| {
        let n = |column| t.number(row, column);
        let moduli = ["g12_pa", "g13_pa", "theta_pa", "ti_c11_pa", "ti_c33_pa", "ti_c13_pa"];
        let conditions = Conditions {
            solid_fraction: Some(Measured::exact(n("phi"))),
            stress_ratio: Some(Measured::exact(n("axial_q_over_p"))),
            size_spread: Some(n("size_spread")),
            material: Some(Material {
                shear_modulus: n("grain_shear_modulus_pa"),
                poisson_ratio: n("poisson"),
                ..Material::GLASS
            }),
            ..Conditions::at(n("pressure_pa"))
        };
        let grains = Some(n("grains") as u32);
        let observation = Observation::new(Moduli::of_values(moduli.map(|m| Some(n(m)))), conditions);
        let observation = Observation { grains, probe, ..observation };
        Counted { observation, k: n("k"), z: n("z"), eps: n("eps"), eps_stiffness: f64::NAN }
    };
    t.rows.iter().filter(is_kept).map(counted).collect()
}
