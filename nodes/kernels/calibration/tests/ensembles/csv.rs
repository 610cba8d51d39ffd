//! Stored measurements, written by `grainlab analyze` and the ensemble script.

use grainlab_calibration::CalibrationSample;
use grainlab_core::Material;
use grainlab_core::results::StrainRatios;
use grainlab_emt::{Measured, Moduli, Observation, StrainRatio};
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

/// The states of the paper's Table III with everything that is known of them, and the k and ε counted in its simulation.
pub(crate) fn paper_rows_known() -> Vec<(Observation, f64, f64)> {
    let t = Table::read("paper_rows.csv");
    let known = |(row, (mut o, eps)): (&Vec<String>, (Observation, f64))| {
        o.conditions.solid_fraction = Some(Measured::exact(t.number(row, "phi")));
        o.conditions.stress_ratio = Some(Measured::exact(0.0));
        o.conditions.size_spread = Some(0.0);
        o.conditions.material = Some(Material::GLASS);
        o.grains = Some(2000);
        (o, t.number(row, "k"), eps)
    };
    t.rows.iter().zip(paper_rows()).map(known).collect()
}
