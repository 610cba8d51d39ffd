//! The commands of an exchange: velocities with the affine motion, a deforming box, steps, and velocities without it.

use crate::frame::{Affine, Frame, spin};
use grainlab_core::{Mat3, Vec3};
use grainlab_dem::EngineSettings;
use std::fmt::Write as _;

/// Variables that are observed at the last step: pressure, twice the number of contacts, sums over grains of u², |F| and 1
/// (without rattlers), over contacts of F_n; the largest F_n and u², the smallest distance.
pub(crate) const OBSERVED: [&str; 14] = [
    "c_stress[1]", "c_stress[2]", "c_stress[3]", "c_stress[4]", "c_stress[5]", "c_stress[6]", "c_sums[1]", "c_sums[2]",
    "c_sums[3]", "c_sums[4]", "c_forces", "c_largest", "c_fastest", "c_closest",
];

/// Largest product of drag and time in one exchange: drag acts at its beginning.
const DRAG: f64 = 0.05;

/// Number of the first step in LAMMPS: more than any exchange has steps.
pub(crate) const FIRST_STEP: u64 = 1_000_000_000;

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
        let drag = settings.drag.max(settings.spin_drag);
        (DRAG / (drag * dt)).clamp(1.0, f64::from(u32::MAX)) as u32
    }

    /// The computes that every step is observed with.
    pub(crate) fn computes(min_contacts: u32, frictional: bool) -> String {
        let spins = if frictional { " c_spins[1] c_spins[4]" } else { "" };
        let thermo = OBSERVED.join(" ");
        format!(
            "compute stress all pressure NULL pair\n\
             compute touching all contact/atom\n\
             compute contacts all pair/local dx dy dz p1 p2 p3 force dist cutoff radius\n\
             compute ids all property/local patom1 patom2 cutoff radius\n\
             variable ux atom vx\nvariable uy atom vy\nvariable uz atom vz\n\
             variable u2 atom v_ux^2+v_uy^2+v_uz^2\n\
             variable backbone atom c_touching>={min_contacts}\n\
             variable net atom v_backbone*sqrt(fx^2+fy^2+fz^2)\n\
             compute sums all reduce sum c_touching v_u2 v_net v_backbone{spins}\n\
             compute fastest all reduce max v_u2\n\
             compute forces all reduce sum c_contacts[7] inputs local\n\
             compute largest all reduce max c_contacts[7] inputs local\n\
             compute closest all reduce min c_contacts[8] inputs local\n\
             thermo_style custom step {thermo}\nthermo_modify norm no lost error\nthermo 0\n"
        )
    }

    /// Velocities relative to an affine motion, half a step before the positions.
    pub(crate) fn relative_velocities(affine: &Mat3, dt: f64) -> String {
        let row = |k: usize| {
            let axis = AXES[k];
            let [x, y, z] = [0, 1, 2].map(|c| affine[(k, c)]);
            let half = 0.5 * dt;
            format!("variable u{axis} atom v{axis}-f{axis}*({half:e})/mass-({x:e})*x-({y:e})*y-({z:e})*z\n")
        };
        [0, 1, 2].map(row).concat()
    }

    /// Volume of the box at its last step, one step ahead, over that of the cell.
    pub(crate) fn volume_ratio(&self) -> f64 {
        (Mat3::identity() + self.affine.last * self.dt).determinant()
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
            let _ = writeln!(before, "fix held all store/state 0 fx fy fz\nchange_box all {} units box", edges(&ahead));
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
                let _ = writeln!(before, "variable w{axis} atom ({spin_drag:e})*c_spins[{}]+({change:e})", k + 1);
            }
            before += "set group all omega v_wx v_wy v_wz\n";
            now = first;
        }
        if !is_fixed {
            let ahead = self.to.edges + self.affine.last * self.to.edges * self.dt;
            let _ = writeln!(before, "fix box all deform 1 {} remap v flip no units box", edges(&ahead));
        }
        before += &Self::relative_velocities(&self.affine.last, self.dt);
        let _ = writeln!(before, "run {} post no", self.steps);
        let mut after = String::new();
        if !is_fixed {
            after += &Self::change_velocities(1.0, &-self.affine.last);
            let _ = writeln!(after, "unfix box\nunfix hold\nunfix held\nchange_box all {} units box", edges(&self.to.edges));
        }
        (before, after, now)
    }

    /// v becomes g v + L x.
    fn change_velocities(factor: f64, l: &Mat3) -> String {
        if factor == 1.0 && *l == Mat3::zeros() {
            return String::new();
        }
        let row = |k: usize| {
            let (axis, [x, y, z]) = (AXES[k], [0, 1, 2].map(|c| l[(k, c)]));
            format!("variable v{axis} atom ({factor:e})*v{axis}+({x:e})*x+({y:e})*y+({z:e})*z\n")
        };
        [0, 1, 2].map(row).concat() + "velocity all set v_vx v_vy v_vz units box\n"
    }
}

/// The arguments that set the box.
fn edges(e: &Mat3) -> String {
    let [x, y, z, xy, xz, yz] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|k| e[k]);
    format!("x final 0 {x:e} y final 0 {y:e} z final 0 {z:e} xy final {xy:e} xz final {xz:e} yz final {yz:e}")
}
