//! Hard elastic spheres in a shrinking periodic cell, moved from collision to collision.
//!
//! The event-driven gas of Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990): between collisions every grain
//! flies straight in a fixed cell while its diameter grows; lengths are then scaled back, so that the grains keep their
//! size and the cell has shrunk. One interval at a time: nothing but positions, velocities and cell outlives it, so a
//! state saved between two intervals goes on bit for bit.
//!
//! - `slice`: the events of one interval
//! - `pair`: when two grains meet and what it does to them
//! - `grid`: a grid of cells to find near grains in
//! - `queue`: whose event is next

mod grid;
mod pair;
mod queue;
mod slice;

use crate::error::DemError;
use grainlab_core::{Cell, Mat3, Vec3};
use slice::Slice;

/// Events per grain, over the number of collisions that [`mean_free_time`] leads to expect (to which ten are added, for
/// short intervals), beyond which the gas counts as jammed: the gaps are then below some thousandth of a diameter.
const JAMMED: f64 = 100.0;

/// An overlap below this share of the distance of contact is rounding.
const ROUNDING: f64 = 1e-9;

/// Hard spheres: frictionless, elastic, of one density.
#[derive(Clone, Debug, PartialEq)]
pub struct HardSpheres {
    cell: Cell,
    radii: Vec<f64>,
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
}

/// What happened during an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collisions {
    /// Collisions of two grains.
    pub count: u64,
    /// Compressibility factor pV/NkT, from the momentum that collisions carried; 1 for grains that never met, and where
    /// nothing moves.
    pub compressibility: f64,
}

impl HardSpheres {
    /// Spheres of `radii` (m) at `positions` (m, any periodic image) with `velocities` (m/s, relative to the affine
    /// motion) in a cell whose edges lie along the axes. Overlaps are found by [`HardSpheres::advance`].
    pub fn new(
        cell: Cell,
        radii: Vec<f64>,
        positions: Vec<Vec3>,
        velocities: Vec<Vec3>,
    ) -> Result<Self, DemError> {
        let refuse = |what: String| Err(DemError::HardSpheres(what));
        let edges = cell.matrix();
        if edges != &Mat3::from_diagonal(&edges.diagonal()) {
            return refuse("the edges of the cell must lie along the axes".into());
        }
        let n = radii.len();
        if positions.len() != n || velocities.len() != n {
            let (p, v) = (positions.len(), velocities.len());
            return refuse(format!("{n} radii come with {p} positions and {v} velocities"));
        }
        if let Some(i) = radii.iter().position(|r| !(*r > 0.0 && r.is_finite())) {
            return refuse(format!("the radius of grain {i} is {} m; it must be more than 0", radii[i]));
        }
        let finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
        if let Some(i) = (0..n).find(|i| !finite(&positions[*i]) || !finite(&velocities[*i])) {
            return refuse(format!("position or velocity of grain {i} is not finite"));
        }
        Ok(Self { cell, radii, positions, velocities })
    }

    /// The cell.
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// Centres, unwrapped, m.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Velocities relative to the affine motion, m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// Volume of the spheres over volume of the cell.
    pub fn solid_fraction(&self) -> f64 {
        let solid: f64 = self.radii.iter().map(|r| r.powi(3)).sum();
        4.0 / 3.0 * std::f64::consts::PI * solid / self.cell.volume()
    }

    /// Root mean square speed, m/s.
    pub fn speed(&self) -> f64 {
        let sum: f64 = self.velocities.iter().map(Vec3::norm_squared).sum();
        (sum / self.velocities.len().max(1) as f64).sqrt()
    }

    /// Scales all velocities so that the root mean square speed is at most `cap`, m/s: the thermostat.
    pub fn limit_speed(&mut self, cap: f64) {
        let speed = self.speed();
        if speed > cap {
            self.velocities.iter_mut().for_each(|v| *v *= cap / speed);
        }
    }

    /// Moves on by `interval` (s, more than 0) while every axis of the cell strains at `rate` (1/s, negative in
    /// compression). Returns the deformation of the cell, e^{rate·interval} along each axis, and what collided.
    ///
    /// With x = s X, s = e^{rate t} and dθ = dt/s, centres X move uniformly in θ in a fixed cell while diameters are
    /// D(1 − rate θ) exactly; velocities relative to the affine motion are dX/dθ. Two grains in contact rebound with
    /// their relative velocity reversed, affine part included, so that compression heats the gas.
    ///
    /// # Errors
    /// [`DemError::HardSpheres`] where grains overlap by more than rounding at the beginning or `interval` is no time;
    /// [`DemError::Jammed`] where collisions multiply without the gas getting on, or the cell becomes narrower than a
    /// grain. The state is then that of the beginning.
    pub fn advance(&mut self, rate: f64, interval: f64) -> Result<(Mat3, Collisions), DemError> {
        let stretch = (rate * interval).exp();
        if !(interval > 0.0 && stretch > 0.0 && (1.0 / stretch).is_finite()) {
            let what = format!("an interval of {interval} s at a strain rate of {rate} 1/s leads nowhere");
            return Err(DemError::HardSpheres(what));
        }
        // θ at the end; its limit for rate → 0 is the interval.
        let end = if rate == 0.0 { interval } else { (-rate * interval).exp_m1() / -rate };
        let deformation = Mat3::identity() * stretch;
        let cell = self.cell.deformed(&deformation);
        let cell = cell.ok_or_else(|| DemError::HardSpheres("the cell loses its volume".into()))?;
        let edges = self.cell.matrix().diagonal();
        let widest = 2.0 * self.radii.iter().copied().fold(0.0, f64::max) * (1.0 - rate * end).max(1.0);
        if edges.min() <= widest {
            let cause = "the cell has become narrower than a grain: more grains fit better".to_string();
            return Err(DemError::Jammed { solid_fraction: self.solid_fraction(), cause });
        }
        let mean = self.radii.iter().sum::<f64>() / self.radii.len().max(1) as f64;
        let expected = interval / mean_free_time(self.solid_fraction(), 2.0 * mean, self.speed());
        let limit = JAMMED * (10.0 + expected) * self.radii.len() as f64;
        let margin = 2.0 * mean * margin(self.solid_fraction());
        let margin = margin.min(0.5 * (edges.min() - widest));
        let mut slice =
            Slice::new(edges, &self.radii, &self.positions, &self.velocities, -rate, end, margin)?;
        let tally = slice.run(limit as u64).map_err(|e| {
            let solid_fraction = self.solid_fraction() * (1.0 - rate * e.reached).powi(3);
            let cause = format!("{limit:.0} events in one interval: its pressure has diverged");
            DemError::Jammed { solid_fraction, cause }
        })?;
        let energy = slice.twice_energy();
        slice.finish(stretch, &mut self.positions, &mut self.velocities);
        self.cell = cell;
        let carried = if energy > 0.0 { tally.impulse_length / (end * energy) } else { 0.0 };
        Ok((deformation, Collisions { count: tally.collisions, compressibility: 1.0 + carried }))
    }
}

/// How far a grain may move before its neighbours are listed anew, over its diameter: a share of the mean gap, and a
/// little more. A longer list costs each collision, a shorter one is made more often; the optimum is flat.
fn margin(solid_fraction: f64) -> f64 {
    0.08 + 0.6 * ((0.74 / solid_fraction).cbrt() - 1.0).max(0.0)
}

/// Mean time between two collisions of a grain, s, in a fluid of hard spheres of `diameter` (m) and root mean square
/// speed `speed` (m/s): Enskog's rate 4√π n D² χ √(kT/m) with the contact value χ = (1 − φ/2)/(1 − φ)³ of Carnahan &
/// Starling, J. Chem. Phys. 51, 635 (1969). Infinite at rest; good below freezing (φ = 0.49), an estimate above.
pub fn mean_free_time(solid_fraction: f64, diameter: f64, speed: f64) -> f64 {
    let contact = (1.0 - 0.5 * solid_fraction) / (1.0 - solid_fraction).powi(3);
    let thermal = speed / 3f64.sqrt();
    std::f64::consts::PI.sqrt() * diameter / (24.0 * solid_fraction * contact * thermal)
}
