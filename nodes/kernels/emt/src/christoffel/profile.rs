//! The misfit of the best medium as a function of the axis.

use super::error::ChristoffelError;
use super::ray::{Column, Ray};
use super::search::{Point, Problem};
use grainlab_core::{Mat3, Vec3, WaveSpeed};
use nalgebra::{Matrix2, Vector2};

/// Angle of the central differences with respect to the axis, rad.
const TILT: f64 = 1e-4;

/// Maximum number of steps of a descent.
const STEPS: usize = 40;

/// Longest and shortest step, rad.
const LONGEST: f64 = 0.3;
const SHORTEST: f64 = 1e-8;

#[derive(Clone, Copy)]
pub(super) struct Speeds<'a> {
    pub(super) measured: &'a [WaveSpeed],
    pub(super) weights: &'a [f64],
    /// For each speed, true if it is one of two S modes of its direction.
    pub(super) paired: &'a [bool],
}

/// An axis and the best medium about it.
#[derive(Clone)]
pub(super) struct Stand {
    pub(super) axis: Vec3,
    pub(super) point: Point,
}

/// Derivatives with respect to tilts of the axis towards two perpendicular directions.
pub(super) struct Tilts {
    pub(super) towards: [Vec3; 2],
    /// Second derivatives of half the weighted sum of squares of the best medium about each axis, 1/rad².
    pub(super) curvature: Matrix2<f64>,
    gradient: Vector2<f64>,
}

impl<'a> Speeds<'a> {
    /// The speeds in the frame of a trial axis.
    pub(super) fn rays(&self, axis: &Vec3) -> Result<Vec<Ray>, ChristoffelError> {
        let ray = |(index, (speed, paired)): (usize, (&WaveSpeed, &bool))| {
            let (ray, _) = Ray::about(index, speed, axis)?;
            Ok(if *paired { ray.mixed() } else { ray })
        };
        self.measured.iter().zip(self.paired).enumerate().map(ray).collect()
    }

    /// The medium from the linear problem, in which every polarization is exactly that of a mode, and its sum
    /// of squares.
    pub(super) fn linear(&self, axis: &Vec3) -> Option<(Column, f64)> {
        Problem::new(&self.rays(axis).ok()?, self.weights).linear()
    }

    /// The best medium about `axis`, searched from `start`.
    pub(super) fn stand(&self, axis: Vec3, start: Column) -> Option<Stand> {
        let rays = self.rays(&axis).ok()?;
        let problem = Problem::new(&rays, self.weights);
        let point = problem.descend(start).or_else(|| problem.starts().find_map(|s| problem.descend(s)))?;
        Some(Stand { axis, point })
    }

    /// The local optimum of the axis, searched from `start`.
    pub(super) fn descend(&self, start: Stand) -> Stand {
        let mut here = start;
        let Some(mut tilts) = self.tilts(&here) else { return here };
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let damped = tilts.curvature + Matrix2::identity() * damping * tilts.curvature.trace().max(1e-12);
            let Some(step) = damped.cholesky().map(|c| -c.solve(&tilts.gradient)) else { break };
            let step = step * (LONGEST / step.norm()).min(1.0);
            if step.norm() < SHORTEST {
                break;
            }
            match self.stand(tilts.tilted(&here.axis, &step), here.point.specific) {
                Some(next) if next.point.cost < here.point.cost => {
                    here = next;
                    damping *= 0.1;
                    tilts = match self.tilts(&here) {
                        Some(tilts) => tilts,
                        None => break,
                    };
                }
                _ if damping > 1e6 => break,
                _ => damping *= 10.0,
            }
        }
        here
    }

    /// The derivatives at `here`; `None` if there is no medium for a tilted axis.
    pub(super) fn tilts(&self, here: &Stand) -> Option<Tilts> {
        let one = here.axis.cross(&Mat3::identity().column(here.axis.iamin())).normalize();
        let mut tilts = Tilts {
            towards: [one, here.axis.cross(&one)],
            curvature: Matrix2::zeros(),
            gradient: Vector2::zeros(),
        };
        let residuals = |step: Vector2<f64>| {
            let stand = self.stand(tilts.tilted(&here.axis, &step), here.point.specific)?;
            Some(stand.point.rows.into_iter().map(|(residual, _)| residual))
        };
        let slopes = |step: Vector2<f64>| {
            let pairs = residuals(step)?.zip(residuals(-step)?);
            Some(pairs.map(|(up, down)| (up - down) / (2.0 * TILT)).collect::<Vec<f64>>())
        };
        let (a, b) = (slopes(Vector2::x() * TILT)?, slopes(Vector2::y() * TILT)?);
        for (i, ((residual, _), weight)) in here.point.rows.iter().zip(self.weights).enumerate() {
            let slope = Vector2::new(a[i], b[i]);
            tilts.curvature += *weight * slope * slope.transpose();
            tilts.gradient += *weight * *residual * slope;
        }
        Some(tilts)
    }
}

impl Tilts {
    /// The axis tilted by these angles towards the two directions, rad.
    pub(super) fn tilted(&self, axis: &Vec3, step: &Vector2<f64>) -> Vec3 {
        (axis + self.towards[0] * step.x + self.towards[1] * step.y).normalize()
    }
}
