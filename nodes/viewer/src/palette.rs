//! Colours of grains, distinct under colour blindness.

use crate::view::View;

/// Red, green and blue, 0 to 255.
pub(crate) type Colour = [u8; 3];

/// What the colours of the grains show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Contacts that are not with rattlers.
    #[default]
    Coordination,
    /// Mean normal force of the contacts.
    Force,
    /// Whether a grain carries force.
    Rattlers,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Coordination, Self::Force, Self::Rattlers];

    /// As commands and pages name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Coordination => "coordination",
            Self::Force => "force",
            Self::Rattlers => "rattlers",
        }
    }
}

/// From little to much: the lighter part of the map `batlow` (Crameri), equal steps of which look equal.
pub(crate) const RAMP: [Colour; 7] = [
    [26, 62, 94],
    [40, 96, 101],
    [84, 120, 79],
    [143, 136, 56],
    [214, 148, 84],
    [247, 173, 146],
    [252, 205, 222],
];

/// Contacts of a grain with a colour of their own; grains with more have that of the last.
pub(crate) const MOST_CONTACTS: usize = 9;

/// A rattler.
pub(crate) const RATTLER: Colour = [196, 196, 204];

/// A grain that carries force, where only this is shown.
pub(crate) const CARRIER: Colour = [46, 104, 150];

/// The colour of a share from 0 to 1.
pub(crate) fn ramp(share: f64) -> Colour {
    let x = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let k = (x as usize).min(RAMP.len() - 2);
    std::array::from_fn(|c| {
        let [from, to] = [RAMP[k][c], RAMP[k + 1][c]].map(f64::from);
        (from + (x - k as f64) * (to - from)).round() as u8
    })
}

/// Colours by number of contacts, from none.
pub(crate) fn by_coordination() -> Vec<Colour> {
    // Grains with fewer than two contacts are rattlers.
    (0..=MOST_CONTACTS).map(|n| ramp((n as f64 - 2.0) / (MOST_CONTACTS - 2) as f64)).collect()
}

/// The colour of each grain.
pub(crate) fn colours(view: &View, quantity: Quantity) -> Vec<Colour> {
    let (top, table) = (view.force_of_full_colour(), by_coordination());
    let of = |grain: usize| match quantity {
        Quantity::Force => ramp(if top > 0.0 { view.force[grain] / top } else { 0.0 }),
        _ if view.rattler[grain] => RATTLER,
        Quantity::Rattlers => CARRIER,
        Quantity::Coordination => table[(view.coordination[grain] as usize).min(MOST_CONTACTS)],
    };
    (0..view.grains()).map(of).collect()
}
