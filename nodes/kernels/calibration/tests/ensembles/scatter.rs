//! Constants of the scatter of packings that `grainlab calibrate` does not learn: each is fitted here.

use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_emt::{
    DeviatorLaw, Invariants, NetworkState, RESPONSE_STDDEV, RelaxationCalibration, SCATTER_TREND,
    ScatterLevels,
};
use std::collections::BTreeMap;

/// The moduli and ε weighted by stiffness.
const QUANTITIES: usize = 6;

fn laws() -> &'static RelaxationCalibration {
    ours().network().unwrap()
}

fn state(s: &CalibrationSample) -> NetworkState {
    NetworkState::of(s.pressure, &s.material, s.size_spread, s.stress_ratio)
}

/// Returns the differences of a packing from the laws in the units of the sample level at the reference state.
fn residual(s: &CalibrationSample) -> [f64; QUANTITIES] {
    let (laws, state) = (laws(), state(s));
    let found = Invariants::of(&s.moduli).unwrap();
    let unit = (2.0 * s.material.effective_young().ln() + s.pressure.ln()) / 3.0;
    let deviator = |value: f64, law: &DeviatorLaw| value - law.value(s.z, s.eps, &state);
    let off = [
        found.ln_theta - unit - laws.theta.value(s.z, &state),
        found.ln_shear - unit - laws.shear.value(s.z, &state),
        deviator(found.dilatation, &laws.dilatation),
        deviator(found.voigt, &laws.voigt),
        deviator(found.harmonic, &laws.harmonic),
        deviator(s.eps_stiffness, &laws.eps_stiffness),
    ];
    let growth = RelaxationCalibration::growth(&laws.scatter_by_state, &state);
    let [_, weights] = ScatterLevels::weights(s.z);
    std::array::from_fn(|i| off[i] * weights[i] / growth[i].sqrt())
}

/// The states of each packing, with little or no deviator.
fn packings(file: &str) -> BTreeMap<String, Vec<CalibrationSample>> {
    let mut all: BTreeMap<String, Vec<CalibrationSample>> = BTreeMap::new();
    for s in csv::samples(file).into_iter().filter(|s| s.stress_ratio.abs() < 0.05) {
        all.entry(s.packing.clone()).or_default().push(s);
    }
    all
}

fn mean(all: impl ExactSizeIterator<Item = [f64; QUANTITIES]>) -> [f64; QUANTITIES] {
    let n = all.len() as f64;
    all.fold([0.0; QUANTITIES], |sum, one| std::array::from_fn(|i| sum[i] + one[i] / n))
}

/// The packings of `large.csv` are packings of `wide.csv` with four times the grains. What differs in a pair is due to the size.
#[test]
fn nearly_half_of_the_variance_between_samples_of_a_recipe_is_inverse_to_the_number_of_grains() {
    let (small, laws) = (packings("wide.csv"), laws());
    let [_, sample] = laws.scatter.matrices();
    let mut shares = Vec::new();
    for (name, of_large) in packings("large.csv") {
        let Some(of_small) = small.get(&name) else { continue };
        let n = of_large.len().min(of_small.len());
        let [large, small] = [&of_large[..n], &of_small[..n]].map(|states| mean(states.iter().map(residual)));
        let of = |grains: u32| f64::from(laws.grains) / f64::from(grains);
        let inverse = of(of_large[0].grains) + of(of_small[0].grains);
        shares.push(std::array::from_fn(|i| (large[i] - small[i]).powi(2) / (sample[(i, i)] * inverse)));
    }
    let n = shares.len();
    let share = mean(shares.into_iter());
    let fitted = share.iter().sum::<f64>() / QUANTITIES as f64;
    eprintln!("{n} pairs: shares {share:.2?}, mean {fitted:.2}");
    let kept = 2.0 * (1.0 - RelaxationCalibration::sample_variances(1000, Some(2000))[0]);
    assert!(n >= 20 && (fitted - kept).abs() < 0.02, "{fitted} {kept}");
}

/// The packings were pressed at a low friction and then sheared at a high one: their contacts do not slide.
#[test]
fn the_effect_of_a_deviator_differs_as_in_packings_sheared_without_sliding() {
    let laws = laws();
    let (mut of_effect, mut square) = (0.0, 0.0);
    for s in csv::samples("locked.csv").iter().filter(|s| s.stress_ratio.abs() > 0.1) {
        let under = state(s);
        let without = NetworkState { stress_ratio: 0.0, ..under };
        let found = Invariants::of(&s.moduli).unwrap();
        let [with, without] = [under, without].map(|state| laws.dilatation.value(s.z, s.eps, &state));
        let effect = with - without;
        of_effect += effect * effect;
        square += (found.dilatation - with).powi(2);
    }
    let fitted = (square / of_effect).sqrt();
    assert!((fitted / RESPONSE_STDDEV - 1.0).abs() < 0.03, "{fitted}");
}

/// The residuals of a packing over pressure are a mean and a trend; the share is that of the squares of the trend per decade.
#[test]
fn the_residuals_of_a_packing_change_with_pressure_by_the_stated_share() {
    let mut sums = [[0.0; 2]; QUANTITIES];
    let mut count = 0;
    for states in ["wide.csv", "recipes.csv"].into_iter().flat_map(packings).map(|(_, states)| states) {
        let n = states.len() as f64;
        let x: Vec<f64> = states.iter().map(|s| s.pressure.log10()).collect();
        let middle = x.iter().sum::<f64>() / n;
        let spread: f64 = x.iter().map(|x| (x - middle).powi(2)).sum();
        if states.len() < 3 || spread < 0.1 {
            continue;
        }
        count += 1;
        let residuals: Vec<_> = states.iter().map(residual).collect();
        let middle_of = mean(residuals.iter().copied());
        for (i, sums) in sums.iter_mut().enumerate() {
            let slope = residuals.iter().zip(&x).map(|(r, x)| r[i] * (x - middle)).sum::<f64>() / spread;
            let off =
                |(r, x): (&[f64; QUANTITIES], &f64)| (r[i] - middle_of[i] - slope * (x - middle)).powi(2);
            let rest = residuals.iter().zip(&x).map(off).sum::<f64>() / (n - 2.0);
            sums[0] += middle_of[i].powi(2) - rest / n;
            sums[1] += slope * slope - rest / spread;
        }
    }
    let shares = sums.map(|[mean, trend]| trend / (mean + trend));
    let fitted = shares.iter().sum::<f64>() / QUANTITIES as f64;
    eprintln!("{count} packings: shares {shares:.2?}, mean {fitted:.2}");
    assert!(count > 250 && (fitted - SCATTER_TREND).abs() < 0.02, "{fitted}");
}
