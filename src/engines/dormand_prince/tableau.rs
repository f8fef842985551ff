//! Coefficients of DOP853 with all digits of its authors' program `dop853.f` (Hairer, Norsett and Wanner, Solving
//! Ordinary Differential Equations I, 2nd ed. 1993, section II.10).
//!
//! `k_i = f(t + c_i h, y + h sum_j a_ij k_j)` and `y' = y + h sum_i b_i k_i`.

pub const STAGES: usize = 12;

/// Nodes `c_i`.
pub const C: [f64; STAGES] = [
    0.0,
    0.0526001519587677318785587544488,
    0.0789002279381515978178381316732,
    0.118350341907227396726757197510,
    0.281649658092772603273242802490,
    0.333333333333333333333333333333,
    0.25,
    0.307692307692307692307692307692,
    0.651282051282051282051282051282,
    0.6,
    0.857142857142857142857142857142,
    1.0,
];

/// `a_ij`: stage `i` lies at `y + h sum_j a_ij k_j`.
pub const A: [[f64; STAGES]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [5.26001519587677318785587544488e-2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [
        1.97250569845378994544595329183e-2,
        5.91751709536136983633785987549e-2,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        2.95875854768068491816892993775e-2,
        0.0,
        8.87627564304205475450678981324e-2,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        2.41365134159266685502369798665e-1,
        0.0,
        -8.84549479328286085344864962717e-1,
        9.24834003261792003115737966543e-1,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        3.7037037037037037037037037037e-2,
        0.0,
        0.0,
        1.70828608729473871279604482173e-1,
        1.25467687566822425016691814123e-1,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        3.7109375e-2,
        0.0,
        0.0,
        1.70252211019544039314978060272e-1,
        6.02165389804559606850219397283e-2,
        -1.7578125e-2,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        3.70920001185047927108779319836e-2,
        0.0,
        0.0,
        1.70383925712239993810214054705e-1,
        1.07262030446373284651809199168e-1,
        -1.53194377486244017527936158236e-2,
        8.27378916381402288758473766002e-3,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        6.24110958716075717114429577812e-1,
        0.0,
        0.0,
        -3.36089262944694129406857109825,
        -8.68219346841726006818189891453e-1,
        2.75920996994467083049415600797e1,
        2.01540675504778934086186788979e1,
        -4.34898841810699588477366255144e1,
        0.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        4.77662536438264365890433908527e-1,
        0.0,
        0.0,
        -2.48811461997166764192642586468,
        -5.90290826836842996371446475743e-1,
        2.12300514481811942347288949897e1,
        1.52792336328824235832596922938e1,
        -3.32882109689848629194453265587e1,
        -2.03312017085086261358222928593e-2,
        0.0,
        0.0,
        0.0,
    ],
    [
        -9.3714243008598732571704021658e-1,
        0.0,
        0.0,
        5.18637242884406370830023853209,
        1.09143734899672957818500254654,
        -8.14978701074692612513997267357,
        -1.85200656599969598641566180701e1,
        2.27394870993505042818970056734e1,
        2.49360555267965238987089396762,
        -3.0467644718982195003823669022,
        0.0,
        0.0,
    ],
    [
        2.27331014751653820792359768449,
        0.0,
        0.0,
        -1.05344954667372501984066689879e1,
        -2.00087205822486249909675718444,
        -1.79589318631187989172765950534e1,
        2.79488845294199600508499808837e1,
        -2.85899827713502369474065508674,
        -8.87285693353062954433549289258,
        1.23605671757943030647266201528e1,
        6.43392746015763530355970484046e-1,
        0.0,
    ],
];

/// Weights `b_i` of order 8.
pub const B: [f64; STAGES] = [
    5.42937341165687622380535766363e-2,
    0.0,
    0.0,
    0.0,
    0.0,
    4.45031289275240888144113950566,
    1.89151789931450038304281599044,
    -5.8012039600105847814672114227,
    3.1116436695781989440891606237e-1,
    -1.52160949662516078556178806805e-1,
    2.01365400804030348374776537501e-1,
    4.47106157277725905176885569043e-2,
];

/// `b_i` less the weights of the embedded method of order 5.
pub const LESS_FIFTH: [f64; STAGES] = [
    0.1312004499419488073250102996e-1,
    0.0,
    0.0,
    0.0,
    0.0,
    -0.1225156446376204440720569753e1,
    -0.4957589496572501915214079952,
    0.1664377182454986536961530415e1,
    -0.3503288487499736816886487290,
    0.3341791187130174790297318841,
    0.8192320648511571246570742613e-1,
    -0.2235530786388629525884427845e-1,
];

/// Weights of the embedded method of order 3.
pub const THIRD: [f64; STAGES] = [
    0.244094488188976377952755905512,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.733846688281611857341361741547,
    0.0,
    0.0,
    0.220588235294117647058823529412e-1,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// A rooted tree: its order, and the trees that hang on its root, by their places in a list.
    struct Tree {
        order: usize,
        branches: Vec<usize>,
    }

    /// Rooted trees up to an order.
    fn trees(most: usize) -> Vec<Tree> {
        let mut all: Vec<Tree> = Vec::new();
        for order in 1..=most {
            let of_order = forests(&all, order - 1, all.len());
            all.extend(of_order.into_iter().map(|branches| Tree { order, branches }));
        }
        all
    }

    /// All ways to choose trees with so many nodes together, each not behind the one before it.
    fn forests(all: &[Tree], nodes: usize, below: usize) -> Vec<Vec<usize>> {
        if nodes == 0 {
            return vec![Vec::new()];
        }
        let first = (0..below).filter(|&k| all[k].order <= nodes);
        let rest = |k: usize| forests(all, nodes - all[k].order, k + 1).into_iter().map(move |f| [vec![k], f].concat());
        first.flat_map(rest).collect()
    }

    /// The largest error of `sum_i w_i phi_i(tree) = 1 / gamma(tree)`, or `= 0`, over the trees of one order (Hairer,
    /// Norsett and Wanner, theorem II.2.13).
    fn defect(weights: &[f64; STAGES], order: usize, consistent: bool) -> f64 {
        let all = trees(order);
        let (mut phi, mut gamma): (Vec<[f64; STAGES]>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut worst = 0.0_f64;
        for tree in &all {
            let through = |i: usize, k: &usize| A[i].iter().zip(&phi[*k]).map(|(a, p)| a * p).sum::<f64>();
            let own = std::array::from_fn(|i| tree.branches.iter().map(|k| through(i, k)).product());
            let density = tree.order as f64 * tree.branches.iter().map(|k| gamma[*k]).product::<f64>();
            let sum: f64 = weights.iter().zip(&own).map(|(w, p): (&f64, &f64)| w * p).sum();
            if tree.order == order {
                worst = worst.max((sum - if consistent { 1.0 / density } else { 0.0 }).abs());
            }
            phi.push(own);
            gamma.push(density);
        }
        worst
    }

    #[test]
    fn there_are_as_many_rooted_trees_as_cayley_counted() {
        let all = trees(9);
        let count = |order| all.iter().filter(|tree| tree.order == order).count();
        assert_eq!([1, 2, 3, 4, 5, 6, 7, 8, 9].map(count), [1, 1, 2, 4, 9, 20, 48, 115, 286]);
    }

    #[test]
    fn nodes_are_the_sums_of_their_rows() {
        for (c, row) in C.iter().zip(&A) {
            // measured at most 6.1e-15, of a row with entries up to 43
            assert!((c - row.iter().sum::<f64>()).abs() <= 1.5e-14, "{c}");
        }
    }

    #[test]
    fn the_weights_meet_all_conditions_of_their_order_and_no_more() {
        let all = |weights, orders: std::ops::RangeInclusive<usize>, consistent| {
            orders.map(|order| defect(weights, order, consistent)).fold(0.0, f64::max)
        };
        let within = [all(&B, 1..=8, true), all(&LESS_FIFTH, 1..=5, false), all(&THIRD, 1..=3, true)];
        let beyond = [defect(&B, 9, true), defect(&LESS_FIFTH, 6, false), defect(&THIRD, 4, true)];
        // measured 2.2e-15, 4.4e-15 and 3.6e-15, of entries up to 43; beyond 2.7e-5, 4.5e-4 and 2.5e-2
        assert!(within.iter().all(|d| *d <= 1e-14), "{within:?}");
        assert!(beyond.iter().all(|d| *d > 1e-5), "{beyond:?}");
    }
}
