//! Statements of the paper, and the goals of the reproduction, checked on the means.

use super::compare::Comparison;
use super::inversion::{Errors, Judged, of_the_paper};
use super::quantity::Quantity;
use super::sample::States;
use super::tables::{PAPER, PRESSURES, SAMPLES};
use grainlab_emt::Modulus;

/// A statement and whether it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Statement in words.
    pub text: String,
    /// Result in words.
    pub found: String,
    /// Result in one word.
    pub verdict: Verdict,
}

/// Result of checking a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The means agree with it.
    Holds,
    /// They do not, by less than two of their standard errors beyond its limit.
    Undecided,
    /// They do not.
    Missed,
    /// A mean is missing.
    Unchecked,
}

impl Verdict {
    /// The verdict in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Undecided => "within the scatter",
            Self::Missed => "does not hold",
            Self::Unchecked => "not checked",
        }
    }

    /// Verdict on a statement whose limit is exceeded by these numbers of standard errors, infinite where no error is known.
    fn of(exceeded: impl IntoIterator<Item = f64>) -> Self {
        let worst = exceeded.into_iter().fold(0.0, f64::max);
        match worst {
            0.0 => Self::Holds,
            errors if errors <= ERRORS => Self::Undecided,
            _ => Self::Missed,
        }
    }
}

/// Standard errors beyond a limit that scatter alone may cause.
const ERRORS: f64 = 2.0;

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
        within(&means, Quantity::Eps, EPS, "ε within 0.012 of Table III", false),
        within(
            &means,
            Quantity::SolidFraction,
            SOLID_FRACTION,
            "solid fraction within 0.006 of Table I",
            false,
        ),
        within(&means, Quantity::StrainTotal, STRAIN_RATIO, "γ/Δ within 0.015 of Table II", false),
        ordered(&means, Quantity::Z, "coordination in the order S1 > S2 > S4 > S3 at every pressure", true),
        ordered(&means, Quantity::Eps, "ε in the order S1 < S2 < S4 < S3 at every pressure", false),
        constant_fabric(&means),
        shear_moduli(&means),
    ];
    all.extend(ratios_beat_absolute_moduli(&means, judged));
    all.extend(ours_beats_the_paper(judged));
    all
}

fn within(means: &Means<'_>, quantity: Quantity, limit: f64, text: &str, relative: bool) -> Claim {
    let size = if relative { Comparison::relative } else { Comparison::difference };
    let Some((worst, sample, pressure)) = means.worst(quantity, size) else { return unchecked(text) };
    let worst = if relative { format!("{:+.1} %", 100.0 * worst) } else { format!("{worst:+.4}") };
    let exceeded = means.0.iter().filter(|c| c.quantity == quantity).filter_map(|c| {
        let scale = if relative { c.paper?.value } else { 1.0 };
        Some(in_errors((size(c)?.abs() - limit).max(0.0), c.error().map(|e| e / scale)))
    });
    let found = format!("largest difference {worst}, {}", place(sample, pressure));
    Claim { text: text.into(), found, verdict: Verdict::of(exceeded) }
}

fn in_errors(excess: f64, error: Option<f64>) -> f64 {
    match error {
        _ if excess == 0.0 => 0.0,
        Some(error) if error > 0.0 => excess / error,
        _ => f64::INFINITY,
    }
}

fn unchecked(text: &str) -> Claim {
    Claim { text: text.into(), found: String::new(), verdict: Verdict::Unchecked }
}

fn ordered(means: &Means<'_>, quantity: Quantity, text: &str, falling: bool) -> Claim {
    let (mut broken, mut exceeded) = (Vec::new(), Vec::new());
    for pressure in 0..PRESSURES {
        for pair in ORDER.windows(2) {
            let found = [0, 1].map(|n| Comparison::find(means.0, quantity, pair[n], pressure));
            let [Some(a), Some(b)] = found else { return unchecked(text) };
            let step = if falling { b.ours.value - a.ours.value } else { a.ours.value - b.ours.value };
            if step >= 0.0 {
                broken.push(format!("{} and {}", place(pair[0], pressure), PAPER[pair[1]].name));
                let error = a.error().zip(b.error()).map(|(a, b)| a.hypot(b));
                exceeded.push(in_errors(step.max(f64::MIN_POSITIVE), error));
            }
        }
    }
    Claim { text: text.into(), found: everywhere(&broken), verdict: Verdict::of(exceeded) }
}

/// The places for which a statement on all means does not hold.
fn everywhere(broken: &[String]) -> String {
    if broken.is_empty() { "in all means".to_owned() } else { format!("not for {}", broken.join(", ")) }
}

fn constant_fabric(means: &Means<'_>) -> Claim {
    let text = "deviatoric fabric constant with pressure to 10 % (Fig. 1)";
    let (mut each, mut exceeded) = (Vec::new(), Vec::new());
    for (sample, paper) in PAPER.iter().enumerate() {
        let all = (0..PRESSURES).map(|p| Comparison::find(means.0, Quantity::DeviatoricFabric, sample, p));
        let Some(all) = all.collect::<Option<Vec<_>>>() else { return unchecked(text) };
        let values = || all.iter().map(|c| c.ours.value);
        let mean = values().sum::<f64>() / all.len() as f64;
        let spread = (values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min))
            / mean.abs();
        let error = all[0].error().map(|e| std::f64::consts::SQRT_2 * e / mean.abs());
        each.push(format!("{} {:.1} %", paper.name, 100.0 * spread));
        exceeded.push(in_errors((spread - DEVIATORIC_FABRIC).max(0.0), error));
    }
    let found = format!("largest less smallest over the mean: {}", each.join(", "));
    Claim { text: text.into(), found, verdict: Verdict::of(exceeded) }
}

fn shear_moduli(means: &Means<'_>) -> Claim {
    let [g12, g13] = [Modulus::G12, Modulus::G13].map(Quantity::Modulus);
    let text = "G13 > G12, and both grow with pressure (Fig. 2)";
    let mut broken = Vec::new();
    for sample in 0..SAMPLES {
        for pressure in 0..PRESSURES {
            let (Some(across), Some(along)) =
                (means.value(g12, sample, pressure), means.value(g13, sample, pressure))
            else {
                return unchecked(text);
            };
            let before = pressure.checked_sub(1);
            let grows =
                |q, now: f64| before.and_then(|p| means.value(q, sample, p)).is_none_or(|old| now > old);
            if along <= across || !grows(g12, across) || !grows(g13, along) {
                broken.push(place(sample, pressure));
            }
        }
    }
    let verdict = if broken.is_empty() { Verdict::Holds } else { Verdict::Missed };
    Claim { text: text.into(), found: everywhere(&broken), verdict }
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
        verdict: if ratio.magnitude < emt.magnitude { Verdict::Holds } else { Verdict::Missed },
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
            "mean error of ε {:.4} and {:.4}, of k {:.3} and {:.3}",
            own.0.magnitude, theirs.0.magnitude, own.1.magnitude, theirs.1.magnitude
        ),
        verdict: match 2.0 * own.0.magnitude <= theirs.0.magnitude
            && 2.0 * own.1.magnitude <= theirs.1.magnitude
        {
            true => Verdict::Holds,
            false => Verdict::Missed,
        },
    })
}

fn place(sample: usize, pressure: usize) -> String {
    format!("{} at {} kPa", PAPER[sample].name, super::tables::PRESSURE[pressure] / 1e3)
}
