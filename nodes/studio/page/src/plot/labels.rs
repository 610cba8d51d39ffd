//! Texts beside points, where there is room: a label never lies on a marker or on another label.

/// Half the width of the free area around a point.
const MARKER: f64 = 5.0;

/// Size of the letters: width of one, height of all.
const LETTER: [f64; 2] = [6.0, 10.0];

/// Distance of two names beside the ends of their lines.
const LINE: f64 = 13.0;

/// Distance by which labels may extend beyond the right end of the axes.
const BEYOND: f64 = 20.0;

/// Positions tried for a label, relative to its point: the left end if the first number is positive, else the
/// right end; bottom.
const BESIDE: [[f64; 2]; 6] = [[8.0, 3.5], [-8.0, 3.5], [6.0, -6.0], [-6.0, -6.0], [6.0, 15.0], [-6.0, 15.0]];

/// A rectangle: left, top, right, bottom.
pub(super) type Area = [f64; 4];

pub(super) fn around([x, y]: [f64; 2]) -> Area {
    [x - MARKER, y - MARKER, x + MARKER, y + MARKER]
}

/// The labels that fit into `frame`, each with its lower left corner; `taken` are the areas of markers.
pub(super) fn place<'a, T: Copy>(
    labels: &[([f64; 2], &'a str, T)],
    mut taken: Vec<Area>,
    frame: Area,
) -> Vec<([f64; 2], &'a str, T)> {
    let mut placed = Vec::new();
    for ([x, y], text, kind) in labels {
        let width = LETTER[0] * text.chars().count() as f64;
        let beside = |[dx, dy]: [f64; 2]| {
            let (left, bottom) = (x + dx - if dx < 0.0 { width } else { 0.0 }, y + dy);
            [left, bottom - LETTER[1], left + width, bottom]
        };
        let inside =
            |a: &Area| a[0] > frame[0] && a[2] < frame[2] + BEYOND && a[1] > frame[1] && a[3] < frame[3];
        let free = |a: &Area| inside(a) && !taken.iter().any(|t| overlap(t, a));
        if let Some(area) = BESIDE.map(beside).into_iter().find(free) {
            placed.push(([area[0], area[3] - 1.0], *text, *kind));
            taken.push(area);
        }
    }
    placed
}

/// Heights close to these, in order, at least a line apart, between the two ends.
pub(super) fn spread(heights: Vec<f64>, [top, bottom]: [f64; 2]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by(|a, b| heights[*a].total_cmp(&heights[*b]));
    let mut placed = heights;
    let mut least = top;
    for n in &order {
        placed[*n] = placed[*n].max(least);
        least = placed[*n] + LINE;
    }
    let mut most = bottom;
    for n in order.iter().rev() {
        placed[*n] = placed[*n].min(most);
        most = placed[*n] - LINE;
    }
    placed
}

fn overlap(a: &Area, b: &Area) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_overlap_where_they_share_some() {
        assert!(overlap(&[0.0, 0.0, 2.0, 2.0], &[1.0, 1.0, 3.0, 3.0]));
        assert!(!overlap(&[0.0, 0.0, 2.0, 2.0], &[2.0, 0.0, 3.0, 2.0]));
    }

    #[test]
    fn names_at_one_height_are_spread_and_stay_between_the_ends() {
        assert_eq!(spread(vec![50.0, 20.0], [0.0, 100.0]), [50.0, 20.0]);
        assert_eq!(spread(vec![100.0, 99.0, 100.0], [0.0, 100.0]), [87.0, 74.0, 100.0]);
    }

    #[test]
    fn of_points_in_a_heap_only_a_few_have_labels() {
        let points: Vec<_> = (0..40).map(|k| ([100.0 + 0.1 * f64::from(k), 100.0], "1e-8", ())).collect();
        let taken = points.iter().map(|(at, ..)| around(*at)).collect();
        let placed = place(&points, taken, [0.0, 0.0, 500.0, 500.0]);
        assert!((1..10).contains(&placed.len()), "{}", placed.len());
    }
}
