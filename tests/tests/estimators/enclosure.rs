//! Enclosures: whatever numbers lie within the operands, exact and rounded results lie within the result.

use woodcock_core::enclosure::Enclosure;
use woodcock_core::real::Real;
use woodcock_tests::stats::independent::SplitMix;

type Enclosures = fn(Enclosure, Enclosure) -> Enclosure;

/// An operation on two numbers, three times over; those on one ignore the second.
struct Operation {
    name: &'static str,
    enclosures: Enclosures,
    exact: fn(f64, f64) -> f64,
    single: fn(f32, f32) -> f32,
}

const fn operation(
    name: &'static str,
    enclosures: Enclosures,
    exact: fn(f64, f64) -> f64,
    single: fn(f32, f32) -> f32,
) -> Operation {
    Operation {
        name,
        enclosures,
        exact,
        single,
    }
}

const OPERATIONS: [Operation; 13] = [
    operation("add", |a, b| a + b, |x, y| x + y, |x, y| x + y),
    operation("sub", |a, b| a - b, |x, y| x - y, |x, y| x - y),
    operation("mul", |a, b| a * b, |x, y| x * y, |x, y| x * y),
    operation("div", |a, b| a / b, |x, y| x / y, |x, y| x / y),
    operation("min", Enclosure::min, f64::min, Real::min),
    operation("max", Enclosure::max, f64::max, Real::max),
    operation("hull, first", Enclosure::hull, |x, _| x, |x, _| x),
    operation("neg", |a, _| -a, |x, _| -x, |x, _| -x),
    operation("abs", |a, _| a.abs(), |x, _| x.abs(), |x, _| Real::abs(x)),
    operation("square", |a, _| a.square(), |x, _| x * x, |x, _| x * x),
    operation(
        "sqrt",
        |a, _| a.sqrt(),
        |x, _| x.sqrt(),
        |x, _| Real::sqrt(x),
    ),
    operation("exp", |a, _| a.exp(), |x, _| x.exp(), |x, _| Real::exp(x)),
    operation("ln", |a, _| a.ln(), |x, _| x.ln(), |x, _| Real::ln(x)),
];

const SPECIAL: [f32; 22] = [
    0.0,
    -0.0,
    f32::from_bits(1),
    -f32::from_bits(1),
    f32::from_bits(3),
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-20,
    -1e-23,
    0.5,
    1.0,
    -1.0,
    1.000_000_1,
    3.0,
    -10.0,
    88.7,
    88.722_84,
    -103.97,
    1e19,
    -3e38,
    f32::MAX,
    f32::MIN,
];

fn number(rng: &mut SplitMix) -> f32 {
    let bits = rng.bits();
    match bits % 4 {
        0 => SPECIAL[(bits >> 8) as usize % SPECIAL.len()],
        1 => (100.0 * rng.normal()) as f32,
        2 => rng.normal() as f32,
        _ => Some(f32::from_bits((bits >> 32) as u32))
            .filter(|x| x.is_finite())
            .unwrap_or(1.5),
    }
}

/// An enclosure and numbers that lie in it. Beyond the largest float there are numbers too.
fn enclosure(rng: &mut SplitMix) -> (Enclosure, [f64; 6]) {
    let (a, mut b) = (number(rng), number(rng));
    match rng.bits() % 4 {
        0 => b = a,
        1 => b = a.next_up().next_up(),
        _ => {}
    }
    let (mut low, mut high) = (f64::from(a.min(b)), f64::from(a.max(b)));
    let mut ends = (a.min(b), a.max(b));
    match rng.bits() % 16 {
        0 => (low, ends.0) = (-1e300, f32::NEG_INFINITY),
        1 => (high, ends.1) = (1e300, f32::INFINITY),
        _ => {}
    }
    let inner = || {
        let x = low + rng.uniform() * (high - low);
        // Between the ends, as numbers of single precision are.
        f64::from(x as f32).clamp(low, high)
    };
    let inside: [f64; 2] = core::array::from_fn({
        let mut inner = inner;
        move |_| inner()
    });
    let zero = 0.0_f64.clamp(low, high);
    let members = [
        low,
        high,
        inside[0],
        inside[1],
        zero,
        -zero.clamp(-high, -low),
    ];
    (Enclosure::new(ends.0, ends.1), members)
}

/// How many results of random operands escape the enclosure that `operation` gives.
fn escapes(operation: &Operation, trials: u32) -> u32 {
    let mut rng = SplitMix::new(600);
    let mut escaped = 0;
    for _ in 0..trials {
        let ((a, xs), (b, ys)) = (enclosure(&mut rng), enclosure(&mut rng));
        let result = (operation.enclosures)(a, b);
        for x in xs {
            assert!(a.contains(x), "{x} is not in {a:?}");
            for y in ys {
                let exact = (operation.exact)(x, y);
                let single = f64::from((operation.single)(x as f32, y as f32));
                escaped += u32::from(!result.contains(exact)) + u32::from(!result.contains(single));
            }
        }
    }
    escaped
}

#[test]
fn no_result_escapes() {
    for operation in &OPERATIONS {
        assert_eq!(escapes(operation, 60_000), 0, "{}", operation.name);
    }
}

/// Interval arithmetic as one writes it first; each mistake lets results escape.
#[test]
fn careless_arithmetic_lets_results_escape() {
    let mutants: [(&str, &str, Enclosures); 10] = [
        ("add", "ends rounded to nearest", |a, b| {
            Enclosure::new(a.low() + b.low(), a.high() + b.high())
        }),
        ("sub", "low from low", |a, b| {
            Enclosure::new(a.low() - b.low(), a.high() - b.high())
        }),
        ("mul", "as if positive", |a, b| {
            let down = (a.low() * b.low()).next_down();
            Enclosure::new(down, (a.high() * b.high()).next_up())
        }),
        ("div", "through zero", |a, b| {
            let ends = [a.low(), a.high()].map(|x| [x / b.low(), x / b.high()]);
            let all = ends.as_flattened().iter();
            let low = all.clone().fold(f32::INFINITY, |m, x| m.min(*x));
            let high = all.fold(f32::NEG_INFINITY, |m, x| m.max(*x));
            Enclosure::new(low.next_down(), high.next_up())
        }),
        ("min", "the maximum's upper end", |a, b| {
            Enclosure::new(a.low().max(b.low()), a.high().max(b.high()))
        }),
        ("max", "the first operand", |a, _| a),
        ("abs", "zero forgotten", |a, _| {
            let (x, y) = (a.low().abs(), a.high().abs());
            Enclosure::new(x.min(y), x.max(y))
        }),
        ("square", "zero forgotten", |a, _| {
            let (x, y) = (a.low() * a.low(), a.high() * a.high());
            Enclosure::new(x.min(y).next_down(), x.max(y).next_up())
        }),
        ("exp", "ends as computed", |a, _| {
            Enclosure::new(Real::exp(a.low()), Real::exp(a.high()))
        }),
        ("ln", "ends as computed", |a, _| {
            Enclosure::new(Real::ln(a.low()), Real::ln(a.high()))
        }),
    ];
    for (name, mistake, enclosures) in mutants {
        let original = OPERATIONS.iter().find(|o| o.name == name).expect("a name");
        let mutant = Operation {
            enclosures,
            ..*original
        };
        let escaped = escapes(&mutant, 2000);
        assert!(escaped >= 10, "{name}, {mistake}: {escaped} escapes");
    }
}

/// Bounds of everything would hold as well; these are close.
#[test]
fn bounds_are_tight_where_nothing_is_uncertain() {
    let mut rng = SplitMix::new(601);
    for operation in &OPERATIONS {
        let mut finite = 0;
        for _ in 0..20_000 {
            let (x, y) = (number(&mut rng), number(&mut rng));
            let y = if operation.name.starts_with("hull") {
                x
            } else {
                y
            };
            let result = (operation.enclosures)(Enclosure::point(x), Enclosure::point(y));
            let exact = (operation.exact)(f64::from(x), f64::from(y));
            if !exact.is_finite() || exact.abs() > 3.4e38 {
                continue;
            }
            finite += 1;
            let width = f64::from(result.high()) - f64::from(result.low());
            let ulps = match operation.name {
                "min" | "max" | "neg" | "abs" => 0.0,
                "exp" | "ln" => 24.0,
                _ => 2.0,
            };
            let ulp = f64::from((exact.abs() as f32).next_up()) - f64::from(exact.abs() as f32);
            assert!(
                width <= ulps * ulp,
                "{} of {x:e} and {y:e}: {result:?} for {exact:e}",
                operation.name
            );
        }
        assert!(finite > 4000, "{}: {finite}", operation.name);
    }
    // What is exactly zero stays so: an empty cell remains empty.
    let zero = Enclosure::point(0.0);
    let some = Enclosure::new(-2.0, 3.0);
    for exact in [
        zero * some,
        zero / Enclosure::new(1.0, 2.0),
        some.min(zero).max(zero),
        zero.sqrt(),
        zero.square(),
    ] {
        assert_eq!((exact.low(), exact.high()), (0.0, 0.0));
    }
    // And what cannot be negative is not.
    let tiny = Enclosure::point(1e-30);
    for low in [
        (tiny * tiny).low(),
        tiny.square().low(),
        Enclosure::point(-200.0).exp().low(),
        (tiny / 1e30).low(),
    ] {
        assert_eq!(low, 0.0);
    }
}

/// `exp` and `ln` over their domains, in steps that meet every exponent many times.
#[test]
fn library_functions_stay_within_their_bounds() {
    for bits in (0..f32::INFINITY.to_bits()).step_by(4_099) {
        let x = f32::from_bits(bits);
        let next = x.next_up();
        let check = |result: Enclosure, exact: [f64; 2], single: [f32; 2]| {
            for value in exact.into_iter().chain(single.map(f64::from)) {
                assert!(result.contains(value), "{x:e}: {value:e} not in {result:?}");
            }
        };
        let both = Enclosure::new(x, next);
        let pair = [f64::from(x), f64::from(next)];
        check(
            both.exp(),
            pair.map(f64::exp),
            [Real::exp(x), Real::exp(next)],
        );
        check(
            (-both).exp(),
            pair.map(|x| (-x).exp()),
            [Real::exp(-x), Real::exp(-next)],
        );
        check(both.ln(), pair.map(f64::ln), [Real::ln(x), Real::ln(next)]);
    }
}

#[test]
fn what_cannot_be_bounded_is_everything() {
    let everything = Enclosure::EVERYTHING;
    let (zero, one) = (Enclosure::point(0.0), Enclosure::point(1.0));
    let infinite = Enclosure::new(1.0, f32::INFINITY);
    for unbounded in [
        Enclosure::new(2.0, 1.0),
        Enclosure::new(f32::NAN, 1.0),
        Enclosure::point(f32::NAN),
        one / zero,
        one / Enclosure::new(-1.0, 1.0),
        infinite - infinite,
        infinite * zero,
        infinite / infinite,
        Enclosure::new(-1.0, 1.0).sqrt(),
        Enclosure::new(-1.0, 1.0).ln(),
        Enclosure::new(-0.0, 1.0).ln(),
        // No minimum brings a NaN back.
        everything.min(one),
        one.max(everything),
        everything.abs(),
        everything.square(),
        everything.exp(),
        everything * zero,
    ] {
        assert_eq!(unbounded, everything);
        assert!(unbounded.contains(f64::NAN) && unbounded.contains(f64::INFINITY));
    }
    // Overflow is known to be large, and of which sign.
    let large = Enclosure::point(f32::MAX) * 2.0;
    assert_eq!((large.low(), large.high()), (f32::MAX, f32::INFINITY));
    assert!(large.contains(1e39) && !large.contains(f64::NAN) && !large.contains(1e38));
    assert_eq!(Enclosure::point(100.0).exp().high(), f32::INFINITY);
    assert_eq!(large.min(one).high(), 1.0);
    assert_eq!(Enclosure::from(2.0), Enclosure::point(2.0));
}
