//! The commands of an exchange: velocities with the affine motion, a deforming box, steps, and velocities without it.

use crate::frame::{Affine, Frame, spin};
use grainlab_core::{Mat3, Vec3};
use grainlab_engine::EngineSettings;
use std::fmt::Write as _;

/// Number of quantities that are observed at the last step.
pub(crate) const OBSERVED: usize = 18;

/// Largest product of drag and time in one exchange: drag acts at its beginning.
const DRAG: f64 = 0.05;

/// Number of the first step in LAMMPS: more than any exchange has steps.
pub(crate) const FIRST_STEP: u64 = 1_000_000_000;

/// Keeps the forces of the last step for the next exchange, also in a restart file: a state that is read in between evaluates
/// others.
pub(crate) const HOLD: &str = "fix held all store/state 0 fx fy fz\n";

/// Some steps at one strain rate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exchange<'a> {
    pub(crate) steps: u32,
    /// Number of the present step in LAMMPS, more than `steps`.
    pub(crate) at: u64,
    /// Time step, s.
    pub(crate) dt: f64,
    /// The affine velocity; at its end the box is `to`.
    pub(crate) affine: Affine,
    pub(crate) from: &'a Frame,
    pub(crate) to: &'a Frame,
    pub(crate) settings: &'a EngineSettings,
    /// Angular velocity of the affine motion that spins contain, 1/s.
    pub(crate) spin: Vec3,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Exchange<'_> {
    /// Largest number of steps of one exchange.
    pub(crate) fn longest(settings: &EngineSettings, dt: f64) -> u32 {
        let drag =
            if settings.friction > 0.0 { settings.drag.max(settings.spin_drag) } else { settings.drag };
        (DRAG / (drag * dt)).clamp(1.0, f64::from(u32::MAX)) as u32
    }

    /// The computes that every step is observed with.
    pub(crate) fn computes(min_contacts: u32, frictional: bool) -> String {
        // That also brings spins up to date for where they are set.
        let torques = if frictional { "c_spins[4] c_spins[5] c_spins[6]" } else { "v_none v_none v_none" };
        format!(
            "compute stress all pressure NULL pair\n\
             compute touching all contact/atom\n\
             compute contacts all pair/local dx dy dz p1 p2 p3 cutoff radius\n\
             compute ids all property/local patom1 patom2 cutoff radius\n\
             variable none atom 0\nvariable ux atom vx\nvariable uy atom vy\nvariable uz atom vz\n\
             variable backbone atom c_touching>={min_contacts}\n\
             variable net atom (c_touching>={min_contacts})*sqrt(fx*fx+fy*fy+fz*fz)\n\
             compute sums all reduce sum c_touching v_net v_backbone {torques}\n\
             compute squares all reduce sumsq v_ux v_uy v_uz\n\
             compute fastest all reduce maxabs vx vy vz\n\
             thermo_style custom step\nthermo_modify norm no lost error\nthermo 0\n"
        )
    }

    /// Observes step `at`: pressure; twice the number of contacts; sums over grains without rattlers of |F| and 1, over all of u²,
    /// where u is relative to an affine motion, half a step before the positions; largest velocities; sum of torques.
    pub(crate) fn observe(affine: &Mat3, dt: f64, at: u64) -> String {
        let half = 0.5 * dt;
        let row = |k: usize| {
            let (axis, affine) = (AXES[k], linear(&-affine.row(k)));
            format!("variable u{axis} atom v{axis}-f{axis}*({half:e})/mass{affine}\n")
        };
        [0, 1, 2].map(row).concat()
            + &format!(
                "fix seen all ave/time 1 1 {at} c_stress[1] c_stress[2] c_stress[3] c_stress[4] c_stress[5] c_stress[6] c_sums[1] \
                 c_sums[2] c_sums[3] c_squares[1] c_squares[2] c_squares[3] c_fastest[1] c_fastest[2] c_fastest[3] \
                 c_sums[4] c_sums[5] c_sums[6]\n"
            )
    }

    /// The commands up to the last step, those after it was observed, and the angular velocity that spins then contain.
    pub(crate) fn commands(&self) -> (String, String, Vec3) {
        let factor = |drag: f64| (1.0 - drag * self.dt).max(0.0).powi(self.steps as i32);
        let (drag, spin_drag) = (factor(self.settings.drag), factor(self.settings.spin_drag));
        let is_fixed = self.affine == Affine::NONE;
        let mut before = String::new();
        if !is_fixed {
            // A deforming box is set at the end of a step. One step ahead, it is that of the positions at which forces are evaluated,
            // except at the beginning: there the forces of the step before are used again.
            let ahead = self.from.edges + self.affine.first * self.from.edges * self.dt;
            let _ = writeln!(before, "change_box all {} units box", edges(&ahead));
            for (k, axis) in AXES.into_iter().enumerate() {
                let _ = writeln!(before, "variable h{axis} atom f_held[{}]-f{axis}", k + 1);
            }
            let _ = writeln!(before, "fix hold all addforce v_hx v_hy v_hz every {}", self.at);
        }
        before += &Self::change_velocities(drag, &self.affine.first);
        let (old, first) = (self.spin, spin(&self.affine.first));
        let mut now = old;
        if self.settings.friction > 0.0 && (spin_drag != 1.0 || first != old) {
            for k in 0..3 {
                let (axis, change) = (AXES[k], first[k] - spin_drag * old[k]);
                let _ =
                    writeln!(before, "variable w{axis} atom ({spin_drag:e})*c_spins[{}]+({change:e})", k + 1);
            }
            before += "set group all omega v_wx v_wy v_wz\n";
            now = first;
        }
        if !is_fixed {
            let ahead = self.to.edges + self.affine.last * self.to.edges * self.dt;
            let _ = writeln!(before, "fix box all deform 1 {} remap v flip no units box", edges(&ahead));
        }
        before += &Self::observe(&self.affine.last, self.dt, self.at + u64::from(self.steps));
        let _ = writeln!(before, "run {} post no", self.steps);
        let mut after = format!("unfix held\n{HOLD}");
        if !is_fixed {
            after += &Self::change_velocities(1.0, &-self.affine.last);
            let _ =
                writeln!(after, "unfix box\nunfix hold\nchange_box all {} units box", edges(&self.to.edges));
        }
        (before, after, now)
    }

    /// v becomes g v + L x.
    fn change_velocities(factor: f64, l: &Mat3) -> String {
        if factor == 1.0 && *l == Mat3::zeros() {
            return String::new();
        }
        let row = |k: usize| {
            let (axis, affine) = (AXES[k], linear(&l.row(k).into_owned()));
            format!("variable v{axis} atom {factor:e}*v{axis}{affine}\n")
        };
        [0, 1, 2].map(row).concat() + "velocity all set v_vx v_vy v_vz units box\n"
    }
}

/// A linear function of the position, as further terms of a formula.
fn linear(row: &nalgebra::RowVector3<f64>) -> String {
    let terms = row.iter().zip(AXES).filter(|(c, _)| **c != 0.0);
    terms.map(|(c, axis)| format!("+({c:e})*{axis}")).collect()
}

/// The arguments that set the box.
fn edges(e: &Mat3) -> String {
    let [x, y, z, xy, xz, yz] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|k| e[k]);
    format!("x final 0 {x:e} y final 0 {y:e} z final 0 {z:e} xy final {xy:e} xz final {xz:e} yz final {yz:e}")
}
