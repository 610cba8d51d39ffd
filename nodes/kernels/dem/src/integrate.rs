//! Moving grains and cell over one step.

use crate::engine::Setting;
use crate::state::{Soa, State};
use grains::Mat3;

/// What one step did, for the checks that follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    /// Largest v² of a grain, m²/s², among those that are numbers.
    pub(crate) largest_square_speed: f64,
    /// Largest |displacement|² relative to the affine motion since the neighbour list was built, m².
    pub(crate) largest_square_travel: f64,
    /// Sum of v² over grains, m²/s²; not finite if the state is lost.
    pub(crate) sum_square_speed: f64,
}

/// Kick and drift: velocities relative to the affine motion (v̇ = F/m − L v), positions with it (ẋ = v + L x).
///
/// `travel` holds each grain's displacement relative to the affine motion since the neighbour list was built.
pub(crate) fn kick_and_drift(state: &mut State, travel: &mut Soa, setting: &Setting) -> Moved {
    let dt = state.time_step;
    let rate = state.rate;
    // Drag stops a grain, it never turns it round.
    let keep = (1.0 - setting.drag * dt).max(0.0);
    let mut moved = Moved { largest_square_speed: 0.0, largest_square_travel: 0.0, sum_square_speed: 0.0 };
    for i in 0..state.grains() {
        let v = state.velocity.get(i);
        let v = (v + (state.force.get(i) * state.inverse_mass[i] - rate * v) * dt) * keep;
        let x = state.position.get(i);
        let d = travel.get(i) + v * dt;
        state.velocity.set(i, v);
        state.position.set(i, x + (v + rate * x) * dt);
        travel.set(i, d);
        let speed = v.norm_squared();
        moved.sum_square_speed += speed;
        moved.largest_square_speed = moved.largest_square_speed.max(speed);
        moved.largest_square_travel = moved.largest_square_travel.max(d.norm_squared());
    }
    moved
}

/// Spins over one step; only where friction turns grains.
pub(crate) fn spin_up(state: &mut State, setting: &Setting) {
    let dt = state.time_step;
    let keep = (1.0 - setting.spin_drag * dt).max(0.0);
    for i in 0..state.grains() {
        let w = (state.spin.get(i) + state.torque.get(i) * (state.inverse_inertia[i] * dt)) * keep;
        state.spin.set(i, w);
    }
}

/// I + L dt: what the affine motion does to the cell in one step.
pub(crate) fn stretch(state: &State) -> Mat3 {
    Mat3::identity() + state.rate * state.time_step
}
