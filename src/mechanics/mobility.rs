//! What loops and couplings leave free.

/// How many motions the loops and couplings leave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mobility {
    /// Coordinates that the tree leaves free.
    pub tree: usize,
    /// Rows of all loops and couplings, and how many of them are independent in the initial configuration.
    pub rows: usize,
    pub rank: usize,
    /// For each loop, then each coupling: rows that those before it already imply.
    pub redundant: Vec<usize>,
}

impl Mobility {
    /// Degrees of freedom in the initial configuration.
    pub fn degrees_of_freedom(&self) -> usize {
        self.tree - self.rank
    }
}
