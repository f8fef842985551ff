//! The growth test on synthetic series of known law: how often it is wrong, over seeds that its constants were not fixed on.

use std::f64::consts::TAU;

use rattlebench::measure::growth::{Growth, MIN_STEPS, Stretch, Verdict, growth};
use rattlebench::measure::trace::series::Series;

const STEPS: usize = 4000;
const SEEDS: std::ops::Range<u64> = 7_000_000..7_001_000;

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0xD134_2543_DE82_EF95))
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Box and Muller.
    fn normal(&mut self) -> f64 {
        let r = (-2.0 * self.uniform().max(f64::MIN_POSITIVE).ln()).sqrt();
        r * (TAU * self.uniform()).cos()
    }

    /// Between the two, evenly in the logarithm.
    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.uniform())
    }
}

type Make = fn(u64, usize) -> Vec<f64>;

fn fraction(i: usize, n: usize) -> f64 {
    i as f64 / n as f64
}

fn white(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..n).map(|_| random.normal()).collect()
}

/// Differences of white noise: power rising with the square of the frequency.
fn violet(seed: u64, n: usize) -> Vec<f64> {
    white(seed, n + 1).windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Remembers itself over `time` steps.
fn remembering(random: &mut Random, time: f64, n: usize) -> Vec<f64> {
    let keep = (-1.0 / time).exp();
    let mut x = random.normal();
    (0..n)
        .map(|_| {
            x = keep * x + (1.0 - keep * keep).sqrt() * random.normal();
            x
        })
        .collect()
}

/// Correlation time of one hundredth of the run.
fn red(seed: u64, n: usize) -> Vec<f64> {
    remembering(&mut Random::new(seed), n as f64 / 100.0, n)
}

/// Power falling like one over the frequency: a sum of memories of 1, 2, 4, ... steps, up to a quarter of the run.
fn pink(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let mut sum = vec![0.0; n];
    for octave in 0..n.ilog2() - 2 {
        let part = remembering(&mut random, f64::from(1 << octave), n);
        sum.iter_mut().zip(part).for_each(|(s, x)| *s += x);
    }
    sum
}

/// From 20 swings a run to one in ten steps, zero at the start.
fn periodic(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let (swings, phase) = (random.log_between(20.0, 0.1 * n as f64), TAU * random.uniform());
    (0..n).map(|i| (TAU * swings * fraction(i, n) + phase).sin() - phase.sin()).collect()
}

/// Three incommensurate frequencies.
fn quasi_periodic(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let swings = random.log_between(20.0, 0.03 * n as f64);
    let tones: Vec<(f64, f64, f64)> = [1.0, 2f64.sqrt(), 0.5 * (1.0 + 5f64.sqrt())]
        .map(|ratio| (TAU * ratio * swings, TAU * random.uniform(), 0.2 + random.uniform()))
        .to_vec();
    (0..n).map(|i| tones.iter().map(|(w, phase, size)| size * (w * fraction(i, n) + phase).sin()).sum()).collect()
}

/// A fast swing whose height goes up and down 5 to 15 times.
fn beating(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let (fast, slow) = (random.log_between(100.0, 0.1 * n as f64), 5.0 + 10.0 * random.uniform());
    let (a, b) = (TAU * random.uniform(), TAU * random.uniform());
    let height = |t: f64| 1.0 + 0.8 * (TAU * slow * t + b).sin();
    (0..n).map(|i| fraction(i, n)).map(|t| height(t) * (TAU * fast * t + a).sin()).collect()
}

fn logistic(seed: u64, n: usize) -> Vec<f64> {
    let mut x = 0.1 + 0.8 * Random::new(seed).uniform();
    (0..n)
        .map(|_| {
            x *= 3.99 * (1.0 - x);
            x
        })
        .collect()
}

/// The first coordinate of Lorenz's system, every 0.03.
fn lorenz(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let f = |[x, y, z]: [f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let along = |s: [f64; 3], k: [f64; 3], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    let mut s = [1.0 + random.uniform(), random.normal(), 20.0 + random.uniform()];
    let mut step = || {
        let h = 0.01;
        let k1 = f(s);
        let k2 = f(along(s, k1, 0.5 * h));
        let k3 = f(along(s, k2, 0.5 * h));
        let k4 = f(along(s, k3, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        s[0]
    };
    (0..1000).for_each(|_| {
        step();
    });
    (0..n).map(|_| (0..3).map(|_| step()).last().unwrap_or(0.0)).collect()
}

/// Bursts of very different height at random times.
fn bursts(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let (mut height, mut left) = (0.0, 0);
    (0..n)
        .map(|_| {
            if left == 0 {
                left = 20 + (180.0 * random.uniform()) as u32;
                height = (4.0 * (random.uniform() + random.uniform() + random.uniform() - 1.5)).exp();
            }
            left -= 1;
            height * (1.0 + 0.1 * (2.0 * random.uniform() - 1.0))
        })
        .collect()
}

fn walk(seed: u64, n: usize) -> Vec<f64> {
    let mut sum = 0.0;
    white(seed, n)
        .into_iter()
        .map(|x| {
            sum += x;
            sum
        })
        .collect()
}

const BOUNDED: [(&str, Make); 9] = [
    ("white", white),
    ("violet", violet),
    ("pink", pink),
    ("red", red),
    ("periodic", periodic),
    ("quasi-periodic", quasi_periodic),
    ("beating", beating),
    ("logistic", logistic),
    ("lorenz", lorenz),
];

/// The series with a drift that ends at `widths` times its range.
fn drifting(mut series: Vec<f64>, widths: f64) -> Vec<f64> {
    let n = series.len();
    let range = series.iter().copied().fold(f64::MIN, f64::max) - series.iter().copied().fold(f64::MAX, f64::min);
    series.iter_mut().enumerate().for_each(|(i, x)| *x += widths * range * fraction(i + 1, n));
    series
}

/// The verdict on a series as a run would meet it, of the size of a good integrator's error.
fn judged(series: &[f64]) -> Growth {
    let mut blocks = Series::<1>::new(series.len() as u64);
    for (i, x) in series.iter().enumerate() {
        blocks.push((i + 1) as f64 * 1e-3, [1e-9 * x]);
    }
    let stretches: Vec<Stretch> =
        blocks.blocks.iter().map(|b| Stretch { to: b.to, count: b.count, error: b.values[0] }).collect();
    growth(&stretches, false).expect("long enough")
}

/// How many of the seeds pass.
fn count(passes: impl Fn(u64) -> bool) -> usize {
    SEEDS.filter(|&seed| passes(seed)).count()
}

#[test]
fn false_alarms_on_bounded_series_are_below_one_percent() {
    for (name, make) in BOUNDED {
        let alarms = count(|seed| judged(&make(seed, STEPS)).verdict != Verdict::Bounded);
        // measured at most 3, on red noise
        assert!(alarms < 10, "{name}: {alarms} of 1000");
    }
}

#[test]
fn false_alarms_stay_rare_in_short_and_long_runs() {
    for (steps, seeds) in [(MIN_STEPS as usize, 1000), (20_000, 300)] {
        for (name, make) in BOUNDED {
            let alarms = SEEDS.take(seeds).filter(|&s| judged(&make(s, steps)).verdict != Verdict::Bounded).count();
            // most on pink noise in the short runs
            assert!(100 * alarms < seeds, "{name}, {steps} steps: {alarms} of {seeds}");
        }
    }
}

#[test]
fn a_drift_that_doubles_the_band_is_found_and_named() {
    for (name, make) in BOUNDED {
        let of = |seed| judged(&drifting(make(seed, STEPS), if seed % 2 == 0 { 1.0 } else { -1.0 })).verdict;
        let verdicts: Vec<Verdict> = SEEDS.map(of).collect();
        let called = |v| verdicts.iter().filter(|x| **x == v).count();
        // measured all found; at least 995 named, on red noise
        assert_eq!(called(Verdict::Bounded), 0, "{name}");
        assert!(called(Verdict::Drift) >= 990, "{name}: {}", called(Verdict::Drift));
    }
}

#[test]
fn a_drift_that_doubles_the_largest_error_is_mostly_found() {
    for (name, make) in BOUNDED {
        let found = count(|seed| judged(&drifting(make(seed, STEPS), 0.5)).verdict > Verdict::Bounded);
        // measured at least 985, on Lorenz's system; 994 on pink noise
        assert!(found >= 975, "{name}: {found} of 1000");
    }
}

/// The error swings about its mean ever more widely, to twice the width.
#[test]
fn a_band_that_widens_is_mostly_found() {
    for (name, make) in BOUNDED {
        let widening = |seed| {
            let mut series = make(seed, STEPS);
            let mean = series.iter().sum::<f64>() / STEPS as f64;
            series.iter_mut().enumerate().for_each(|(i, x)| *x = (*x - mean) * (1.0 + fraction(i + 1, STEPS)));
            judged(&series).verdict
        };
        let found = SEEDS.take(300).filter(|&seed| widening(seed) > Verdict::Bounded).count();
        // measured 172 on beating, 248 on quasi-periodic, at least 293 on the others
        assert!(found >= 150, "{name}: {found} of 300");
    }
}

#[test]
fn random_walks_are_recognised() {
    for (steps, seeds) in [(STEPS, 1000), (100_000, 100)] {
        let called = SEEDS.take(seeds).filter(|&s| judged(&walk(s, steps)).verdict == Verdict::RandomWalk).count();
        // measured 934 of 1000 and 94 of 100
        assert!(100 * called >= 90 * seeds, "{steps} steps: {called} of {seeds}");
    }
}

/// A hard case: the run holds about 35 bursts, and one of them may be larger than all others together.
#[test]
fn bursts_of_very_different_height_are_mostly_bounded() {
    let bounded = count(|seed| judged(&bursts(seed, STEPS)).verdict == Verdict::Bounded);
    // measured 987
    assert!(bounded >= 975, "{bounded} of 1000");
}

/// The interval holds the exponent of the law about as often as it says.
#[test]
fn confidence_intervals_hold_the_exponent() {
    let covered = |make: &dyn Fn(u64) -> Vec<f64>, exponent: f64, verdict| {
        let found: Vec<Growth> = SEEDS.take(500).map(|s| judged(&make(s))).filter(|g| g.verdict == verdict).collect();
        let holds = |g: &&Growth| g.exponent.is_some_and(|e| e.low <= exponent && exponent <= e.high);
        assert!(found.len() > 400, "{}", found.len());
        found.iter().filter(holds).count() as f64 / found.len() as f64
    };
    let walks = covered(&|s| walk(s, STEPS), 0.5, Verdict::RandomWalk);
    // measured 0.955
    assert!(walks > 0.93, "{walks}");
    for (name, make) in BOUNDED {
        let drifts = covered(&|s| drifting(make(s, STEPS), 1.0), 1.0, Verdict::Drift);
        // measured at least 0.89, on pink noise; 0.94 and more on the others
        assert!(drifts > 0.85, "{name}: {drifts}");
        assert_eq!(covered(&|s| make(s, STEPS), 0.0, Verdict::Bounded), 1.0, "{name}");
    }
}

#[test]
fn laws_without_noise_have_their_exponents() {
    let of = |f: &dyn Fn(f64) -> f64| judged(&(1..=STEPS).map(|i| f(fraction(i, STEPS))).collect::<Vec<f64>>());
    for (power, law) in [(1.0, 1.0), (2.0, 2.0), (0.5, 0.5)] {
        let found = of(&|t| -3e2 * t.powf(power));
        let exponent = found.exponent.expect("judged");
        assert_eq!(found.verdict, Verdict::Drift, "{power}: {found:?}");
        assert!((exponent.value - law).abs() < 0.02, "{power}: {exponent:?}");
    }
    let line = of(&|t| -3e2 * t);
    assert!((line.slope_per_s.expect("judged") + 3e-7 / (STEPS as f64 * 1e-3)).abs() < 1e-12, "{line:?}");
    let widening = of(&|t| t * (TAU * 300.0 * t).sin());
    assert_eq!(widening.verdict, Verdict::Drift);
    assert!((widening.exponent.expect("judged").value - 1.0).abs() < 0.02, "{widening:?}");
    let swing = of(&|t| 1.0 - (TAU * 5.5 * t).cos());
    assert_eq!(swing.verdict, Verdict::Bounded);
}

#[test]
fn blow_ups_roundoff_and_short_runs() {
    let of = |n: usize, f: &dyn Fn(f64) -> f64| {
        let mut blocks = Series::<1>::new(n as u64);
        (1..=n).for_each(|i| blocks.push(i as f64, [f(fraction(i, n))]));
        let stretches: Vec<Stretch> =
            blocks.blocks.iter().map(|b| Stretch { to: b.to, count: b.count, error: b.values[0] }).collect();
        growth(&stretches, false)
    };
    let explosion = of(STEPS, &|t| 1e-12 * (40.0 * t).exp()).expect("judged");
    assert_eq!((explosion.verdict, explosion.exponent), (Verdict::BlowUp, None));
    assert_eq!(of(STEPS, &|t| 4.0 * f64::EPSILON * t).expect("judged").verdict, Verdict::Bounded);
    assert_eq!(of(STEPS, &|t| 1e-12 * (20.0 * t).exp()).expect("judged").verdict, Verdict::Drift);
    assert_eq!(of(MIN_STEPS as usize - 1, &|t| t), None);
    assert_eq!(of(100, &|t| 11.0 * t).expect("a blow-up needs no length").verdict, Verdict::BlowUp);
}
