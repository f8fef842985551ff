//! General theory of discrete mechanics (Marsden and West 2001; Patrick and Cuell 2008/09) as computations.

#[path = "../common/mod.rs"]
mod common;
mod constraints;
mod forces;
mod long_time;
mod order;
mod patrick_cuell;
mod theorems;
mod time;
