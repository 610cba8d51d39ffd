//! Hard elastic spheres in a shrinking periodic cell, moved from collision to collision.
//!
//! The event-driven gas of Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990). Between collisions every grain moves
//! straight in a fixed cell while its diameter grows. Lengths are then scaled back, so that the grains keep their size and the
//! cell has shrunk. Only positions, velocities and cell are kept between two intervals, so a state saved between them goes on
//! bit for bit.

use super::interval::{Cut, Interval};
use crate::gas::error::GasError;
use grainlab_core::{Cell, Mat3, Vec3};

/// Limit of the events per grain, over the number of collisions expected from [`mean_free_time`] (plus ten, for short
/// intervals). Beyond it the gas is jammed: the gaps are then below about a thousandth of a diameter.
const JAMMED: f64 = 100.0;

/// Hard spheres: frictionless, elastic, of one density.
#[derive(Clone, Debug, PartialEq)]
pub struct HardSpheres {
    cell: Cell,
    radii: Vec<f64>,
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
}

/// The collisions of an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collisions {
    /// Number of collisions.
    pub count: u64,
    /// Compressibility factor pV/NkT, from the momentum that collisions carried; 1 without collisions, and where nothing
    /// moves.
    pub compressibility: f64,
}

impl HardSpheres {
    /// Spheres of `radii` (m) at `positions` (m, any periodic image) with `velocities` (m/s, relative to the affine
    /// motion) in a cell whose edges lie along the axes. [`HardSpheres::advance`] checks for overlaps.
    pub fn new(
        cell: Cell,
        radii: Vec<f64>,
        positions: Vec<Vec3>,
        velocities: Vec<Vec3>,
    ) -> Result<Self, GasError> {
        let error = |what: String| Err(GasError::HardSpheres(what));
        let edges = cell.matrix();
        if edges != &Mat3::from_diagonal(&edges.diagonal()) {
            return error("the edges of the cell must lie along the axes".into());
        }
        let n = radii.len();
        if positions.len() != n || velocities.len() != n {
            let (p, v) = (positions.len(), velocities.len());
            return error(format!("{n} radii come with {p} positions and {v} velocities"));
        }
        if let Some(i) = radii.iter().position(|r| !(*r > 0.0 && r.is_finite())) {
            return error(format!("the radius of grain {i} is {} m; it must be more than 0", radii[i]));
        }
        let finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
        if let Some(i) = (0..n).find(|i| !finite(&positions[*i]) || !finite(&velocities[*i])) {
            return error(format!("position or velocity of grain {i} is not finite"));
        }
        Ok(Self { cell, radii, positions, velocities })
    }

    /// The periodic cell.
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

    /// The thermostat: scales all velocities so that the root mean square speed is at most `limit`, m/s.
    pub fn apply_thermostat(&mut self, limit: f64) {
        let speed = self.speed();
        if speed > limit {
            self.velocities.iter_mut().for_each(|v| *v *= limit / speed);
        }
    }

    /// Advances by `interval` (s, more than 0) while every axis of the cell strains at `rate` (1/s, negative in compression).
    /// Returns the deformation of the cell, e^{rate·interval} along each axis, and the collisions.
    ///
    /// With x = s X, s = e^{rate t} and dθ = dt/s, centres X move uniformly in θ in a fixed cell while diameters are
    /// D(1 − rate θ) exactly; velocities relative to the affine motion are dX/dθ. A collision reverses the normal
    /// relative velocity, affine part included, so compression heats the gas.
    ///
    /// # Errors
    /// [`GasError::HardSpheres`] where grains overlap by more than rounding at the start or `interval` is not positive;
    /// [`GasError::Jammed`] where there are too many collisions, or the cell becomes narrower than a grain. The state is then
    /// unchanged.
    pub fn advance(&mut self, rate: f64, interval: f64) -> Result<(Mat3, Collisions), GasError> {
        self.advance_unless(rate, interval, &|| false)
    }

    /// Advances, unless `stopped` becomes true on the way.
    ///
    /// # Errors
    /// Those of [`HardSpheres::advance`], and [`GasError::Stopped`]; the state is then unchanged, too.
    pub fn advance_unless(
        &mut self,
        rate: f64,
        interval: f64,
        stopped: &dyn Fn() -> bool,
    ) -> Result<(Mat3, Collisions), GasError> {
        let stretch = (rate * interval).exp();
        if !(interval > 0.0 && stretch > 0.0 && (1.0 / stretch).is_finite()) {
            let what = format!("an interval of {interval} s at a strain rate of {rate} 1/s leads nowhere");
            return Err(GasError::HardSpheres(what));
        }
        // θ at the end; its limit for rate → 0 is the interval.
        let end = if rate == 0.0 { interval } else { (-rate * interval).exp_m1() / -rate };
        let deformation = Mat3::identity() * stretch;
        let cell = self.cell.deformed(&deformation);
        let cell = cell.ok_or_else(|| GasError::HardSpheres("the cell loses its volume".into()))?;
        let edges = self.cell.matrix().diagonal();
        let widest = 2.0 * self.radii.iter().copied().fold(0.0, f64::max) * (1.0 - rate * end).max(1.0);
        if edges.min() <= widest {
            let cause = "the cell has become narrower than a grain: more grains fit better".to_string();
            return Err(GasError::Jammed { solid_fraction: self.solid_fraction(), cause });
        }
        let mean = self.radii.iter().sum::<f64>() / self.radii.len().max(1) as f64;
        let expected = interval / mean_free_time(self.solid_fraction(), 2.0 * mean, self.speed());
        let limit = JAMMED * (10.0 + expected) * self.radii.len() as f64;
        let margin = 2.0 * mean * margin(self.solid_fraction());
        let margin = margin.min(0.5 * (edges.min() - widest));
        let Self { radii, positions, velocities, .. } = &*self;
        let mut events = Interval::new(edges, radii, positions, velocities, (-rate, end), margin, stopped)?;
        let counts = events.run(limit as u64, stopped).map_err(|e| match e {
            Cut::Stopped => GasError::Stopped,
            Cut::Limit { reached } => {
                let solid_fraction = self.solid_fraction() * (1.0 - rate * reached).powi(3);
                let cause = format!("{limit:.0} events in one interval: its pressure has diverged");
                GasError::Jammed { solid_fraction, cause }
            }
        })?;
        let energy = events.twice_energy();
        events.finish(stretch, &mut self.positions, &mut self.velocities);
        self.cell = cell;
        let carried = if energy > 0.0 { counts.impulse_length / (end * energy) } else { 0.0 };
        Ok((deformation, Collisions { count: counts.collisions, compressibility: 1.0 + carried }))
    }
}

/// Distance that a grain may move before its list of neighbours is renewed, over its diameter: a fraction of the mean gap, and
/// a little more. A longer list makes each collision slower, a shorter one must be renewed more often; the optimum is flat.
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
