//! What a contact needs to be computed.

use super::stepping::Features;

/// Additions, multiplications, divisions and square roots that one contact of two grains of one size needs in one step.
/// What is the same for all contacts, comparisons, and the extra of a contact that slides are left out, as is the motion
/// of the grains: a share of peak from this is a lower bound.
pub(crate) fn per_contact(features: Features, stress: bool) -> f64 {
    // Branch 6, its square 5, root, reciprocal, overlap 1, normal 3, contact radius 2, relative velocity 6 with the affine
    // part 15.
    let geometry = 40.0;
    // Force 3 along the normal; sums on two grains 6.
    let normal = geometry + 9.0 + law(features);
    // Lever 2, spins 9, force 3, moment 12, sums of moments 6.
    let tangential = if features == Features::Frictionless { 0.0 } else { 32.0 };
    // Force 3, or 6 with its tangential part; six products 15; sums 6.
    let virial = match (stress, features) {
        (false, _) => 0.0,
        (true, Features::Frictionless) => 24.0,
        (true, _) => 27.0,
    };
    normal + tangential + virial
}

/// The same of the contact law alone, with damping and rescaled springs, as counted by running it.
fn law(features: Features) -> f64 {
    match features {
        Features::Frictionless => 13.0,
        Features::Coulomb => 130.0,
        Features::Stuck => 118.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dem::lanes::{Lanes, V3};
    use dem::law::{Law, Touch};
    use grains::Material;
    use std::cell::Cell;
    use std::ops::{Add, Div, Mul, Neg, Sub};

    thread_local! {
        static DONE: Cell<u32> = const { Cell::new(0) };
    }

    /// A number that counts what is done with it. What is done with constants alone is done once for all contacts.
    #[derive(Clone, Copy)]
    struct Counted(f64, bool);

    fn done(value: f64, a: Counted, b: Counted) -> Counted {
        if a.1 || b.1 {
            DONE.set(DONE.get() + 1);
        }
        Counted(value, a.1 || b.1)
    }

    macro_rules! counted {
        ($($operator:ident $method:ident $sign:tt),*) => {$(
            impl $operator for Counted {
                type Output = Self;
                fn $method(self, other: Self) -> Self {
                    done(self.0 $sign other.0, self, other)
                }
            }
        )*};
    }
    counted!(Add add +, Sub sub -, Mul mul *, Div div /);

    impl Neg for Counted {
        type Output = Self;
        fn neg(self) -> Self {
            Self(-self.0, self.1)
        }
    }

    const NO_MEMORY: &str = "the law touches no memory";

    impl Lanes for Counted {
        const WIDTH: usize = 1;
        type Mask = bool;
        type Index = usize;
        fn splat(value: f64) -> Self {
            Self(value, false)
        }
        fn load(_: &[f64; 8], _: usize) -> Self {
            unreachable!("{NO_MEMORY}")
        }
        fn store(self, _: &mut [f64; 8], _: usize) {
            unreachable!("{NO_MEMORY}")
        }
        fn sqrt(self) -> Self {
            done(self.0.sqrt(), self, self)
        }
        fn max(self, other: Self) -> Self {
            Self(self.0.max(other.0), self.1 || other.1)
        }
        fn gt(self, other: Self) -> bool {
            self.0 > other.0
        }
        fn both(a: bool, b: bool) -> bool {
            a && b
        }
        fn any(mask: bool) -> bool {
            mask
        }
        fn select(mask: bool, a: Self, b: Self) -> Self {
            if mask { a } else { b }
        }
        fn index(_: &[u32; 8], _: usize, _: usize) -> usize {
            unreachable!("{NO_MEMORY}")
        }
        fn gather<const K: usize>(_: &[[f64; 4]], _: usize) -> Self {
            unreachable!("{NO_MEMORY}")
        }
        fn prefetch(_: &[[f64; 4]], _: &[u32; 8], _: usize) {}
        fn store_rows(_: [Self; 4], _: &mut [[f64; 8]; 8], _: usize, _: usize) {
            unreachable!("{NO_MEMORY}")
        }
        fn fold(_: [Self; 8], _: &mut [f64; 8]) {
            unreachable!("{NO_MEMORY}")
        }
    }

    fn vector(x: f64, y: f64, z: f64) -> V3<Counted> {
        V3::new(Counted(x, true), Counted(y, true), Counted(z, true))
    }

    /// A contact that sticks.
    fn touch() -> Touch<Counted> {
        Touch {
            normal: vector(0.6, 0.0, 0.8),
            inverse_distance: Counted(5e3, true),
            overlap: Counted(5e-8, true),
            root: Counted(1.6e-6, true),
            previous_root: Counted(1.6e-6, true),
            m_eff: Counted(5e-9, true),
            relative: vector(1e-9, 0.0, 1e-9),
            rolling: vector(0.0, 1e-9, 0.0),
            spin: vector(0.0, 1e-5, 0.0),
        }
    }

    fn count(run: impl FnOnce(&Law)) -> f64 {
        DONE.set(0);
        run(&Law::new(&Material::GLASS, 0.1, 0.3));
        f64::from(DONE.get())
    }

    #[test]
    fn the_law_is_counted_as_it_is() {
        let none = vector(0.0, 0.0, 0.0);
        let counted = [
            count(|l| {
                std::hint::black_box(l.frictionless(&touch()));
            }),
            count(|l| {
                std::hint::black_box(l.frictional::<_, true, true, true>(&touch(), none, 3e-8));
            }),
            count(|l| {
                std::hint::black_box(l.frictional::<_, true, false, true>(&touch(), none, 3e-8));
            }),
        ];
        assert_eq!(counted, [Features::Frictionless, Features::Coulomb, Features::Stuck].map(law));
    }
}
