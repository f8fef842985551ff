//! A long run in few numbers: consecutive steps are gathered in blocks that keep extremes and mean.

/// At most this many blocks make up a run.
pub(crate) const MAX_BLOCKS: u64 = 400;

/// What is known of one quantity over a block of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    pub min: f64,
    pub max: f64,
    pub mean: f64,
}

impl Extent {
    fn of(value: f64) -> Extent {
        Extent { min: value, max: value, mean: value }
    }

    /// Takes in the `count`-th value.
    fn add(&mut self, value: f64, count: u64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.mean += (value - self.mean) / count as f64;
    }

    /// The extent of two neighbouring stretches of `a` and `b` steps.
    pub fn join(self, a: f64, other: Extent, b: f64) -> Extent {
        Extent {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            mean: (self.mean * a + other.mean * b) / (a + b),
        }
    }

    /// Half of the range.
    pub(crate) fn half_width(self) -> f64 {
        0.5 * (self.max - self.min)
    }

    /// Largest absolute value.
    pub fn amplitude(self) -> f64 {
        self.max.max(-self.min)
    }
}

/// `N` quantities over a block of consecutive steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Block<const N: usize> {
    /// Time of the first and of the last step, s.
    pub from: f64,
    pub to: f64,
    pub count: u64,
    pub values: [Extent; N],
}

/// `N` quantities over a run, in at most `MAX_BLOCKS` blocks of equally many steps; the last one may have fewer.
/// Memory does not grow with the number of steps.
#[derive(Clone, Debug)]
pub struct Series<const N: usize> {
    width: u64,
    pub blocks: Vec<Block<N>>,
}

impl<const N: usize> Series<N> {
    /// For a run of `steps` steps.
    pub fn new(steps: u64) -> Series<N> {
        Series { width: steps.div_ceil(MAX_BLOCKS).max(1), blocks: Vec::new() }
    }

    /// Takes in the values of the next step.
    pub fn push(&mut self, time: f64, values: [f64; N]) {
        match self.blocks.last_mut().filter(|block| block.count < self.width) {
            Some(block) => {
                block.to = time;
                block.count += 1;
                for (extent, value) in block.values.iter_mut().zip(values) {
                    extent.add(value, block.count);
                }
            }
            None => self.blocks.push(Block { from: time, to: time, count: 1, values: values.map(Extent::of) }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_of_one_step_in_a_million_is_kept() {
        let steps = 1_000_000;
        let mut series = Series::<1>::new(steps);
        for n in 1..=steps {
            series.push(n as f64, [if n == 123_456 { -7.0 } else { (n % 2) as f64 }]);
        }
        assert_eq!(series.blocks.len() as u64, MAX_BLOCKS);
        let lowest = series.blocks.iter().map(|b| b.values[0].min).fold(f64::INFINITY, f64::min);
        assert_eq!(lowest, -7.0);
        assert!((series.blocks[0].values[0].mean - 0.5).abs() < 1e-12);
        assert_eq!(series.blocks.iter().map(|b| b.count).sum::<u64>(), steps);
    }

    #[test]
    fn a_short_run_keeps_every_step() {
        let mut series = Series::<2>::new(3);
        for n in 1..=3 {
            series.push(n as f64, [n as f64, -1.0]);
        }
        assert_eq!(series.blocks.len(), 3);
        assert_eq!(series.blocks[2].values[0], Extent { min: 3.0, max: 3.0, mean: 3.0 });
    }
}
