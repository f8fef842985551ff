//! One number or several side by side.
//!
//! The stages of a collocation step are independent of each other between two exchanges of their rates. Their equations
//! are evaluated for [`LANES`] stages at once, in the registers for several numbers that every processor has: each
//! operation is that on single numbers, so a result does not depend on its neighbours.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};
use wide::f64x2;

/// Numbers side by side.
pub(in crate::reduced) const LANES: usize = 2;

/// What the equations of motion are evaluated on.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Zero
    + One
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + 'static
{
    /// The same number everywhere.
    fn of(x: f64) -> Self;

    /// `f` of each number.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;

    fn sin_cos(self) -> (Self, Self);

    /// Whether all numbers are positive and finite.
    fn is_positive(self) -> bool;
}

impl Real for f64 {
    #[inline(always)]
    fn of(x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> f64 {
        f(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (f64, f64) {
        f64::sin_cos(self)
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        self > 0.0 && self.is_finite()
    }
}

/// `1 / d` for a positive number.
#[inline(always)]
pub(in crate::reduced) fn reciprocal<T: Real>(d: T) -> Option<T> {
    d.is_positive().then(|| T::one() / d)
}

/// Two numbers, one for each of two stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::reduced) struct Lanes(f64x2);

impl Lanes {
    #[inline(always)]
    pub(in crate::reduced) fn from_fn(mut f: impl FnMut(usize) -> f64) -> Lanes {
        let a = f(0);
        Lanes(f64x2::new([a, f(1)]))
    }

    #[inline(always)]
    pub(in crate::reduced) fn numbers(self) -> [f64; LANES] {
        self.0.to_array()
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn of(x: f64) -> Lanes {
        Lanes(f64x2::splat(x))
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Lanes {
        let [a, b] = self.numbers();
        Lanes(f64x2::new([f(a), f(b)]))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Lanes, Lanes) {
        let [a, b] = self.numbers();
        let ((s, c), (t, d)) = (a.sin_cos(), b.sin_cos());
        (Lanes(f64x2::new([s, t])), Lanes(f64x2::new([c, d])))
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        self.numbers().into_iter().all(Real::is_positive)
    }
}

impl Zero for Lanes {
    #[inline(always)]
    fn zero() -> Lanes {
        Lanes::of(0.0)
    }

    fn is_zero(&self) -> bool {
        *self == Lanes::zero()
    }
}

impl One for Lanes {
    #[inline(always)]
    fn one() -> Lanes {
        Lanes::of(1.0)
    }
}

macro_rules! operators {
    ($($operator:ident $apply:ident $assigning:ident $assign:ident),*) => {$(
        impl $operator for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $apply(self, other: Lanes) -> Lanes {
                Lanes($operator::$apply(self.0, other.0))
            }
        }

        impl $assigning for Lanes {
            #[inline(always)]
            fn $assign(&mut self, other: Lanes) {
                self.0 = $operator::$apply(self.0, other.0);
            }
        }
    )*};
}

operators!(
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign
);

impl Neg for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn neg(self) -> Lanes {
        Lanes(-self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_lane_computes_what_a_single_number_does() {
        let (a, b) = ([0.3, -1.7], [2.9, 1e-3]);
        let [x, y] = [a, b].map(|n| Lanes::from_fn(|k| n[k]));
        let each = |f: fn(f64, f64) -> f64| [f(a[0], b[0]), f(a[1], b[1])];
        assert_eq!((x + y).numbers(), each(|a, b| a + b));
        assert_eq!((x - y).numbers(), each(|a, b| a - b));
        assert_eq!((x * y).numbers(), each(|a, b| a * b));
        assert_eq!((x / y).numbers(), each(|a, b| a / b));
        assert_eq!((-x).numbers(), each(|a, _| -a));
        assert_eq!(x.sin_cos().0.numbers(), each(|a, _| a.sin()));
        assert!(y.is_positive() && !x.is_positive() && !(y / Lanes::zero()).is_positive());
    }
}
