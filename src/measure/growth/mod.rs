//! How an error grows over a run: a verdict, an exponent with a confidence interval and a slope, from the extremes and
//! means of at most 400 blocks of equally many steps, so that memory does not grow with the run.
//!
//! # The test
//!
//! The rules and their constants were fixed on synthetic series of known law (`tests/measure/growth.rs`), before they
//! judged any engine. Let `m` be the block means, and let the run be cut into sixteen *parts*. The *band* `a` is the
//! median half-width `(max - min) / 2` of the parts. In this order, an error is
//!
//! 1. `blow_up` where the engine diverged or the error exceeds ten times the energy scale;
//! 2. not judged in fewer than [`MIN_STEPS`] steps;
//! 3. `bounded` where it never leaves the roundoff of the energy, [`ROUNDOFF`];
//! 4. growing by the *widening rule* where the logarithm of the half-widths of the blocks, averaged over each part,
//!    rises by at least 0.4 over the run, and either its t statistic is at least 3.5 and `R` of the half-widths at
//!    least 0.01, or it is at least 2.5 and the half-widths of the parts rise likewise, with a t statistic of at least
//!    3.5;
//! 5. growing by the *trend rule* where the straight line through the means of the parts changes by at least `3/4 a`
//!    over the run and its t statistic is at least 3. Every t statistic is reduced by `sqrt((1 - r) / (1 + r))`, with
//!    `r` the correlation of neighbouring residuals, for an error that remembers (Santer et al., J. Geophys. Res. 105,
//!    2000);
//! 6. growing by the *wander rule* where the means of the parts, their largest and their smallest values each cover a
//!    range of at least `1.7 a`, where the ratio `R` is at least 0.01, and where the exponent of what a straight line
//!    leaves of `m` is at least 1/4;
//! 7. else `bounded`: no growth was established.
//!
//! `R` is the mean square of the running sum of a series without its mean, over the mean square of the series and the
//! square of its length: the statistic of Kwiatkowski, Phillips, Schmidt and Shin (J. Econometrics 54, 1992) without a
//! lag window. It is `1/(4 pi^2 n^2)` for `n` swings in the run, about `tau/(3 T)` for noise with correlation time
//! `tau`, 0.05 for a random walk and 0.1 for a line.
//!
//! An error that widens is a `drift`. Another that grows is a `random_walk` where what a straight line leaves of it
//! behaves like one: exponent between 1/4 and 3/4, `R` at least 0.0015, and less than 95 % of the variance explained by
//! the line. Else it is a `drift`.
//!
//! # The exponent
//!
//! The error that grows does so like `t^p`. Of a random walk, `p` is the slope of the logarithm of the Haar wavelet (or
//! Allan) deviation of `m` against that of the time scale, by the weighted regression of Abry and Veitch (IEEE Trans.
//! Inf. Theory 44, 1998) with their interval. Of a drift, `c t^p` is fitted to the means (or half-widths) of the parts,
//! and the interval is that of the F test. Where the error is bounded the exponent is 0, and the interval ends where
//! the spread would grow with the largest trend that the run does not exclude. All intervals are of 95 %.
//!
//! # What it does not promise
//!
//! Measured over 1000 seeds each while the rules were made; `tests/measure/growth.rs` holds them to these rates on
//! seeds that were first used when the rules were final (fewer than 1 % of false alarms, at least 99.5 % of full
//! drifts):
//!
//! | series of 4000 steps | verdict | rate |
//! | --- | --- | --- |
//! | white, violet, pink and red (correlation time 1 % of the run) noise | not `bounded` | at most 0.4 % |
//! | periodic, quasi-periodic, beating, logistic, Lorenz | not `bounded` | at most 0.4 % |
//! | the same with a drift of the width of the band over the run, which doubles the band | growing | all |
//! | the same with half of that drift, which doubles the largest error | growing | 98.5 % (Lorenz), 99.4 % (pink) |
//! | the same swinging ever more widely, to twice the width | growing | 97 %, quasi-periodic 83 %, beating 57 % |
//! | random walk | `random_walk` | 93 % (6 % `bounded`, 1 % `drift`) |
//! | bursts of very different height at random times, about 35 in the run | not `bounded` | 1.3 % |
//!
//! A run of fewer than three swings is judged as if its swing were growth: an error of which a run sees only a part of
//! a swing cannot be told from one that grows. So it is with a chaotic motion that has not yet visited all places where
//! its error is large: over 30 s the error of a double pendulum widens, over 100 s it does not. A drift of less than
//! three quarters of the band is not seen.

mod figures;
mod rules;
mod statistics;

pub use figures::{Exponent, Growth, Stretch, Verdict};
pub use rules::{MIN_STEPS, ROUNDOFF, growth};
