//! Adaptive Gauss-Kronrod quadrature (7 and 15 points, the constants of QUADPACK) of several functions at once.

/// Positive nodes of the 15-point rule; those with odd index are the 7-point rule's, and so is 0.
const NODES: [f64; 7] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
];
const KRONROD: [f64; 7] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
];
const KRONROD_MIDDLE: f64 = 0.209_482_141_084_727_82;
const GAUSS: [f64; 3] = [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9];
const GAUSS_MIDDLE: f64 = 0.417_959_183_673_469_4;

/// An interval is halved at most this often: 2^-50 of it is rounding.
const HALVINGS: u32 = 50;

/// Equal pieces to begin with.
const PIECES: i32 = 16;
/// The first and the last of them are cut again at tenths of tenths, down to this power of ten.
const FINEST: i32 = -9;

/// Integrals of `f` over `from..to`. Intervals are halved until the two rules differ by less than `tolerance` in
/// every component; the difference is the error of the poorer rule, far above that of the result.
///
/// A dip or a layer narrower than the first points' distance would be missed by both rules, so the search starts on
/// equal pieces, graded towards both ends.
pub fn integrate<const N: usize>(f: &impl Fn(f64) -> [f64; N], from: f64, to: f64, tolerance: f64) -> [f64; N] {
    let near = || (FINEST..-1).map(|power| 10_f64.powi(power));
    let mut edges = vec![0.0];
    edges.extend(near());
    edges.extend((1..PIECES).map(|i| f64::from(i) / f64::from(PIECES)));
    edges.extend(near().map(|part| 1.0 - part).rev());
    edges.push(1.0);
    let at = |part: f64| from + (to - from) * part;
    let pieces = edges.windows(2).map(|edge| halved(f, at(edge[0]), at(edge[1]), tolerance, HALVINGS));
    pieces.fold([0.0; N], |sum, piece| std::array::from_fn(|c| sum[c] + piece[c]))
}

fn halved<const N: usize>(f: &impl Fn(f64) -> [f64; N], from: f64, to: f64, tolerance: f64, left: u32) -> [f64; N] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let at_middle = f(middle);
    let mut kronrod = at_middle.map(|y| y * KRONROD_MIDDLE * half);
    let mut gauss = at_middle.map(|y| y * GAUSS_MIDDLE * half);
    for (i, node) in NODES.iter().enumerate() {
        for y in [f(middle - half * node), f(middle + half * node)] {
            for c in 0..N {
                kronrod[c] += KRONROD[i] * half * y[c];
                if i % 2 == 1 {
                    gauss[c] += GAUSS[i / 2] * half * y[c];
                }
            }
        }
    }
    if left == 0 || (0..N).all(|c| (kronrod[c] - gauss[c]).abs() <= tolerance) {
        return kronrod;
    }
    let (a, b) = (halved(f, from, middle, tolerance, left - 1), halved(f, middle, to, tolerance, left - 1));
    std::array::from_fn(|c| a[c] + b[c])
}
