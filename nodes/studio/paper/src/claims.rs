//! Statements of the paper, and the goals of the reproduction, checked on the means.

use crate::compare::Comparison;
use crate::inversion::{Errors, Judged, of_the_paper};
use crate::quantity::Quantity;
use crate::sample::States;
use crate::tables::{PAPER, PRESSURES, SAMPLES};
use grainlab_emt::Modulus;

/// A statement and whether it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Statement in words.
    pub text: String,
    /// Result in words.
    pub found: String,
    /// True if it holds; `None` if it could not be checked.
    pub holds: Option<bool>,
}

/// Largest differences that count as reproduced: coordination relative, the others absolute.
pub const COORDINATION: f64 = 0.035;
/// Largest difference of ε.
pub const EPS: f64 = 0.012;
/// Largest difference of φ.
pub const SOLID_FRACTION: f64 = 0.006;
/// Largest difference of γ/Δ.
pub const STRAIN_RATIO: f64 = 0.015;
/// Change of L^D with pressure over its mean.
pub const DEVIATORIC_FABRIC: f64 = 0.10;

/// The samples from the most to the fewest contacts, as in Table I.
const ORDER: [usize; SAMPLES] = [0, 1, 3, 2];

/// Means by quantity, sample and pressure.
struct Means<'a>(&'a [Comparison]);

impl Means<'_> {
    fn value(&self, quantity: Quantity, sample: usize, pressure: usize) -> Option<f64> {
        Some(Comparison::find(self.0, quantity, sample, pressure)?.ours.value)
    }

    /// The largest of `size` over all states of a quantity that the paper has, with its place.
    fn worst(&self, quantity: Quantity, size: fn(&Comparison) -> Option<f64>) -> Option<(f64, usize, usize)> {
        let all = self.0.iter().filter(|c| c.quantity == quantity);
        let sized = all.filter_map(|c| Some((size(c)?, c.sample, c.pressure)));
        sized.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }
}

/// List of all claims.
pub fn claims(compared: &[Comparison], judged: &[Judged]) -> Vec<Claim> {
    let means = Means(compared);
    let mut all = vec![
        within(
            &means,
            Quantity::Z,
            COORDINATION,
            "coordination z (without rattlers) within 3.5 % of the paper's k",
            true,
        ),
        within(
            &means,
            Quantity::K,
            COORDINATION,
            "coordination k (all grains) within 3.5 % of the paper's k",
            true,
        ),
        within(&means, Quantity::Eps, EPS, "eps within 0.012 of Table III", false),
        within(
            &means,
            Quantity::SolidFraction,
            SOLID_FRACTION,
            "solid fraction within 0.006 of Table I",
            false,
        ),
        within(&means, Quantity::StrainTotal, STRAIN_RATIO, "gamma/Delta within 0.015 of Table II", false),
        ordered(&means, Quantity::Z, "coordination in the order S1 > S2 > S4 > S3 at every pressure", true),
        ordered(&means, Quantity::Eps, "eps in the order S1 < S2 < S4 < S3 at every pressure", false),
        constant_fabric(&means),
        shear_moduli(&means),
    ];
    all.extend(ratios_beat_absolute_moduli(&means, judged));
    all.extend(ours_beats_the_paper(judged));
    all
}

fn within(means: &Means<'_>, quantity: Quantity, limit: f64, text: &str, relative: bool) -> Claim {
    let size = if relative { Comparison::relative } else { Comparison::difference };
    let worst = means.worst(quantity, size);
    let found = worst.map_or_else(String::new, |(size, sample, pressure)| {
        let size = if relative { format!("{:+.1} %", 100.0 * size) } else { format!("{size:+.4}") };
        format!("at most {size}, {}", place(sample, pressure))
    });
    Claim { text: text.into(), found, holds: worst.map(|(size, ..)| size.abs() <= limit) }
}

fn ordered(means: &Means<'_>, quantity: Quantity, text: &str, falling: bool) -> Claim {
    let mut broken = Vec::new();
    let mut known = true;
    for pressure in 0..PRESSURES {
        for pair in ORDER.windows(2) {
            match (means.value(quantity, pair[0], pressure), means.value(quantity, pair[1], pressure)) {
                (Some(a), Some(b)) if (a > b) == falling => {}
                (Some(_), Some(_)) => {
                    broken.push(format!("{} and {}", place(pair[0], pressure), PAPER[pair[1]].name))
                }
                _ => known = false,
            }
        }
    }
    everywhere(text, &broken, known)
}

/// A claim on all means, and the places for which it does not hold; `known` if every mean is.
fn everywhere(text: &str, broken: &[String], known: bool) -> Claim {
    let found =
        if broken.is_empty() { "in all means".to_owned() } else { format!("not for {}", broken.join(", ")) };
    Claim { text: text.into(), found, holds: known.then_some(broken.is_empty()) }
}

fn constant_fabric(means: &Means<'_>) -> Claim {
    let spread = |sample: usize| {
        let values: Option<Vec<f64>> =
            (0..PRESSURES).map(|p| means.value(Quantity::DeviatoricFabric, sample, p)).collect();
        let values = values?;
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some((high - low) / mean.abs())
    };
    let spreads: Option<Vec<f64>> = (0..SAMPLES).map(spread).collect();
    let found = spreads.as_ref().map_or_else(String::new, |all| {
        let each = all.iter().zip(&PAPER).map(|(s, sample)| format!("{} {:.1} %", sample.name, 100.0 * s));
        format!("largest less smallest over the mean: {}", each.collect::<Vec<_>>().join(", "))
    });
    let holds = spreads.map(|all| all.iter().all(|s| *s <= DEVIATORIC_FABRIC));
    Claim { text: "L^D constant with pressure to 10 % (Fig. 1)".into(), found, holds }
}

fn shear_moduli(means: &Means<'_>) -> Claim {
    let [g12, g13] = [Modulus::G12, Modulus::G13].map(Quantity::Modulus);
    let mut broken = Vec::new();
    let mut known = true;
    for sample in 0..SAMPLES {
        for pressure in 0..PRESSURES {
            let (Some(across), Some(along)) =
                (means.value(g12, sample, pressure), means.value(g13, sample, pressure))
            else {
                known = false;
                continue;
            };
            let before = pressure.checked_sub(1);
            let grows =
                |q, now: f64| before.and_then(|p| means.value(q, sample, p)).is_none_or(|old| now > old);
            if along <= across || !grows(g12, across) || !grows(g13, along) {
                broken.push(place(sample, pressure));
            }
        }
    }
    everywhere("G13 > G12, and both grow with pressure (Fig. 2)", &broken, known)
}

/// The conclusion of the paper: ratios of moduli give k, absolute moduli do not. k by absolute moduli is that of Eq. 14 with
/// the strain since the reference state, as in Table III.
fn ratios_beat_absolute_moduli(means: &Means<'_>, judged: &[Judged]) -> Option<Claim> {
    let ratio = Judged::find(judged, "ratio", Some("total"), "paper")?.k?;
    let mut errors = Vec::new();
    for (sample, pressure) in States::places() {
        let [k, emt] = [Quantity::K, Quantity::KEmt].map(|q| means.value(q, sample, pressure));
        errors.extend(emt.zip(k).map(|(emt, k)| emt - k));
    }
    let emt = Errors::of(&errors)?;
    let [of_ratio, of_emt, _] = of_the_paper();
    Some(Claim {
        text: "ratios of moduli give k better than absolute moduli".into(),
        found: format!(
            "mean error of k {:.2} by ratios, {:.2} by absolute moduli (the paper's: {:.2} and {:.2})",
            ratio.magnitude, emt.magnitude, of_ratio.magnitude, of_emt.magnitude
        ),
        holds: Some(ratio.magnitude < emt.magnitude),
    })
}

/// Our inversion compared with the paper's, on the same packings.
fn ours_beats_the_paper(judged: &[Judged]) -> Option<Claim> {
    let paper = Judged::find(judged, "ratio", Some("total"), "paper")?;
    let ours = Judged::find(judged, "relaxed", None, "grainlab")?;
    let (theirs, own) = ((paper.eps?, paper.k?), (ours.eps?, ours.k?));
    Some(Claim {
        text: "the inversion of grainlab has at most half the paper's error, on these packings".into(),
        found: format!(
            "mean error of eps {:.4} and {:.4}, of k {:.3} and {:.3}",
            own.0.magnitude, theirs.0.magnitude, own.1.magnitude, theirs.1.magnitude
        ),
        holds: Some(
            2.0 * own.0.magnitude <= theirs.0.magnitude && 2.0 * own.1.magnitude <= theirs.1.magnitude,
        ),
    })
}

fn place(sample: usize, pressure: usize) -> String {
    format!("{} at {} kPa", PAPER[sample].name, crate::tables::PRESSURE[pressure] / 1e3)
}
