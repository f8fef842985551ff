//! Discrete mechanics on linear spaces (Marsden and West 2001, parts 1 to 4).
