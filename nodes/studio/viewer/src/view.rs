//! One packing as it is drawn.

use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_pictures::{Drawn, DrawnContact};

/// Most grains that are drawn, for a browser takes no more; of a larger packing a part of half as many is.
const MOST_GRAINS: usize = 200_000;

/// Most distant periodic image of a drawn contact, cell vectors. Only cells of one or two grains have others.
const FARTHEST: i32 = 2;

/// A packing as it is drawn: grains within the cell, each with its contacts.
#[derive(Clone, Debug)]
pub struct View {
    /// Name of the state, as readers see it.
    pub label: String,
    /// Description of the part of the packing that is drawn; None for all of it.
    pub part: Option<String>,
    /// The periodic cell, or the corner of it that is drawn.
    pub(crate) cell: Cell,
    pub(crate) ids: Vec<u32>,
    /// Positions in units of its vectors, from 0 to 1.
    pub(crate) places: Vec<Vec3>,
    /// Radii of grains, m.
    pub(crate) radii: Vec<f64>,
    /// Contacts of each grain that are not with rattlers.
    pub(crate) coordination: Vec<u32>,
    pub(crate) rattler: Vec<bool>,
    /// Mean normal force of the contacts of each grain, N; 0 without contacts.
    pub(crate) force: Vec<f64>,
    /// The contacts, sorted by their first grain.
    pub(crate) contacts: Vec<DrawnContact>,
}

impl View {
    /// A packing, with the name of its state. Of more than 200,000 grains those in a corner of the cell are drawn, and
    /// contacts between them.
    pub fn new(packing: &Packing, label: impl Into<String>) -> Self {
        let Drawn { places, coordination, rattler, force, mut contacts, .. } = Drawn::new(packing);
        contacts.retain(|c| c.image.iter().all(|k| k.abs() <= FARTHEST));
        let whole = Self {
            label: label.into(),
            part: None,
            cell: packing.cell,
            ids: packing.ids.clone(),
            places,
            radii: packing.radii.clone(),
            coordination,
            rattler,
            force,
            contacts,
        };
        if whole.grains() > MOST_GRAINS { whole.corner(MOST_GRAINS / 2) } else { whole }
    }

    /// The `most` grains nearest to the corner of the cell at its origin, in equal shares of all edges.
    fn corner(&self, most: usize) -> Self {
        let far = |g: usize| self.places[g].max();
        let mut grains: Vec<usize> = (0..self.grains()).collect();
        grains.select_nth_unstable_by(most, |a, b| far(*a).total_cmp(&far(*b)).then(a.cmp(b)));
        let share = far(grains[most]);
        let Some(cell) = Cell::new(self.matrix() * share) else { return self.clone() };
        grains.truncate(most);
        grains.sort_unstable();
        let mut number = vec![None; self.grains()];
        grains.iter().zip(0u32..).for_each(|(g, n)| number[*g] = Some(n));
        let inside = |c: &DrawnContact| {
            let (i, j) = (number[c.i as usize]?, number[c.j as usize]?);
            (c.image == [0; 3]).then_some(DrawnContact { i, j, ..*c })
        };
        Self {
            label: self.label.clone(),
            part: Some(format!(
                "{most} of {} grains are drawn: a corner of {share:.2} of each edge of the cell",
                self.grains()
            )),
            cell,
            ids: grains.iter().map(|g| self.ids[*g]).collect(),
            places: grains.iter().map(|g| self.places[*g] / share).collect(),
            radii: grains.iter().map(|g| self.radii[*g]).collect(),
            coordination: grains.iter().map(|g| self.coordination[*g]).collect(),
            rattler: grains.iter().map(|g| self.rattler[*g]).collect(),
            force: grains.iter().map(|g| self.force[*g]).collect(),
            contacts: self.contacts.iter().filter_map(inside).collect(),
        }
    }

    /// Number of grains drawn.
    pub fn grains(&self) -> usize {
        self.ids.len()
    }

    /// The cell vectors as columns, m.
    pub(crate) fn matrix(&self) -> &Mat3 {
        self.cell.matrix()
    }

    /// Largest radius, m.
    pub(crate) fn largest_radius(&self) -> f64 {
        self.radii.iter().copied().fold(0.0, f64::max)
    }

    /// Largest normal force of a contact, N.
    pub(crate) fn largest_force(&self) -> f64 {
        self.contacts.iter().map(|c| c.force).fold(0.0, f64::max)
    }

    /// The force that has the last colour of the ramp: three times the mean of the contacts, N.
    pub(crate) fn force_of_full_colour(&self) -> f64 {
        let sum: f64 = self.contacts.iter().map(|c| c.force).sum();
        if self.contacts.is_empty() { 0.0 } else { 3.0 * sum / self.contacts.len() as f64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::Contact;

    /// Grains on a cubic lattice, numbered along z first, each in contact with the next one and with the one across the cell.
    fn lattice(edge: usize) -> Packing {
        let at = |n: usize| Vec3::new((n / edge / edge) as f64, (n / edge % edge) as f64, (n % edge) as f64);
        let count = edge.pow(3);
        let contact = |n: usize| {
            let across = n % edge == edge - 1;
            let next = if across { n + 1 - edge } else { n + 1 };
            Contact::pressed([n as u32, next as u32], [0, 0, i8::from(across)], -Vec3::z(), 1e-6, 1.0)
        };
        Packing {
            ids: (0..count as u32).map(|n| n + 7).collect(),
            contacts: (0..count).map(contact).collect(),
            friction: 0.3,
            ..Packing::at_rest(
                Cell::cube(edge as f64).unwrap(),
                vec![0.5; count],
                (0..count).map(|n| at(n) + Vec3::repeat(0.5)).collect(),
            )
        }
    }

    #[test]
    fn of_a_large_packing_a_corner_is_drawn_and_the_view_says_so() {
        let small = View::new(&lattice(58), "");
        assert_eq!((small.grains(), small.contacts.len(), &small.part), (58 * 58 * 58, 58 * 58 * 58, &None));
        let part = View::new(&lattice(60), "");
        assert_eq!(
            part.part.as_deref(),
            Some("100000 of 216000 grains are drawn: a corner of 0.78 of each edge of the cell")
        );
        let edge = part.matrix()[(0, 0)];
        assert!((edge - 46.5).abs() < 1e-9, "{edge}");
        assert!(part.places.iter().all(|x| x.min() >= 0.0 && x.max() <= 1.0));
        assert_eq!((part.ids[0], part.ids[1], part.ids[47]), (7, 8, 7 + 60), "the numbers of the packing");
        assert_eq!(part.ids.len(), 100_000);
        assert!(
            part.contacts
                .iter()
                .all(|c| c.image == [0; 3] && part.ids[c.j as usize] == part.ids[c.i as usize] + 1)
        );
    }
}
