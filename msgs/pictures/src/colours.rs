//! Colours of grains and forces.

use crate::drawn::Drawn;

/// Red, green and blue, 0 to 255.
pub type Colour = [u8; 3];

/// From little to much, from dark to light: as many colours as there are numbers of contacts. Neighbours differ by 9 or more
/// (CIEDE2000) with and without colour blindness, all of them from [`RATTLER`] by 14.
pub const RAMP: [Colour; 8] = [
    [40, 44, 120],
    [48, 95, 162],
    [4, 136, 126],
    [120, 151, 69],
    [168, 169, 20],
    [253, 165, 108],
    [252, 196, 177],
    [249, 238, 226],
];

/// Contacts of a grain with a colour of their own; grains with more have that of the last.
pub const MOST_CONTACTS: usize = 9;

/// Colour of rattlers.
pub const RATTLER: Colour = [196, 196, 204];

/// The colour of a share; shares below 0 and above 1 have the colours of the ends.
pub fn ramp(share: f64) -> Colour {
    let x = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let k = (x as usize).min(RAMP.len() - 2);
    std::array::from_fn(|c| {
        let [from, to] = [RAMP[k][c], RAMP[k + 1][c]].map(f64::from);
        (from + (x - k as f64) * (to - from)).round() as u8
    })
}

/// Colours by number of contacts, from none to [`MOST_CONTACTS`].
pub fn by_coordination() -> Vec<Colour> {
    // Grains with fewer than two contacts are rattlers.
    (0..=MOST_CONTACTS).map(|n| ramp((n as f64 - 2.0) / (MOST_CONTACTS - 2) as f64)).collect()
}

/// The colour of each grain: by coordination, rattlers grey.
pub(crate) fn of_grains(drawn: &Drawn<'_>) -> Vec<Colour> {
    let table = by_coordination();
    let of = |(rattler, contacts): (&bool, &u32)| match rattler {
        true => RATTLER,
        false => table[(*contacts as usize).min(MOST_CONTACTS)],
    };
    drawn.rattler.iter().zip(&drawn.coordination).map(of).collect()
}
