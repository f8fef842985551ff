//! The figures of Marsden and West (2001) and the tables of orders, conservation and small steps, computed by
//! [`crate::discrete`].

pub(crate) mod energy;
pub(crate) mod long_time;
pub(crate) mod orders;
pub(crate) mod small_steps;
mod topic;

pub(crate) use topic::{Computed, Conserved, ProblemOrders, ProblemSteps, Topic};

/// All topics, in the order of the page. A new one is a file, a line here, a kind of [`Computed`] with its record, and
/// a section of the page.
pub(crate) const TOPICS: [Topic; 5] =
    [orders::TOPIC, energy::FIGURE_1, energy::FIGURE_2, long_time::TOPIC, small_steps::TOPIC];
