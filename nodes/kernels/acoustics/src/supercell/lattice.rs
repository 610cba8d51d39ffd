//! Stacks of a cell along the normal of its lattice planes.

use grainlab_core::{Cell, Vec3};
use nalgebra::{Matrix3, Vector3};

/// Integer coordinates in the edge vectors of a cell.
type Whole = Vector3<i64>;

/// A lattice in layers: copies of a cell stacked along the normal of lattice planes.
pub(crate) struct Layers {
    /// The planes (h k l) without a common divisor.
    pub(crate) plane: Whole,
    /// The vector from one copy to the next, which crosses one plane.
    pub(crate) step: Whole,
    /// Edges: two in the planes, the third from the first copy to the one after the last.
    pub(crate) cell: Cell,
    /// Transforms coordinates in the edge vectors of the packing's cell to coordinates in (first edge, second edge,
    /// step).
    coordinates: Matrix3<i64>,
    /// Third edge minus `copies` steps, in first and second edges.
    skew: [i64; 2],
}

impl Layers {
    /// The copy reached from copy `copy` by the lattice vector `by`, in edge vectors of the packing's cell, and its
    /// image, in edges of the stack.
    pub(crate) fn image(&self, copy: i64, by: &Whole, copies: i64) -> (i64, Whole) {
        let at = self.coordinates * by;
        let layer = copy + at.z;
        let around = layer.div_euclid(copies);
        let image = Whole::new(at.x - around * self.skew[0], at.y - around * self.skew[1], around);
        (layer.rem_euclid(copies), image)
    }
}

/// `copies` of `cell` along the normal of its planes (h k l). `None` for (0 0 0), or if the stack has no volume.
pub(crate) fn layers(cell: &Cell, indices: [i32; 3], copies: u32) -> Option<Layers> {
    let plane = primitive(indices)?;
    let [mut first, mut second, mut step] = basis(&plane);
    let metric = |v: &Whole| cell.matrix() * v.cast::<f64>();
    shorten(&mut first, &mut second, metric);
    let across = [metric(&first), metric(&second)];
    let [a, b] = nearest(&across, &metric(&step));
    step += first * a + second * b;
    let skew = nearest(&across, &(metric(&step) * f64::from(copies)));
    let third = step * i64::from(copies) + first * skew[0] + second * skew[1];
    let edges = nalgebra::Matrix3::from_columns(&[across[0], across[1], metric(&third)]);
    let basis = Matrix3::from_columns(&[first, second, step]);
    Some(Layers { plane, step, cell: Cell::new(edges)?, coordinates: inverse(&basis), skew })
}

/// The distance of neighbouring planes (h k l), m.
pub(crate) fn spacing(cell: &Cell, plane: &Whole) -> f64 {
    1.0 / (cell.inverse().transpose() * plane.cast::<f64>()).norm()
}

/// The indices divided by their greatest common divisor.
pub(crate) fn primitive(indices: [i32; 3]) -> Option<Whole> {
    let v = Whole::from(indices.map(i64::from));
    let divisor = v.iter().fold(0, |d, x| gcd(d, *x).0);
    (divisor != 0).then(|| v / divisor)
}

/// Two lattice vectors that span the planes `p` (without a common divisor) and a third that crosses one of them,
/// right-handed and of volume 1.
fn basis(p: &Whole) -> [Whole; 3] {
    let (g, u, v) = gcd(p.x, p.y);
    if g == 0 {
        return if p.z > 0 {
            [Whole::x(), Whole::y(), Whole::z()]
        } else {
            [Whole::y(), Whole::x(), -Whole::z()]
        };
    }
    let (_, s, t) = gcd(g, p.z);
    let one = Whole::new(-p.z * u, -p.z * v, g);
    let other = Whole::new(p.y / g, -p.x / g, 0);
    [one, other, Whole::new(s * u, s * v, t)]
}

/// Greatest common divisor d ≥ 0 of a and b, with x a + y b = d.
fn gcd(a: i64, b: i64) -> (i64, i64, i64) {
    let (mut r, mut x, mut y) = ([a, b], [1, 0], [0, 1]);
    while r[1] != 0 {
        let q = r[0] / r[1];
        for v in [&mut r, &mut x, &mut y] {
            *v = [v[1], v[0] - q * v[1]];
        }
    }
    let sign = if r[0] < 0 { -1 } else { 1 };
    (sign * r[0], sign * x[0], sign * y[0])
}

/// Lagrange–Gauss reduction: the shortest pair that spans the same plane lattice, with the same handedness.
fn shorten(first: &mut Whole, second: &mut Whole, metric: impl Fn(&Whole) -> Vec3) {
    loop {
        let (a, b) = (metric(first), metric(second));
        if b.norm_squared() < a.norm_squared() {
            // A quarter turn keeps the handedness.
            (*first, *second) = (*second, -*first);
            continue;
        }
        let times = (a.dot(&b) / a.norm_squared()).round();
        // Without the tolerance, rounding could exchange two equal vectors endlessly.
        let shorter = (b - a * times).norm_squared() < b.norm_squared() * (1.0 - 1e-12);
        if times == 0.0 || !shorter {
            return;
        }
        *second -= *first * times as i64;
    }
}

/// The integer multiples of the two vectors `across` to add to `v` that make the sum shortest.
fn nearest(across: &[Vec3; 2], v: &Vec3) -> [i64; 2] {
    let [a, b] = across;
    let gram = nalgebra::Matrix2::new(a.dot(a), a.dot(b), a.dot(b), b.dot(b));
    let right = nalgebra::Vector2::new(-a.dot(v), -b.dot(v));
    let Some(exact) = gram.try_inverse().map(|g| g * right) else { return [0, 0] };
    let left = |c: &[f64; 2]| (v + a * c[0] + b * c[1]).norm_squared();
    let corners = [0.0, 1.0].map(|x| [0.0, 1.0].map(|y| [exact.x.floor() + x, exact.y.floor() + y]));
    let best = corners.into_iter().flatten().min_by(|a, b| left(a).total_cmp(&left(b)));
    best.map_or([0, 0], |c| c.map(|x| x as i64))
}

/// Inverse of an integer matrix of determinant 1: the transposed cofactors.
fn inverse(m: &Matrix3<i64>) -> Matrix3<i64> {
    let [a, b, c] = [0, 1, 2].map(|k| m.column(k).into_owned());
    Matrix3::from_rows(&[b.cross(&c).transpose(), c.cross(&a).transpose(), a.cross(&b).transpose()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::Mat3;

    #[test]
    fn a_basis_spans_the_planes_and_crosses_one_of_them() {
        let range = -7..=7;
        for h in range.clone() {
            for k in range.clone() {
                for l in range.clone() {
                    let Some(p) = primitive([h, k, l]) else { continue };
                    let [a, b, c] = basis(&p);
                    assert_eq!([p.dot(&a), p.dot(&b), p.dot(&c)], [0, 0, 1], "{p}");
                    assert_eq!(a.cross(&b), p);
                    let m = Matrix3::from_columns(&[a, b, c]);
                    assert_eq!(inverse(&m) * m, Matrix3::identity());
                }
            }
        }
        assert!(primitive([0; 3]).is_none());
    }

    #[test]
    fn the_stack_has_the_volume_of_its_copies_and_the_least_skew() {
        let cell = Cell::new(Mat3::new(1.0, 0.3, -0.1, 0.0, 1.1, 0.2, 0.01, 0.0, 0.9)).unwrap();
        for indices in [[1, 0, 0], [0, 0, -1], [1, -1, 0], [1, 1, 1], [2, -3, 5], [-7, 1, 4]] {
            for copies in [1, 3, 8] {
                let stack = layers(&cell, indices, copies).unwrap();
                let volume = f64::from(copies) * cell.volume();
                assert!((stack.cell.volume() / volume - 1.0).abs() < 1e-12);
                let [a, b, c] = [0, 1, 2].map(|k| stack.cell.matrix().column(k).into_owned());
                let normal = a.cross(&b).normalize();
                let aside = c - normal * c.dot(&normal);
                assert!(a.norm() <= b.norm() && 2.0 * a.dot(&b).abs() <= a.norm_squared() * (1.0 + 1e-9));
                for (x, y) in (-2..=2).flat_map(|x| (-2..=2).map(move |y| (f64::from(x), f64::from(y)))) {
                    assert!((aside + a * x + b * y).norm() >= aside.norm() - 1e-12, "{indices:?} {copies}");
                }
            }
        }
    }
}
