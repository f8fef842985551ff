//! Figures taken from the states that engines return, by one implementation for all of them.
