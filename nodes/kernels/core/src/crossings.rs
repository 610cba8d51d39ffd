//! Number of contacts through planes across the cell: a periodic packing has no plane that few contacts cross.

use crate::notes::Note;
use crate::packing::{Contact, Packing};

/// Share of the expected number of contacts below which a plane is open.
const OPEN: f64 = 0.25;

/// Probability below which so few contacts through a plane are no chance. Contacts of packings scatter less than independent
/// ones, for which it is computed.
const CHANCE: f64 = 1e-6;

const EDGES: [&str; 3] = ["a", "b", "c"];

/// The contacts through the planes parallel to two edge vectors of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings {
    /// Smallest number of contacts that cross such a plane, wherever it is.
    pub fewest: u32,
    /// Mean over all such planes: the sum over contacts of the share of the third edge that they span.
    pub expected: f64,
}

impl Crossings {
    /// Returns true if far fewer contacts cross one plane than the others, as between two walls, or at a free surface.
    ///
    /// The plane is open if it has less than a quarter of the expected contacts, and the probability of so few by a Poisson
    /// distribution is below 1e-6. Small packings with fewer than 14 expected contacts are never open.
    pub fn is_open(&self) -> bool {
        f64::from(self.fewest) < OPEN * self.expected && poisson_at_most(self.fewest, self.expected) < CHANCE
    }
}

fn poisson_at_most(count: u32, mean: f64) -> f64 {
    let mut term = (-mean).exp();
    let mut sum = term;
    for n in 1..=count {
        term *= mean / f64::from(n);
        sum += term;
    }
    sum
}

impl Packing {
    /// Returns the contacts through the planes across each edge vector of the cell.
    ///
    /// No plane of a periodic cell is special, so that the result does not depend on where the cell begins.
    pub fn crossings(&self) -> [Crossings; 3] {
        let places: Vec<_> =
            self.positions.iter().map(|x| self.cell.fractional(x).map(|s| s - s.floor())).collect();
        let images: Vec<[i64; 3]> = self.contacts.iter().map(|c| self.folded_image(c)).collect();
        std::array::from_fn(|axis| {
            let place = |grain: u32| places[grain as usize][axis];
            let end = |c: &Contact, image: &[i64; 3]| place(c.j) + image[axis] as f64;
            // Contacts through the plane at 0, and how their number changes at each grain.
            let (mut at_zero, mut spanned) = (0, 0.0);
            let mut change = vec![0i64; self.grains()];
            for (c, image) in self.contacts.iter().zip(&images) {
                let end = end(c, image);
                let up = if end >= place(c.i) { 1 } else { -1 };
                at_zero += image[axis].abs();
                spanned += (end - place(c.i)).abs();
                change[c.i as usize] += up;
                change[c.j as usize] -= up;
            }
            let mut order: Vec<usize> = (0..self.grains()).collect();
            order.sort_by(|a, b| places[*a][axis].total_cmp(&places[*b][axis]));
            let (mut present, mut fewest) = (at_zero, at_zero);
            for (k, grain) in order.iter().enumerate() {
                present += change[*grain];
                // Grains of one layer end and begin contacts at one place.
                let is_last = order.get(k + 1).is_none_or(|next| places[*next][axis] > places[*grain][axis]);
                if is_last {
                    fewest = fewest.min(present);
                }
            }
            Crossings { fewest: u32::try_from(fewest).unwrap_or(0), expected: spanned }
        })
    }

    /// Returns the cell vectors from the first grain of a contact to the image of the second, with both positions folded into
    /// the cell.
    fn folded_image(&self, c: &Contact) -> [i64; 3] {
        let cell_of = |g: u32| self.cell.fractional(&self.positions[g as usize]).map(f64::floor);
        let between = cell_of(c.j) - cell_of(c.i);
        std::array::from_fn(|k| between[k] as i64 + i64::from(c.image[k]))
    }

    pub(crate) fn crossings_note(&self) -> Option<Note> {
        let open: Vec<(&str, Crossings)> =
            EDGES.into_iter().zip(self.crossings()).filter(|(_, c)| c.is_open()).collect();
        let list = |text: &dyn Fn(&(&str, Crossings)) -> String| {
            open.iter().map(text).collect::<Vec<_>>().join(", ")
        };
        let edges = list(&|(edge, _)| format!("edge {edge}"));
        let fewest = list(&|(_, c)| c.fewest.to_string());
        let expected = list(&|(_, c)| format!("{:.0}", c.expected));
        (!open.is_empty()).then(|| Note::open(edges, fewest, expected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Mat3, Vec3, contact_search};

    /// A face-centred cubic crystal with `layers` layers of cubes across z, in a cell with `gap` (edges of a cube) more.
    fn crystal(edge: usize, layers: usize, gap: f64, origin: f64) -> Packing {
        let basis = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
        let mut sites = Vec::new();
        for (x, y, z) in (0..edge * edge * layers).map(|n| (n % edge, n / edge % edge, n / edge / edge)) {
            let corner = Vec3::new(x as f64, y as f64, z as f64 + origin);
            sites.extend(basis.map(|b| corner + Vec3::from(b)));
        }
        let edges = Vec3::new(edge as f64, edge as f64, layers as f64 + gap);
        let cell = Cell::new(Mat3::from_diagonal(&edges)).unwrap();
        let mut p = Packing::at_rest(cell, vec![0.5 * 0.5f64.sqrt() * 1.001; sites.len()], sites);
        p.contacts = contact_search::of_packing(&p).unwrap();
        p
    }

    #[test]
    fn a_crystal_is_crossed_by_as_many_contacts_everywhere() {
        for (edge, layers) in [(1, 1), (2, 2), (3, 2)] {
            let p = crystal(edge, layers, 0.0, 0.3);
            for (c, planes) in p.crossings().into_iter().zip([edge * layers, edge * layers, edge * edge]) {
                // Eight contacts cross a face of each cube.
                assert_eq!(c.fewest as usize, 8 * planes);
                assert!((c.expected - f64::from(c.fewest)).abs() < 1e-9 && !c.is_open(), "{c:?}");
            }
            assert_eq!(p.crossings_note(), None);
        }
    }

    #[test]
    fn a_gap_is_found_wherever_the_cell_begins() {
        for origin in [0.0, 0.4, -7.3] {
            let p = crystal(3, 3, 0.6, origin);
            let [a, b, c] = p.crossings();
            assert!(c.fewest == 0 && c.is_open() && !a.is_open() && !b.is_open(), "{c:?}");
            let text = p.crossings_note().unwrap().to_string();
            assert!(text.contains("across edge c of the cell") && text.contains("only 0 contacts"), "{text}");
        }
        // A few contacts through the gap do not close it.
        let mut p = crystal(3, 3, 0.6, 0.0);
        let mut bridge = p.contacts[0];
        (bridge.i, bridge.j, bridge.image) = (0, p.grains() as u32 - 1, [0, 0, -1]);
        p.contacts.extend([bridge; 3]);
        assert!(p.crossings()[2].fewest == 3 && p.crossings()[2].is_open());
    }

    #[test]
    fn so_few_events_are_as_probable_as_by_tables() {
        for (count, mean, probability) in [(0, 2.0, 0.135335), (3, 5.0, 0.265026), (10, 20.0, 0.010812)] {
            assert!((poisson_at_most(count, mean) - probability).abs() < 1e-6);
        }
        assert!(!Crossings { fewest: 0, expected: 13.8 }.is_open());
        assert!(Crossings { fewest: 0, expected: 13.9 }.is_open());
        assert!(
            !Crossings { fewest: 20, expected: 79.0 }.is_open()
                && Crossings { fewest: 19, expected: 79.0 }.is_open()
        );
    }
}
