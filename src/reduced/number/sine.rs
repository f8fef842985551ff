//! Sine and cosine of an angle that is asked for again and again nearby.
//!
//! With `sin a` and `cos a` at hand and `d = angle - a`,
//!
//! ```text
//! sin angle = sin a + (cos a sin d + sin a (cos d - 1)) ,   cos angle = cos a + (cos a (cos d - 1) - sin a sin d) ,
//! ```
//!
//! where Taylor's polynomials give `sin d` and `cos d - 1` to 4e-19 for `|d|` up to [`NEAR`]: what the brackets add is
//! small, and the sums are as good as the functions themselves. Angles further away are computed anew and kept.

use super::real::{Lanes, Real};

/// rad
const NEAR: f64 = 1.0 / 128.0;

/// An angle with its sine and cosine, in rad.
#[derive(Clone, Copy, Debug)]
pub(in crate::reduced) struct NearbySine {
    angle: Lanes,
    sin: Lanes,
    cos: Lanes,
}

impl NearbySine {
    pub(in crate::reduced) fn zero() -> NearbySine {
        NearbySine { angle: Lanes::of(0.0), sin: Lanes::of(0.0), cos: Lanes::of(1.0) }
    }

    /// Sine and cosine of an angle.
    #[inline(always)]
    pub(in crate::reduced) fn sin_cos(&mut self, angle: Lanes) -> (Lanes, Lanes) {
        let d = angle - self.angle;
        if !d.numbers().into_iter().all(|d| d.abs() <= NEAR) {
            let (sin, cos) = angle.sin_cos();
            *self = NearbySine { angle, sin, cos };
            return (sin, cos);
        }
        let (one, square) = (Lanes::of(1.0), d * d);
        // d - d^3/3! + d^5/5!  and  -d^2/2! + d^4/4! - d^6/6!
        let sine = d * (one - square * Lanes::of(1.0 / 6.0) * (one - square * Lanes::of(1.0 / 20.0)));
        let fourth = one - square * Lanes::of(1.0 / 12.0) * (one - square * Lanes::of(1.0 / 30.0));
        let less = square * Lanes::of(-0.5) * fourth;
        let NearbySine { sin, cos, .. } = *self;
        (sin + (cos * sine + sin * less), cos + (cos * less - sin * sine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_nearby_have_the_sine_and_cosine_of_the_functions() {
        let mut worst = 0.0f64;
        for k in 0..1000 {
            let start = [0.37 * f64::from(k), -0.011 * f64::from(k)];
            let mut turn = NearbySine::zero();
            turn.sin_cos(Lanes::from_fn(|lane| start[lane]));
            for j in -10..=10 {
                let angle = start.map(|angle| angle + 0.1 * f64::from(j) * NEAR);
                let (sin, cos) = turn.sin_cos(Lanes::from_fn(|lane| angle[lane]));
                for lane in 0..2 {
                    let (s, c) = angle[lane].sin_cos();
                    worst = worst.max((sin.numbers()[lane] - s).abs()).max((cos.numbers()[lane] - c).abs());
                }
            }
        }
        println!("{worst:.1e}");
        // measured 1.1e-16
        assert!(worst <= 2.5e-16, "{worst:e}");
    }

    #[test]
    fn angles_far_away_and_no_numbers_are_computed_anew() {
        let mut turn = NearbySine::zero();
        for angle in [1.0, f64::NAN, 2.0, 2.0 + 1.01 * NEAR, -700.0] {
            let (sin, cos) = turn.sin_cos(Lanes::of(angle));
            let (s, c) = angle.sin_cos();
            assert_eq!([sin, cos].map(|x| x.numbers()[1].to_bits()), [s, c].map(f64::to_bits), "{angle}");
        }
    }
}
