//! Packings with contacts other than those of the calibration: the corrections of the laws, and the preparations of the prior.

use crate::{csv, ours};
use grainlab_core::Material;
use grainlab_emt::{
    ContactCorrections, ContactKind, Invariants, Moduli, NetworkState, OTHER_CONTACTS, RelaxationCalibration,
    Scatter, ScatterLevels, SeriesPrior,
};
use grainlab_testkit::golden::Table;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// One packing under one contact law.
struct Network {
    preparation: String,
    member: u32,
    step: u64,
    law: String,
    /// d ln k_n/d ln F of the mean stiffness.
    exponent: f64,
    state: NetworkState,
    z: f64,
    /// S_q, m, and ln of the pressure in Pa and of the shear modulus.
    roughness: f64,
    ln_pressure: f64,
    ln_shear: f64,
    /// ln of the bulk and of the shear modulus less the law of `relaxed`, those of the mean contact stiffness left out.
    residual: [f64; 2],
}

impl Network {
    /// Weight of a residual: the scatter of packings grows towards the isostatic point.
    fn weight(&self) -> f64 {
        (self.z - 4.0) / self.z
    }
}

fn networks() -> Vec<Network> {
    let t = Table::read("ensembles/contacts.csv");
    let laws = ours().network().unwrap();
    let one = |row: &Vec<String>| {
        let n = |column| t.number(row, column);
        let moduli = ["g12_pa", "g13_pa", "theta_pa", "ti_c11_pa", "ti_c33_pa", "ti_c13_pa"];
        let found = Invariants::of(&Moduli::of_values(moduli.map(|m| Some(n(m))))).unwrap();
        let grains = n("grain_shear_modulus_pa");
        let material = Material { shear_modulus: grains, poisson_ratio: n("poisson"), ..Material::GLASS };
        let (pressure, z) = (n("pressure_pa"), n("z"));
        let mindlin = NetworkState::of(pressure, &material, n("size_spread"), 0.0);
        let kappa = mindlin.stiffness_ratio + n("stiffness_ratio") - material.stiffness_ratio();
        let state = NetworkState { stiffness_ratio: kappa, ..mindlin };
        let law = t.cell(row, "law").to_owned();
        // The radius is 0.1 mm.
        let [gain, slope] = match (law.as_str(), n("roughness")) {
            ("rough", roughness) if roughness > 0.0 => {
                let crossover = ContactKind::crossover(roughness / 2e-4, &material, n("phi"));
                ContactKind::Rough.gain((pressure / crossover).ln(), z)
            }
            ("linear", _) => [0.0, -1.0 / 3.0],
            _ => [0.0; 2],
        };
        let unit = 2.0 / 3.0 * material.effective_young().ln() + pressure.ln() / 3.0 + gain;
        let off = |ln: f64, law: f64| ln - law - unit;
        let residual = [
            off(found.ln_theta, laws.theta.value(z, &state)),
            off(found.ln_shear, laws.shear.value(z, &state)),
        ];
        let preparation = t.cell(row, "preparation").to_owned();
        let (member, step) = (n("member") as u32, n("step") as u64);
        Network {
            preparation,
            member,
            step,
            law,
            exponent: 1.0 / 3.0 + slope,
            state,
            z,
            roughness: n("roughness"),
            ln_pressure: pressure.ln(),
            ln_shear: found.ln_shear,
            residual,
        }
    };
    t.rows.iter().map(one).collect()
}

/// Packing of `of` with smooth contacts.
fn smooth<'a>(all: &'a [Network], of: &Network) -> &'a Network {
    let is_it = |n: &&Network| n.law == "hertz_mindlin" && (n.member, n.step) == (of.member, of.step);
    all.iter().find(is_it).unwrap()
}

/// Least squares of weighted rows.
fn fitted(rows: &[(Vec<f64>, f64, f64)]) -> Vec<f64> {
    let count = rows[0].0.len();
    let slopes = DMatrix::from_fn(rows.len(), count, |i, j| rows[i].0[j] * rows[i].2);
    let values = DVector::from_fn(rows.len(), |i, _| rows[i].1 * rows[i].2);
    slopes.svd(true, true).solve(&values, 1e-12).unwrap().as_slice().to_vec()
}

#[test]
fn the_correction_for_low_tangential_stiffness_is_learned_from_the_stored_packings() {
    let all = networks();
    let lowered = |n: &&Network| n.law == "rough" && n.member < 100;
    for (q, kept) in ContactCorrections::LEARNED.by_low_ratio.into_iter().enumerate() {
        let row = |n: &Network| {
            let terms = ContactCorrections::low_ratio_terms(n.state.stiffness_ratio, n.z);
            (terms.to_vec(), n.residual[q] - smooth(&all, n).residual[q], n.weight())
        };
        let rows: Vec<_> = all.iter().filter(lowered).map(row).collect();
        let found = fitted(&rows);
        println!("{q}: {found:.4?} of {} packings", rows.len());
        for (found, kept) in found.iter().zip(kept) {
            assert!((found - kept).abs() < 2e-3, "{q}: {found} {kept}");
        }
    }
}

#[test]
fn the_correction_for_the_spread_of_stiffness_is_learned_from_rough_and_linear_contacts() {
    let all = networks();
    let mut rows = Vec::new();
    for n in all.iter().filter(|n| n.member > 100) {
        let loose = f64::from(u8::from(n.preparation == "loose"));
        let term = ContactCorrections::spread_term(n.exponent, n.z);
        // Each preparation has its own offset of each modulus.
        for q in 0..2 {
            let mut terms = vec![0.0; 6];
            (terms[q], terms[2 + q], terms[4 + q]) = (term, loose, 1.0 - loose);
            rows.push((terms, n.residual[q], n.weight()));
        }
    }
    // The level of linear springs is that of their stiffness: the ratio of the moduli alone counts.
    for n in all.iter().filter(|n| n.law == "linear") {
        let term = ContactCorrections::spread_term(0.0, n.z);
        let [value, of_smooth] = [n, smooth(&all, n)].map(|n| n.residual[0] - n.residual[1]);
        rows.push((vec![term, -term, 0.0, 0.0, 0.0, 0.0], value - of_smooth, n.weight()));
    }
    let found = fitted(&rows);
    println!("{found:.4?}");
    for (found, kept) in found.iter().zip(ContactCorrections::LEARNED.by_spread) {
        assert!((found - kept).abs() < 5e-3, "{found} {kept}");
    }
}

/// The ratio of the moduli determines z where their level is unknown. The residuals of rough packings include the corrections.
#[test]
fn the_ratio_of_the_moduli_of_rough_packings_scatters_as_stated() {
    /// Square of 97.5 % of a Student distribution of 19 degrees of freedom, over 1.96.
    const OF_FEW: f64 = 1.140;
    let laws = ours().network().unwrap();
    let [of_recipe, of_sample] = laws.scatter.matrices();
    let corrections = ContactCorrections::LEARNED;
    let t = Table::read("ensembles/rough_recipes.csv");
    let mut squares: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (s, row) in csv::samples("rough_recipes.csv").into_iter().zip(&t.rows) {
        let mindlin = NetworkState::of(s.pressure, &s.material, s.size_spread, s.stress_ratio);
        let kappa = mindlin.stiffness_ratio - 0.3 * s.material.stiffness_ratio();
        let state = NetworkState { stiffness_ratio: kappa, ..mindlin };
        // The diameter is 0.2 mm.
        let crossover =
            ContactKind::crossover(t.number(row, "roughness") / 2e-4, &s.material, s.solid_fraction);
        let [_, slope] = ContactKind::Rough.gain((s.pressure / crossover).ln(), s.z);
        let found = Invariants::of(&s.moduli).unwrap();
        let corrected = |q: usize, ln: f64, law: f64| {
            let low = ContactCorrections::low_ratio_terms(kappa, s.z);
            let low: f64 = low.iter().zip(corrections.by_low_ratio[q]).map(|(a, b)| a * b).sum();
            ln - law
                - low
                - corrections.by_spread[q] * ContactCorrections::spread_term(1.0 / 3.0 + slope, s.z)
        };
        let bulk = corrected(0, found.ln_theta, laws.theta.value(s.z, &state));
        let shear = corrected(1, found.ln_shear, laws.shear.value(s.z, &state));
        let of_size = RelaxationCalibration::sample_variances(laws.grains, Some(s.grains));
        let growth = RelaxationCalibration::growth(&laws.scatter_by_state, &state)[0];
        let [recipe, sample] = ScatterLevels::weights(s.z);
        let of_ratio = |level: &Scatter| level[(0, 0)] + level[(1, 1)] - 2.0 * level[(0, 1)];
        let stated = growth
            * (of_ratio(&of_recipe) / recipe[0].powi(2)
                + of_ratio(&of_sample) * of_size[0] / sample[0].powi(2));
        squares.entry(s.preparation).or_default().push((shear - bulk).powi(2) / stated);
    }
    let mean = |all: &Vec<f64>| all.iter().sum::<f64>() / all.len() as f64;
    let fitted = OF_FEW * squares.values().map(mean).sum::<f64>() / squares.len() as f64;
    println!("{fitted:.3} of {} recipes", squares.len());
    assert!(squares.len() == 20 && (fitted / OTHER_CONTACTS - 1.0).abs() < 0.03, "{fitted}");
}

/// z within two standard deviations of the prior, and the offsets of the moduli within .002.
#[test]
fn preparations_of_the_prior_are_those_of_the_stored_packings() {
    let all = networks();
    let mut all_offsets = Vec::new();
    for prior in &SeriesPrior::builtin().preparation {
        let is_it = |n: &&Network| n.law == "hertz_mindlin" && n.preparation == prior.name;
        let own: Vec<&Network> = all.iter().filter(is_it).collect();
        assert_eq!(own.len(), 54, "{}", prior.name);
        for n in &own {
            let pressure = n.state.ln_pressure.exp();
            let z =
                prior.z[0] + prior.slope[0] * pressure.log10() + prior.rise[0] * (pressure.powf(0.3) - 1.0);
            assert!((n.z - z).abs() < 2.0 * prior.z[1] + 0.1, "{}: {} {z}", prior.name, n.z);
        }
        let total: f64 = own.iter().map(|n| n.weight()).sum();
        let offset = [0, 1].map(|q| own.iter().map(|n| n.residual[q] * n.weight()).sum::<f64>() / total);
        println!("{}: {offset:.4?}", prior.name);
        all_offsets.push((prior, offset));
    }
    for (prior, offset) in all_offsets {
        for (found, kept) in offset.iter().zip(prior.moduli) {
            assert!((found - kept).abs() < 2e-3, "{}: {found} {kept}", prior.name);
        }
    }
}

/// Otsubo et al., Géotechnique 65, 694 (2015), measured about 1/2 at low stress and 1/3 at high, with rough beads.
#[test]
fn the_shear_modulus_of_rough_packings_rises_faster_at_low_stress_and_longer_with_rougher_grains() {
    let all = networks();
    let of = |roughness: f64| -> Vec<f64> {
        let is_it = |n: &&Network| {
            n.member > 100 && n.preparation == "lubricated" && (n.roughness - roughness).abs() < 1e-12
        };
        let mut points: Vec<(i64, f64, f64)> = Vec::new();
        for n in all.iter().filter(is_it) {
            let place = n.ln_pressure.round() as i64;
            match points.iter_mut().find(|(at, ..)| *at == place) {
                Some((_, x, y)) => (*x, *y) = ((*x + n.ln_pressure) / 2.0, (*y + n.ln_shear) / 2.0),
                None => points.push((place, n.ln_pressure, n.ln_shear)),
            }
        }
        points.sort_by_key(|(at, ..)| *at);
        assert_eq!(points.len(), 6, "{roughness}");
        points.windows(2).map(|w| (w[1].2 - w[0].2) / (w[1].1 - w[0].1)).collect()
    };
    let exponents = [0.0, 2e-9, 1e-8, 5e-8, 2e-7].map(of);
    exponents.iter().for_each(|e| println!("{e:.2?}"));
    let crossed = |e: &Vec<f64>| e.iter().position(|e| *e < 0.45).unwrap_or(e.len());
    let places: Vec<usize> = exponents.iter().map(crossed).collect();
    assert!(places.is_sorted() && places[0] == 0 && places[4] >= 3, "{places:?}");
    for e in &exponents {
        assert!(e[4] > 0.33 && e[4] < 0.45, "at the highest pressures as smooth grains: {e:?}");
    }
    assert!(exponents[0].iter().all(|e| (0.33..0.42).contains(e)) && exponents[4][0] > 0.5, "{exponents:?}");
}
