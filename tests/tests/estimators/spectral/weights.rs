//! Weights: what each outcome of a decision must weigh, by enumeration and without a random number.

use std::array;
use woodcock_core::real::{Real, Word32};
use woodcock_core::spectral::weighted::{self, Weighted};
use woodcock_core::spectral::{Decision, Spectrum, Tentative};
use woodcock_core::stream::Stream;
use woodcock_tests::rows::spectral::{Way, own_probability};
use woodcock_tests::stats::independent::SplitMix;

/// Always the same word: decisions to order.
struct Always(u32);
impl<R: Real<Mask = bool, Word = Word32>> Stream<R> for Always {
    fn next_word(&mut self, _: bool) -> Word32 {
        Word32(self.0)
    }
}
const REAL: u32 = 0;
const NULL: u32 = u32::MAX;

/// P(real) of the next decision: the share of all words that a search finds to collide.
fn probability_of<const N: usize>(
    state: &(impl Decision<f64, N> + Clone),
    event: &Tentative<f64, N>,
) -> f64 {
    let (mut collide, mut pass) = (0_u64, 1_u64 << 32);
    while collide < pass {
        let word = u64::midpoint(collide, pass);
        if state.clone().decide(event, &mut Always(word as u32), true) {
            collide = word + 1;
        } else {
            pass = word;
        }
    }
    collide as f64 / (1_u64 << 32) as f64
}

/// All outcomes of four tentative collisions, by every hero: w_λ times the probability of drawing them is the
/// probability with which wavelength λ alone would have drawn them.
pub(super) fn outcomes_weigh_what_they_must<T: Way, const N: usize>() {
    const EVENTS: usize = 4;
    let mut rng = SplitMix::new(406);
    let heroes = if T::LEADS { N } else { 1 };
    let mut impossible = 0;
    for _ in 0..20 {
        let events: [Tentative<f64, N>; EVENTS] = array::from_fn(|_| Tentative {
            sigma_t: 3.0 * rng.uniform(),
            majorant: 3.0,
            colour: Spectrum(array::from_fn(|_| {
                [1.0, 0.0, 0.01, rng.uniform()][(rng.bits() % 4) as usize]
            })),
        });
        for outcomes in 0..1_u32 << EVENTS {
            let is_real = |i: usize| outcomes >> i & 1 == 1;
            let own: [f64; N] = array::from_fn(|l| {
                let of = |(i, e): (usize, &Tentative<f64, N>)| {
                    own_probability(e.colour.0[l], e.sigma_t / e.majorant, 1, false)
                        * f64::from(u8::from(!is_real(i)))
                        + own_probability(e.colour.0[l], e.sigma_t / e.majorant, 0, true)
                            * f64::from(u8::from(is_real(i)))
                };
                events.iter().enumerate().map(of).product()
            });
            let mut drawn = 0.0;
            let mut weights = Vec::new();
            for hero in 0..heroes {
                let mut state = T::decision::<f64, N>();
                let word = (hero as f64 + 0.5) / heroes as f64 * (1_u64 << 32) as f64;
                state.begin(&mut Always(word as u32), true);
                assert_eq!(state.weight().0, [1.0; N]);
                let mut probability = 1.0 / heroes as f64;
                for (i, event) in events.iter().enumerate() {
                    let p = probability_of(&state, event);
                    probability *= if is_real(i) { p } else { 1.0 - p };
                    let order = if is_real(i) { REAL } else { NULL };
                    let real = state.decide(event, &mut Always(order), true);
                    if real != is_real(i) {
                        assert_eq!(probability, 0.0, "an outcome of no probability");
                        impossible += 1;
                        break;
                    }
                    let weight = state.weight();
                    assert!(weight.0.iter().all(|w| w.is_finite()), "{weight:?}");
                }
                if probability > 0.0 {
                    drawn += probability;
                    weights.push(state.weight().0);
                }
            }
            // Every hero that can draw these outcomes weights them alike.
            for weight in weights {
                for (w, own) in weight.into_iter().zip(own) {
                    let found = w * drawn;
                    assert!(
                        (found - own).abs() < 1e-7,
                        "{outcomes:b} of {events:?}: {found} for {own}"
                    );
                }
            }
        }
    }
    assert!(impossible > 0 || N > 3, "no outcome was excluded");
}

/// Probabilities of zero and one: the other outcome is never drawn, and what is drawn has a finite weight.
#[test]
fn certain_decisions_are_certain() {
    for weight in [[1.0, 1.0], [0.0, 2.0]] {
        for word in [0, 1, 1 << 31, u32::MAX] {
            let clear = Tentative {
                sigma_t: 0.0_f32,
                majorant: 7.0,
                colour: Spectrum([1.0, 0.5]),
            };
            let decide =
                |event, p| weighted::decide(event, p, Spectrum(weight), &mut Always(word), true);
            let (real, after) = decide(&clear, 0.0);
            assert!(!real, "a real collision of probability zero by {word:#x}");
            for (after, before) in after.0.into_iter().zip(weight) {
                assert!((after - before).abs() <= f32::EPSILON * before, "{after}");
            }
            let opaque = Tentative {
                sigma_t: 7.0,
                majorant: 7.0,
                colour: Spectrum([1.0, 1.0]),
            };
            let (real, after) = decide(&opaque, 1.0);
            assert!(real, "a null collision of probability zero by {word:#x}");
            assert_eq!(after.0, weight);
        }
    }
}

/// Delta tracking by the first wavelength, which the weights of the second must make good.
pub(super) fn follow<R: Real, const N: usize>(event: &Tentative<R, N>, _: Spectrum<R, N>) -> R {
    event.sigma_t * event.colour.0[0] / event.majorant
}

/// The geometric series of `weighted`: k null collisions and a real one, k = 0, 1, …
#[test]
fn the_series_of_one_wavelength_has_its_sum() {
    for (sigma, majorant) in [(0.8, 2.0), (0.6, 4.0), (1.9, 2.0), (0.7, 100.0)] {
        let event = Tentative {
            sigma_t: f64::max(sigma, 1.0),
            majorant,
            colour: Spectrum([1.0, sigma].map(|s| s / f64::max(sigma, 1.0))),
        };
        let mut state = Weighted::new(follow::<f64, 2>);
        Decision::begin(&mut state, &mut Always(NULL), true);
        let p = 1.0 / majorant;
        let (mut drawn, mut mean, mut square) = (p, 0.0, 0.0);
        while drawn > 1e-250 {
            let mut collided = state;
            assert!(collided.decide(&event, &mut Always(REAL), true));
            let w = collided.weight().0[1];
            mean += drawn * w;
            square += drawn * w * w;
            drawn *= 1.0 - p;
            assert!(!state.decide(&event, &mut Always(NULL), true));
        }
        let theory =
            sigma * sigma * (majorant - 1.0) / (majorant * (2.0 * sigma - 1.0) - sigma * sigma);
        assert!(
            (mean - 1.0).abs() < 1e-9,
            "{sigma} below {majorant}: mean {mean}"
        );
        assert!(
            (square / theory - 1.0).abs() < 1e-9,
            "{sigma} below {majorant}: {square} for {theory}"
        );
    }
}
