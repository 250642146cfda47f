//! The precision table: every elementary function of core against `f64`, in units in the last place, and its lanes.
//!
//! A row is a function, a domain and the error that its documentation promises. By default every 257th float of the
//! domain is tried and all floats around the seams of the range reductions; `WOODCOCK_EXHAUSTIVE=1` tries every float,
//! which takes minutes a row. A row is worth nothing unless it notices a coefficient that is one part in a million off:
//! that is tried too.

use std::f64::consts::{LN_2, TAU};
use woodcock_core::elementary::turn_of;
use woodcock_core::real::Real;
use woodcock_packet::lanes::{LANES, Lanes};

mod points;

/// A function and what is promised of it.
struct Row {
    /// As in core, or followed by what it is one part of.
    name: &'static str,
    /// All floats between these two take part.
    domain: [f32; 2],
    /// The largest error.
    ulps: f64,
    /// Below this, an error counts as if the value had this last place.
    floor: f64,
    one: fn(f32) -> f32,
    eight: fn(Lanes) -> Lanes,
    exact: fn(f64) -> f64,
    /// What the first coefficient of its series contributes.
    first_term: fn(f64) -> f64,
    /// Where reductions change, or rounding is at its worst.
    seams: fn() -> Vec<f32>,
}

const BELOW_ONE: f32 = 1.0_f32.next_down();
/// The least positive number.
const TINY: f32 = f32::from_bits(1);

const TABLE: [Row; 8] = [
    Row {
        name: "ln",
        domain: [TINY, f32::MAX],
        ulps: 0.96,
        floor: 0.0,
        one: Real::ln,
        eight: Real::ln,
        exact: f64::ln,
        first_term: |x| -0.5 * fraction(x).powi(2),
        seams: || binades(-126..128, |scale| [scale, 4.0 / 3.0 * scale]),
    },
    Row {
        name: "ln_1p",
        domain: [-BELOW_ONE, f32::MAX],
        ulps: 0.96,
        floor: 0.0,
        one: Real::ln_1p,
        eight: Real::ln_1p,
        exact: f64::ln_1p,
        first_term: |x| -0.5 * fraction(1.0 + x).powi(2),
        seams: || {
            let mut seams = binades(-24..128, |scale| [scale - 1.0, 4.0 / 3.0 * scale - 1.0]);
            seams.extend([0.0, 0.5, f32::MAX]);
            seams
        },
    },
    Row {
        name: "neg_ln_1m",
        domain: [0.0, BELOW_ONE],
        ulps: 0.89,
        floor: 0.0,
        one: Real::neg_ln_1m,
        eight: Real::neg_ln_1m,
        exact: |u| -(-u).ln_1p(),
        first_term: |u| 0.5 * fraction(1.0 - u).powi(2),
        seams: || {
            let mut seams = binades(-32..0, |scale| [scale, 1.0 - 2.0 / 3.0 * scale]);
            seams.extend([0.0, f32::MIN_POSITIVE, BELOW_ONE]);
            seams
        },
    },
    Row {
        name: "exp",
        domain: [-87.3, 88.7],
        ulps: 0.99,
        floor: 0.0,
        one: Real::exp,
        eight: Real::exp,
        exact: f64::exp,
        first_term: exp_term,
        seams: || half_steps(-126..128),
    },
    Row {
        name: "exp_m1",
        domain: [f32::NEG_INFINITY, 88.7],
        ulps: 1.17,
        floor: 0.0,
        one: Real::exp_m1,
        eight: Real::exp_m1,
        exact: f64::exp_m1,
        first_term: exp_term,
        seams: || half_steps(-38..128),
    },
    Row {
        name: "sin_cos_turn: sine",
        domain: [-4096.0, 4096.0],
        ulps: 1.56,
        floor: 3e-8,
        one: |turn| turn.sin_cos_turn().0,
        eight: |turn| turn.sin_cos_turn().0,
        exact: |turn| sin_cos(turn).0,
        first_term: |turn| sin_cos_terms(turn).0,
        seams: eighths,
    },
    Row {
        name: "sin_cos_turn: cosine",
        domain: [-4096.0, 4096.0],
        ulps: 1.56,
        floor: 3e-8,
        one: |turn| turn.sin_cos_turn().1,
        eight: |turn| turn.sin_cos_turn().1,
        exact: |turn| sin_cos(turn).1,
        first_term: |turn| sin_cos_terms(turn).1,
        seams: eighths,
    },
    Row {
        name: "turn_of: a slope",
        domain: [0.0, f32::MAX],
        ulps: 2.9,
        floor: 0.0,
        one: |slope| turn_of(slope, 1.0),
        eight: |slope| turn_of(slope, Lanes::one()),
        exact: |slope| slope.atan() / TAU,
        first_term: |slope| {
            let term = slope.min(1.0 / slope) / TAU;
            if slope > 1.0 { -term } else { term }
        },
        seams: || binades(-24..128, |scale| [scale, 4.0 / 3.0 * scale]),
    },
];

/// f of x = 2ᵏ (1 + f), in [−1/3, 1/3].
fn fraction(x: f64) -> f64 {
    x / (1.5 * x).log2().floor().exp2() - 1.0
}

/// ½ r² 2ⁿ of x = n ln 2 + r.
fn exp_term(x: f64) -> f64 {
    let x = x.max(-200.0);
    let n = (x / LN_2).round();
    0.5 * (x - n * LN_2).powi(2) * n.exp2()
}

/// The nearest quarter turn, and the angle from there.
fn quarter(turn: f64) -> (u32, f64) {
    let quarters = (4.0 * turn).round();
    let rest = TAU * (turn - 0.25 * quarters);
    (quarters.rem_euclid(4.0) as u32, rest)
}

fn turned(quarter: u32, s: f64, c: f64) -> (f64, f64) {
    [(s, c), (c, -s), (-s, -c), (-c, s)][quarter as usize]
}

fn sin_cos(turn: f64) -> (f64, f64) {
    let (quarter, rest) = quarter(turn);
    turned(quarter, rest.sin(), rest.cos())
}

fn sin_cos_terms(turn: f64) -> (f64, f64) {
    let (quarter, rest) = quarter(turn);
    turned(quarter, rest, -0.5 * rest * rest)
}

/// Places of some powers of two, among them the first and the last.
fn binades(exponents: std::ops::Range<i32>, places: fn(f64) -> [f64; 2]) -> Vec<f32> {
    let last = exponents.end - 1;
    let near_one = exponents.clone().filter(|e| e.abs() < 4);
    let some = exponents.step_by(17).chain(near_one).chain([last]);
    some.flat_map(|e| places(f64::from(e).exp2()))
        .map(|place| place as f32)
        .collect()
}

/// Where n changes, of x = n ln 2 + r; zero and one, and where the result leaves the ordinary.
fn half_steps(n: std::ops::Range<i32>) -> Vec<f32> {
    let near_zero = n.clone().filter(|n| n.abs() < 4);
    let some = n.step_by(11).chain(near_zero).chain([22, 23, 24, 25]);
    let mut seams: Vec<f32> = some.map(|n| ((f64::from(n) + 0.5) * LN_2) as f32).collect();
    seams.extend([0.0, 1.0, -17.33, -26.0, -87.3, 88.7]);
    seams
}

fn eighths() -> Vec<f32> {
    let mut seams: Vec<f32> = (-16..=16).map(|i| i as f32 / 8.0).collect();
    seams.extend([1000.125, -1000.125, -4096.0, 4096.0]);
    seams
}

/// The place of a float among all floats in their order, from minus to plus infinity; −0 comes before 0.
fn place(x: f32) -> i64 {
    let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
    if x.is_sign_negative() {
        -1 - magnitude
    } else {
        magnitude
    }
}

fn float(place: i64) -> f32 {
    if place < 0 {
        -f32::from_bits((-1 - place) as u32)
    } else {
        f32::from_bits(place as u32)
    }
}

/// The largest error met, in ulps of the true value, and where.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    ulps: f64,
    at: f32,
    tested: u64,
}

impl Worst {
    fn merge(self, other: Self) -> Self {
        let tested = self.tested + other.tested;
        let worse = if other.ulps > self.ulps { other } else { self };
        Self { tested, ..worse }
    }
}

/// Spacing of `f32` at a value.
fn ulp(exact: f64) -> f64 {
    let exponent = (exact.abs().to_bits() >> 52) as i32 - 1023;
    2.0_f64.powi(exponent.max(-126) - 23)
}

impl Row {
    /// The error of a result.
    fn error(&self, x: f32, y: f32) -> f64 {
        let exact = (self.exact)(f64::from(x));
        if f64::from(y) == exact {
            return 0.0;
        }
        let error = (f64::from(y) - exact).abs() / ulp(exact).max(self.floor);
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// Every so many floats, in scalars and in lanes.
    fn sweep(&self, [first, last]: [i64; 2], step: i64) -> Worst {
        let mut worst = Worst::default();
        let mut next = first;
        while next <= last {
            let x: [f32; LANES] =
                std::array::from_fn(|i| float((next + i as i64 * step).min(last)));
            let wide = (self.eight)(Lanes::new(x)).to_array();
            for (x, wide) in x.into_iter().zip(wide) {
                let y = (self.one)(x);
                assert_eq!(
                    y.to_bits(),
                    wide.to_bits(),
                    "{}: lanes differ at {x:e}: {y:e} and {wide:e}",
                    self.name
                );
                worst = worst.merge(Worst {
                    ulps: self.error(x, y),
                    at: x,
                    tested: 1,
                });
            }
            next += LANES as i64 * step;
        }
        worst
    }

    /// The whole domain on two threads, and all floats near its ends and its seams.
    fn worst(&self, step: i64) -> Worst {
        let [first, last] = self.domain.map(place);
        let middle = first + (last - first) / 2 / step * step;
        let mut worst = std::thread::scope(|scope| {
            let low = scope.spawn(|| self.sweep([first, middle], step));
            let high = self.sweep([middle + 1, last], step);
            low.join().expect("a sweep ends").merge(high)
        });
        if step > 1 {
            for seam in (self.seams)().into_iter().chain(self.domain) {
                let near = [-10_000, 10_000].map(|by| (place(seam) + by).clamp(first, last));
                worst = worst.merge(self.sweep(near, 1));
            }
        }
        worst
    }

    /// The error of a mutant whose first coefficient is one part in a million off.
    fn worst_of_mutant(&self, sign: f64) -> Worst {
        let [first, last] = self.domain.map(place);
        let sample = (first..=last).step_by(4099).map(|place| {
            let x = float(place);
            let off = sign * 1e-6 * (self.first_term)(f64::from(x));
            let y = (f64::from((self.one)(x)) + off) as f32;
            Worst {
                ulps: self.error(x, y),
                at: x,
                tested: 1,
            }
        });
        sample.fold(Worst::default(), Worst::merge)
    }
}

#[test]
fn functions_keep_their_bounds() {
    let exhaustive = std::env::var_os("WOODCOCK_EXHAUSTIVE").is_some_and(|value| value == "1");
    for row in &TABLE {
        let Worst { ulps, at, tested } = row.worst(if exhaustive { 1 } else { 257 });
        let name = row.name;
        println!("{name}: {ulps:.4} ulp at {at:e} of {tested} floats");
        assert!(tested > 4_000_000, "{name}: only {tested} floats");
        assert!(
            ulps <= row.ulps,
            "{name}: {ulps:.4} ulp at {at:e}, promised {}",
            row.ulps
        );
    }
}

#[test]
fn a_coefficient_slightly_off_is_seen() {
    for row in &TABLE {
        for sign in [-1.0, 1.0] {
            let Worst { ulps, at, .. } = row.worst_of_mutant(sign);
            println!("{}: {ulps:.3} ulp at {at:e}", row.name);
            assert!(ulps > 1.2 * row.ulps, "{}: only {ulps:.3} ulp", row.name);
        }
    }
}

/// Each function of core has a row here and a line there, with one number.
#[test]
fn the_table_is_complete() {
    let source = include_str!("../../../core/src/elementary.rs");
    let starts = source
        .lines()
        .filter_map(|line| line.strip_prefix("pub fn "));
    let names: Vec<&str> = starts
        .filter_map(|rest| rest.split(['<', '(']).next())
        .collect();
    assert!(names.len() >= 6, "{names:?}");
    for name in names {
        let mut lines = source.lines();
        let line = lines.find(|line| line.starts_with(&format!("//! | [`{name}`] |")));
        let line = line.unwrap_or_else(|| panic!("{name} is not in core's table"));
        let mut rows = TABLE
            .iter()
            .filter(|row| row.name.split(':').next() == Some(name));
        let row = rows.next().unwrap_or_else(|| panic!("{name} has no row"));
        let promise = format!("≤ {} ulp", row.ulps);
        assert!(line.contains(&promise), "{line}: not {promise}");
        assert!(rows.all(|other| other.ulps == row.ulps));
    }
}
