//! A damped tone A e^(−γt) cos(ωt + φ), fitted to samples by least squares.

use nalgebra::{Matrix4, Vector4};
use std::f64::consts::TAU;

/// Spacing of the trial frequencies, periods of beat over the samples.
const SCAN: f64 = 0.1;

/// Maximum number of steps of the fit, and the relative change of ω at which it ends.
const MAX_STEPS: usize = 60;
const CONVERGED: f64 = 1e-12;

/// Relative standard deviation of ω above which there is no tone.
const NO_TONE: f64 = 0.1;

/// A fitted tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tone {
    /// ω, rad/s.
    pub(crate) omega: f64,
    /// Its standard deviation with correlated residuals, rad/s.
    pub(crate) stddev: f64,
}

impl Tone {
    /// The tone in `samples`, `interval` s apart with the first at `start` s, with ω in `range` (rad/s). `None` if none
    /// is significant.
    pub(crate) fn found(samples: &[f64], start: f64, interval: f64, range: [f64; 2]) -> Option<Self> {
        let length = samples.len() as f64 * interval;
        // The samples must cover half a period or more.
        let lowest = range[0].max(0.5 * TAU / length);
        if samples.len() < 8 || lowest.is_nan() || lowest >= range[1] {
            return None;
        }
        let times: Vec<f64> = (0..samples.len()).map(|k| start + k as f64 * interval).collect();
        let trials = ((range[1] - lowest) * length / (SCAN * TAU)).ceil().clamp(1.0, 1e5) as usize;
        let trial = |k: usize| lowest + (range[1] - lowest) * k as f64 / trials as f64;
        let fits = (0..=trials).map(|k| Fit::undamped(samples, &times, trial(k)));
        let best = fits.min_by(|a, b| a.error.total_cmp(&b.error))?;
        let fit = best.converged(samples, &times)?;
        let tone = fit.tone(samples, &times)?;
        ((range[0]..=range[1]).contains(&tone.omega) && tone.stddev < NO_TONE * tone.omega).then_some(tone)
    }
}

/// e^(−γt) (a cos ωt + b sin ωt).
#[derive(Clone, Copy, Debug)]
struct Fit {
    omega: f64,
    decay: f64,
    cosine: f64,
    sine: f64,
    /// Sum of the squares of the residuals.
    error: f64,
}

impl Fit {
    /// The best fit without decay at `omega`.
    fn undamped(samples: &[f64], times: &[f64], omega: f64) -> Self {
        let [mut cc, mut cs, mut ss, mut yc, mut ys] = [0.0; 5];
        for (y, t) in samples.iter().zip(times) {
            let (s, c) = (omega * t).sin_cos();
            cc += c * c;
            cs += c * s;
            ss += s * s;
            yc += y * c;
            ys += y * s;
        }
        let determinant = cc * ss - cs * cs;
        let (cosine, sine) = ((yc * ss - ys * cs) / determinant, (ys * cc - yc * cs) / determinant);
        let fit = Self { omega, decay: 0.0, cosine, sine, error: 0.0 };
        fit.mass_times(samples, times)
    }

    fn mass_times(self, samples: &[f64], times: &[f64]) -> Self {
        let error = samples.iter().zip(times).map(|(y, t)| (y - self.at(*t)).powi(2)).sum();
        Self { error, ..self }
    }

    fn at(&self, t: f64) -> f64 {
        let (s, c) = (self.omega * t).sin_cos();
        (-self.decay * t).exp() * (self.cosine * c + self.sine * s)
    }

    /// Derivatives with respect to ω and γ, in units of ω, and to a and b.
    fn slopes(&self, t: f64) -> Vector4<f64> {
        let (s, c) = (self.omega * t).sin_cos();
        let left = (-self.decay * t).exp();
        let turned = left * (self.sine * c - self.cosine * s);
        let turns = self.omega * t;
        Vector4::new(turns * turned, -turns * self.at(t), left * c, left * s)
    }

    fn normal(&self, samples: &[f64], times: &[f64]) -> (Matrix4<f64>, Vector4<f64>) {
        let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for (y, t) in samples.iter().zip(times) {
            let slopes = self.slopes(*t);
            matrix += slopes * slopes.transpose();
            right += slopes * (y - self.at(*t));
        }
        (matrix, right)
    }

    /// Levenberg–Marquardt iteration.
    fn converged(mut self, samples: &[f64], times: &[f64]) -> Option<Self> {
        let mut damping = 1e-3;
        for _ in 0..MAX_STEPS {
            let (matrix, right) = self.normal(samples, times);
            let damped = matrix + Matrix4::from_diagonal(&(matrix.diagonal() * damping));
            let step = damped.cholesky()?.solve(&right);
            let next = Self {
                omega: self.omega * (1.0 + step[0]),
                decay: self.decay + self.omega * step[1],
                cosine: self.cosine + step[2],
                sine: self.sine + step[3],
                error: 0.0,
            };
            let next = next.mass_times(samples, times);
            // False for NaN.
            if next.error <= self.error {
                self = next;
                damping *= 0.1;
                if step[0].abs() < CONVERGED {
                    break;
                }
            } else if step[0].abs() < CONVERGED {
                break;
            } else {
                damping *= 10.0;
            }
        }
        self.error.is_finite().then_some(self)
    }

    fn tone(&self, samples: &[f64], times: &[f64]) -> Option<Tone> {
        let covariance = self.normal(samples, times).0.try_inverse()?;
        let left: Vec<f64> = samples.iter().zip(times).map(|(y, t)| y - self.at(*t)).collect();
        let freedom = (samples.len() as f64 - 4.0).max(1.0);
        let noise = self.error / freedom * correlation_factor(&left);
        let tone = Tone { omega: self.omega, stddev: self.omega * (covariance[(0, 0)] * noise).sqrt() };
        tone.stddev.is_finite().then_some(tone)
    }
}

/// The factor by which correlations of `noise` increase the variance of a mean: 1 + 2 Σ of its autocorrelation, up to
/// the first zero.
fn correlation_factor(noise: &[f64]) -> f64 {
    let at = |lag: usize| noise.iter().zip(&noise[lag..]).map(|(a, b)| a * b).sum::<f64>();
    let square = at(0);
    if square == 0.0 {
        return 1.0;
    }
    1.0 + 2.0 * (1..noise.len()).map(|lag| at(lag) / square).take_while(|r| *r > 0.0).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    const OMEGA: f64 = 3.0e4;

    fn samples(noise: f64, seed: u64) -> Vec<f64> {
        let mut random = Noise::at(seed, &[]);
        let at = |k: usize| {
            let t = 1e-5 + k as f64 * 5e-6;
            (-300.0 * t).exp() * (OMEGA * t + 0.1).cos() + noise * random.next()
        };
        (0..160).map(at).collect()
    }

    fn found(samples: &[f64]) -> Option<Tone> {
        Tone::found(samples, 1e-5, 5e-6, [0.1 * OMEGA, 2.0 * OMEGA])
    }

    #[test]
    fn a_clean_tone_is_found_to_rounding() {
        let tone = found(&samples(0.0, 1)).unwrap();
        assert!((tone.omega / OMEGA - 1.0).abs() < 1e-10, "{tone:?}");
        assert!(tone.stddev < 1e-9 * OMEGA);
    }

    #[test]
    fn noise_is_in_the_standard_deviation() {
        let errors = (0..100).map(|seed| {
            let tone = found(&samples(0.1, seed)).unwrap();
            (tone.omega - OMEGA) / tone.stddev
        });
        let square = errors.map(|e| e * e).sum::<f64>() / 100.0;
        assert!((0.5..1.5).contains(&square), "{square}");
    }

    #[test]
    fn where_no_tone_is_none_is_found() {
        assert!(found(&[0.0; 160]).is_none());
        assert!(found(&[f64::NAN; 160]).is_none());
        assert!(found(&samples(0.0, 1)[..5]).is_none());
        let noise: Vec<f64> = samples(1e6, 3);
        assert!(found(&noise).is_none_or(|t| t.stddev > 1e-3 * OMEGA), "{:?}", found(&noise));
    }
}
