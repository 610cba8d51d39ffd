//! Puts grains that are neighbours in space next to each other in memory.

use crate::domain::state::{State, vector};
use crate::pairs::contacts::Contacts;
use crate::pairs::types::{History, SavedContact};

/// The order of grains along a space-filling (Morton) curve through the cell: a function of positions and ids alone. Grains
/// of one bin are sorted by id.
pub(super) fn along_curve(state: &State) -> Vec<u32> {
    let key = |g: &u32| {
        let g = *g as usize;
        (state.cell.place_on_curve(&vector(&state.position[g])), state.ids[g])
    };
    let mut order: Vec<u32> = (0..state.len() as u32).collect();
    order.sort_by_cached_key(key);
    order
}

/// Puts the grains in a new order. Pairs keep their history.
pub(super) fn reorder(state: &mut State, contacts: &Contacts, order: &[u32]) -> Contacts {
    fn permute<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
        *values = order.iter().map(|g| values[*g as usize]).collect();
    }
    permute(&mut state.ids, order);
    permute(&mut state.radius, order);
    permute(&mut state.inverse_mass, order);
    permute(&mut state.inverse_inertia, order);
    permute(&mut state.position, order);
    permute(&mut state.twist, order);
    let mut new_index = vec![0u32; order.len()];
    for (new, old) in order.iter().enumerate() {
        new_index[*old as usize] = new as u32;
    }
    let renumbered = |c: SavedContact| {
        let (i, j) = (new_index[c.i as usize], new_index[c.j as usize]);
        if i <= j {
            return SavedContact { i, j, ..c };
        }
        // Seen from the other grain, the image is on the other side and the tangential force is opposite. The rolling force
        // is the same: normal and torque are both opposite.
        let history = History { tangential: -c.history.tangential, ..c.history };
        SavedContact { i: j, j: i, image: c.image.map(|k| -k), history }
    };
    let mut pairs: Vec<SavedContact> = contacts.saved().map(renumbered).collect();
    pairs.sort_unstable_by_key(|p| (p.i, p.j, p.image));
    Contacts::from_saved(state, pairs)
}
