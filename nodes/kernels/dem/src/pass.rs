//! One pass over all contacts: forces and torques on grains.

use crate::engine::{Features, Setting};
use crate::law::{Law, Touch};
use crate::pairs::Pairs;
use crate::state::State;
use grains::Vec3;
use scene::Tangential;

/// Evaluates forces at the present positions. Where `advance` the tangential history is brought forward by one step;
/// else (after a resume) it is taken as it is, with the same result.
pub(crate) fn evaluate(state: &mut State, pairs: &mut Pairs, setting: &Setting, advance: bool) {
    let rescaled = setting.tangential == Tangential::Rescaled;
    match (setting.features(), rescaled, advance) {
        (Features::Frictionless, ..) => frictionless(state, pairs, setting),
        (Features::Coulomb, true, true) => frictional::<true, true, true>(state, pairs, setting),
        (Features::Coulomb, false, true) => frictional::<true, true, false>(state, pairs, setting),
        (Features::Stuck, true, true) => frictional::<true, false, true>(state, pairs, setting),
        (Features::Stuck, false, true) => frictional::<true, false, false>(state, pairs, setting),
        (Features::Coulomb, _, false) => frictional::<false, true, false>(state, pairs, setting),
        (Features::Stuck, _, false) => frictional::<false, false, false>(state, pairs, setting),
    }
}

fn frictionless(state: &mut State, pairs: &mut Pairs, setting: &Setting) {
    let law = Law::new(&state.material, 0.0, setting.damping);
    state.force.fill(0.0);
    for p in 0..pairs.len() {
        let (i, j) = (pairs.i[p] as usize, pairs.j[p] as usize);
        let branch = pairs.branch(p, &state.position);
        let reach = state.radius[i] + state.radius[j];
        let square = branch.norm_squared();
        if square >= reach * reach {
            pairs.overlap[p] = 0.0;
            continue;
        }
        let touch = touch(state, i, j, branch, square, reach, pairs.overlap[p]);
        pairs.overlap[p] = touch.overlap;
        let force = touch.normal * law.frictionless(&touch);
        state.force.add(i, -force);
        state.force.add(j, force);
    }
}

fn frictional<const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool>(
    state: &mut State,
    pairs: &mut Pairs,
    setting: &Setting,
) {
    let law = Law::new(&state.material, setting.friction, setting.damping);
    let dt = state.time_step;
    state.force.fill(0.0);
    state.torque.fill(0.0);
    for p in 0..pairs.len() {
        let (i, j) = (pairs.i[p] as usize, pairs.j[p] as usize);
        let branch = pairs.branch(p, &state.position);
        let reach = state.radius[i] + state.radius[j];
        let square = branch.norm_squared();
        if square >= reach * reach {
            if pairs.overlap[p] > 0.0 {
                pairs.overlap[p] = 0.0;
                pairs.tangential.set(p, Vec3::zeros());
            }
            continue;
        }
        let mut touch = touch(state, i, j, branch, square, reach, pairs.overlap[p]);
        let (spin_i, spin_j) = (state.spin.get(i), state.spin.get(j));
        let lever_i = state.radius[i] - 0.5 * touch.overlap;
        let lever_j = state.radius[j] - 0.5 * touch.overlap;
        touch.rolling = spin_i * lever_i + spin_j * lever_j;
        touch.spin = 0.5 * (spin_i + spin_j);
        let f = law.frictional::<ADVANCE, SLIDING, RESCALED>(&touch, pairs.tangential.get(p), dt);
        pairs.overlap[p] = touch.overlap;
        if ADVANCE {
            pairs.tangential.set(p, f.history);
        }
        let force = touch.normal * f.normal - f.tangential;
        state.force.add(i, -force);
        state.force.add(j, force);
        let moment = touch.normal.cross(&f.tangential);
        state.torque.add(i, moment * lever_i);
        state.torque.add(j, moment * lever_j);
    }
}

#[inline(always)]
fn touch(
    state: &State,
    i: usize,
    j: usize,
    branch: Vec3,
    square: f64,
    reach: f64,
    previous_overlap: f64,
) -> Touch {
    let distance = square.sqrt();
    let (m_i, m_j) = (state.inverse_mass[i], state.inverse_mass[j]);
    Touch {
        normal: branch / distance,
        distance,
        overlap: reach - distance,
        previous_overlap,
        r_eff: state.radius[i] * state.radius[j] / reach,
        m_eff: 1.0 / (m_i + m_j),
        relative: state.velocity.get(j) - state.velocity.get(i) + state.rate * branch,
        rolling: Vec3::zeros(),
        spin: Vec3::zeros(),
    }
}
