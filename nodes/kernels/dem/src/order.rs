//! Putting grains that are neighbours in space next to each other in memory.

use crate::contacts::{Contacts, Kept};
use crate::state::{State, vector};

/// Where each grain comes along a space-filling (Morton) curve through the cell: a function of positions alone. Grains
/// of one bin follow each other by id.
pub(crate) fn along_curve(state: &State) -> Vec<u32> {
    let place = |g: &u32| {
        let g = *g as usize;
        (state.cell.place_on_curve(&vector(&state.position[g])), state.ids[g])
    };
    let mut order: Vec<u32> = (0..state.grains() as u32).collect();
    order.sort_by_cached_key(place);
    order
}

/// Takes the grains in a new order; pairs keep their history.
pub(crate) fn reorder(state: &mut State, contacts: &Contacts, order: &[u32]) -> Contacts {
    fn take<T: Copy>(from: &mut Vec<T>, order: &[u32]) {
        *from = order.iter().map(|g| from[*g as usize]).collect();
    }
    take(&mut state.ids, order);
    take(&mut state.radius, order);
    take(&mut state.inverse_mass, order);
    take(&mut state.inverse_inertia, order);
    take(&mut state.position, order);
    take(&mut state.twist, order);
    let mut place = vec![0u32; order.len()];
    for (new, old) in order.iter().enumerate() {
        place[*old as usize] = new as u32;
    }
    let moved = |(i, j, image, root, history): Kept| {
        let (i, j) = (place[i as usize], place[j as usize]);
        // Seen from the other grain the image is on the other side, and the force is the opposite.
        if i <= j { (i, j, image, root, history) } else { (j, i, image.map(|k| -k), root, -history) }
    };
    let mut pairs: Vec<Kept> = contacts.kept().map(moved).collect();
    pairs.sort_unstable_by_key(|p| (p.0, p.1, p.2));
    let count = pairs.len();
    Contacts::of(state, pairs.into_iter(), count)
}
