//! The coherent part of a plane wave in the frozen network, over time.
//!
//! The grains start with the velocities of a plane wave, v = p exp(iq·x), and move without dissipation. The coherent
//! amplitude is the mean velocity, weighted with mass, over the phase of the wave. Disorder transfers its energy to other
//! waves, and it decays. Gelin, Tanaka and Lemaître, Nature Materials 15, 1177 (2016); Saitoh and Mizuno, Soft Matter
//! 17, 4204 (2021).

use crate::dispersion::bloch::Bloch;
use crate::dispersion::modes::plane_waves;
use crate::dispersion::waves::{Amplitude, Block, Row, WAVES, products};
use grainlab_core::{Mat3, Vec3};
use pulp::WithSimd;

/// Time step over 1/ω of the stiffest motion; the limit of stability is 2. Its error of ω is removed afterwards.
const STEP: f64 = 1.6;

/// Rounds of power iteration: an estimate of the highest frequency from below, by a few per cent.
const ROUNDS: usize = 40;

/// A network that vibrates freely after the velocities of plane waves.
#[derive(Debug)]
pub(super) struct Coherence<'a> {
    bloch: &'a Bloch<'a>,
    /// M times the plane waves.
    references: Block,
    /// Inverse of the overlaps of the plane waves.
    inverse: Mat3,
    /// 1/m and 1/I of each grain, 1/kg; 0 for rattlers.
    inverse_masses: Vec<[f64; 2]>,
    x: Block,
    v: Block,
    time_step: f64,
    /// Time steps between samples.
    stride: usize,
    /// Real part of the overlap of the polarization in the column, sent, with that in the row, at each sample. The first
    /// is the unit matrix.
    pub(super) overlaps: Vec<Mat3>,
}

impl<'a> Coherence<'a> {
    /// Three perpendicular polarizations, with samples `interval` (s) apart or up to a time step less.
    pub(super) fn new(bloch: &'a Bloch<'a>, polarizations: &[Vec3; 3], interval: f64) -> Self {
        let v = plane_waves(bloch, polarizations);
        let inverse_masses = inverse_masses(bloch);
        let highest = Highest { bloch, weights: &inverse_masses, grains: v.len() };
        let time_step = (STEP / pulp::Arch::new().dispatch(highest)).min(interval);
        let stride = (interval / time_step).floor() as usize;
        let mut references = vec![Amplitude::STILL; v.len()];
        bloch.apply_mass(&v, &mut references);
        let inverse = overlaps(&references, &v).try_inverse().unwrap_or_else(Mat3::zeros);
        let x = vec![Amplitude::STILL; v.len()];
        let first = vec![Mat3::identity()];
        Self { bloch, references, inverse, inverse_masses, x, v, time_step, stride, overlaps: first }
    }

    /// Time between samples, s.
    pub(super) fn interval(&self) -> f64 {
        self.stride as f64 * self.time_step
    }

    /// Time of the last sample, s.
    pub(super) fn duration(&self) -> f64 {
        self.interval() * (self.overlaps.len() - 1) as f64
    }

    /// Goes on until the time `duration`, s.
    pub(super) fn run_until(&mut self, duration: f64) {
        let samples = (duration / self.interval()).ceil() as usize + 1;
        let more = samples.saturating_sub(self.overlaps.len());
        pulp::Arch::new().dispatch(Motion { coherence: self, samples: more });
    }

    /// The true frequency of a motion that has `omega` with the time step of the integration, rad/s.
    pub(super) fn without_time_step(&self, omega: f64) -> f64 {
        // The leapfrog scheme has sin(ω' Δt/2) = ω Δt/2.
        (0.5 * omega * self.time_step).sin() * 2.0 / self.time_step
    }
}

/// The highest frequency, rad/s.
struct Highest<'a> {
    bloch: &'a Bloch<'a>,
    weights: &'a [[f64; 2]],
    grains: usize,
}

impl WithSimd for Highest<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> f64 {
        let Self { bloch, weights, grains } = self;
        // Any motions that are not smooth.
        let start = |g: usize| {
            let entry = |k: usize, wave: usize| if (g * 7 + k * 3 + wave * 11) % 5 < 2 { 1.0 } else { -1.0 };
            std::array::from_fn(|k| Row::of([0, 1, 2].map(|wave| entry(k, wave))))
        };
        let mut x: Block = (0..grains).map(|g| Amplitude { re: start(g), im: [Row::ZERO; 6] }).collect();
        let mut image = x.clone();
        let mut square = 0.0;
        for _ in 0..ROUNDS {
            bloch.apply(&x, &mut image);
            scale(&mut image, weights);
            let (before, after) = (products(&x, &x), products(&image, &image));
            let ratio = |k: usize| (after[k] / before[k]).sqrt();
            square = (0..WAVES).map(ratio).filter(|r| r.is_finite()).fold(0.0, f64::max);
            let share = Row::of(after.map(|a| if a > 0.0 { 1.0 / a.sqrt() } else { 0.0 }));
            for (x, image) in x.iter_mut().zip(&image) {
                for k in 0..6 {
                    x.re[k] = share * image.re[k];
                    x.im[k] = share * image.im[k];
                }
            }
        }
        square.sqrt()
    }
}

/// Leapfrog integration. Positions start at zero, so that velocities half a step after the start are those of the start.
struct Motion<'a, 'b> {
    coherence: &'a mut Coherence<'b>,
    samples: usize,
}

impl WithSimd for Motion<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Coherence {
            bloch,
            references,
            inverse,
            inverse_masses,
            x,
            v,
            time_step,
            stride,
            overlaps: found,
        } = self.coherence;
        let mut image = vec![Amplitude::STILL; x.len()];
        let (forwards, backwards) = (Row::of([*time_step; WAVES]), Row::of([-*time_step; WAVES]));
        for _ in 0..self.samples {
            let mut before = Mat3::zeros();
            for k in 1..=*stride {
                x.iter_mut().zip(&*v).for_each(|(x, v)| x.add(forwards, v));
                bloch.apply(x, &mut image);
                scale(&mut image, inverse_masses);
                if k == *stride {
                    before = overlaps(references, v);
                }
                v.iter_mut().zip(&image).for_each(|(v, image)| v.add(backwards, image));
            }
            // Velocities at the time of the sample: the mean of those half a step before and after.
            found.push(*inverse * (before + overlaps(references, v)) * 0.5);
        }
    }
}

/// 1/m and 1/I of each grain, 1/kg; 0 for rattlers.
fn inverse_masses(bloch: &Bloch<'_>) -> Vec<[f64; 2]> {
    let inverse = |m: f64| if m > 0.0 { 1.0 / m } else { 0.0 };
    let backbone = bloch.backbone;
    backbone.mass.iter().zip(&backbone.inertia).map(|(m, i)| [inverse(*m), inverse(*i)]).collect()
}

#[inline(always)]
fn scale(x: &mut [Amplitude], weights: &[[f64; 2]]) {
    for (x, [m, i]) in x.iter_mut().zip(weights) {
        for k in 0..6 {
            let weight = if k < 3 { *m } else { *i };
            x.re[k] = weight * x.re[k];
            x.im[k] = weight * x.im[k];
        }
    }
}

/// Real parts of r* v, of each wave of r (row) and v (column).
#[inline(always)]
fn overlaps(references: &[Amplitude], v: &[Amplitude]) -> Mat3 {
    let mut sum = Mat3::zeros();
    for (r, v) in references.iter().zip(v) {
        for k in 0..6 {
            for row in 0..WAVES {
                for column in 0..WAVES {
                    sum[(row, column)] +=
                        r.re[k].0[row] * v.re[k].0[column] + r.im[k].0[row] * v.im[k].0[column];
                }
            }
        }
    }
    sum
}
