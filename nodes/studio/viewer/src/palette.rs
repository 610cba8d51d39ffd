//! Quantities that the colours of grains show.

use crate::view::View;
pub(crate) use grainlab_pictures::{Colour, MOST_CONTACTS, RAMP, RATTLER, by_coordination, ramp};

/// Quantity that the colours of the grains show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Contacts that are not with rattlers.
    #[default]
    Coordination,
    /// Mean normal force of the contacts.
    Force,
    /// Grains that carry force, and rattlers.
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

/// A grain that carries force, where only this is shown.
pub(crate) const CARRIER: Colour = [46, 104, 150];

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
