//! Draine scattering: a Henyey–Greenstein lobe times 1 + αμ², which lifts both of its ends.
//!
//! ```text
//! p(μ) = 1/(4π) · (1 − g²)/(1 + g² − 2gμ)^(3/2) · (1 + αμ²)/N,   N = 1 + α (1 + 2g²)/3
//! ⟨μ⟩ = g (1 + α (3 + 2g²)/5) / N
//! ```
//!
//! α = 0 is Henyey–Greenstein, g = 0 with α = 1 is Rayleigh, α = 1 is Cornette–Shanks; g = 0 with
//! α = (1 − y)/(1 + 3y), y = ρ/(2 − ρ), is Rayleigh scattering of depolarisation factor ρ.
//!
//! **One tail.** Let x be the share of the Henyey–Greenstein lobe between an end of the sphere and
//! the cosine. From the front (from the back the same holds with −g and −μ), with e = 2x(1 − g)/D,
//! s = (1 − g)(1 + g)/D and D = (1 + g) − 2gx,
//!
//! ```text
//! μ = 1 − e ((1 − g) + s)/2,   x = (1 + g) e/(2s),   s² = 1 + g² − 2gμ
//! ∫₀ˣ μ² dx' = x c,            c = (1 − (1 − g)e/2)² + (1 − g) e² s/12
//! ```
//!
//! The second line is found by putting x c into the differential equation, where the polynomial in e
//! that solves it ends at the third power; written as two squares it cannot cancel. So the tail of
//! Draine's law holds x (1 + αc)/N: no division by g, and digits kept down to the smallest tail.
//!
//! **Its inverse** is the root of F(x) = x (1 + αc) − uN, counted from the end that is nearer in u.
//! F' = 1 + αμ² falls up to μ = 0 and rises behind it, so F is concave, then convex: Newton steps that
//! start beyond the root, as seen from μ = 0, approach it from there without ever passing it. The start
//! is the best of three such bounds: F' ≥ 1; F' ≤ 1 + α; and, on the side where the lobe's density per
//! cosine grows away from μ = 0, its value there, on the other side the slope dμ/dx there. Five steps
//! leave less than 3e-11 of u for every g and every α up to 1e8. The quartic of the paper is closed, but
//! loses its digits near g = 0 and near μ = 0 in `f32`.
//! Source: [Draine 2003]; [Jendersie, d'Eon 2023] for the closed inverse.

use crate::phase::henyey_greenstein;
use crate::real::Real;

/// Newton steps of [`sample`].
const STEPS: usize = 5;

/// ∫ (1 + αμ²) over a Henyey–Greenstein lobe: the N above.
#[inline(always)]
fn norm<R: Real>(g: R, alpha: R) -> R {
    R::one() + alpha * ((R::one() + R::splat(2.0) * g * g) / R::splat(3.0))
}

/// Density over the sphere [1/sr].
///
/// * `cos_theta`: in [−1, 1], per lane. `g`: in (−1, 1), per lane; not the mean cosine.
/// * `alpha`: not negative, at most 1e8, per lane.
#[inline(always)]
pub fn eval<R: Real>(cos_theta: R, g: R, alpha: R) -> R {
    let squares = R::one() + alpha * (cos_theta * cos_theta);
    henyey_greenstein::eval(cos_theta, g) * squares / norm(g, alpha)
}

/// The mean cosine.
#[inline(always)]
pub fn mean_cosine<R: Real>(g: R, alpha: R) -> R {
    let squares = (R::splat(3.0) + R::splat(2.0) * g * g) / R::splat(5.0);
    g * (R::one() + alpha * squares) / norm(g, alpha)
}

/// The lobe as seen from one end of the sphere, where the cosine is +1.
struct End<R> {
    /// Mean cosine of Henyey–Greenstein's lobe: g from the front, −g from the back.
    g: R,
    /// 1 − g and 1 + g.
    less: R,
    more: R,
    alpha: R,
    /// α/12.
    twelfth: R,
}

impl<R: Real> End<R> {
    #[inline(always)]
    fn new(g: R, alpha: R) -> Self {
        Self {
            g,
            less: R::one() - g,
            more: R::one() + g,
            alpha,
            twelfth: alpha / R::splat(12.0),
        }
    }

    /// N times the share of Draine's law in the tail that holds x and ends at e and s: x (1 + αc).
    #[inline(always)]
    fn tail(&self, x: R, e: R, s: R) -> R {
        let middle = R::one() - R::splat(0.5) * self.less * e;
        let squares = self.alpha * (middle * middle) + self.twelfth * (self.less * (e * e) * s);
        x * (R::one() + squares)
    }

    /// The x at a tail of `wanted`.
    #[inline(always)]
    fn solve(&self, wanted: R) -> R {
        let (one, two, half) = (R::one(), R::splat(2.0), R::splat(0.5));
        let mut x = self.start(wanted);
        for _ in 0..STEPS {
            let ratio = self.less / (self.more - two * self.g * x);
            let (e, s) = (two * x * ratio, self.more * ratio);
            let cosine = one - half * e * (self.less + s);
            let missing = wanted - self.tail(x, e, s);
            x = x + missing / (one + self.alpha * (cosine * cosine));
            x = x.max(R::zero()).min(one);
        }
        x
    }

    /// Where Newton starts: beyond the root, as seen from μ = 0.
    #[inline(always)]
    fn start(&self, wanted: R) -> R {
        let (one, two, three) = (R::one(), R::splat(2.0), R::splat(3.0));
        // The tail up to μ = 0, the slope |dμ/dx| there, and how far from it the root is in F.
        let s = (one + self.g * self.g).sqrt();
        let e = one + self.g / (one + s);
        let x = self.more * e / (two * s);
        let slope = two * s * s * s / (self.less * self.more);
        let excess = self.tail(x, e, s) - wanted;
        let front = R::zero().lt(excess);
        let distance = excess.abs();
        // A density, or a slope, that stayed as it is there would put the root at |μ| + α|μ|³/3 =
        // `linear`; either term alone bounds it. An α below 1e-12 changes neither bound that counts.
        let linear = distance * slope;
        let cube = three * linear / self.alpha.max(R::splat(1e-12));
        let cosine = linear.min((cube.ln() * R::splat(1.0 / 3.0)).exp());
        let along_slope = cosine / slope;
        let within = cosine.min(one);
        let [_, _, along_density] = place(R::select(front, within, -within), self.g);
        let denser = front ^ self.g.lt(R::zero());
        let below = R::select(denser, along_density, x - along_slope);
        let above = R::select(denser, along_density, x + along_slope);
        let below = below.max(x - distance).max(wanted / (one + self.alpha));
        let above = above.min(x + distance).min(one);
        R::select(front, below, above)
    }
}

/// e, s and x of a cosine seen from the end with this g.
#[inline(always)]
fn place<R: Real>(cosine: R, g: R) -> [R; 3] {
    let (one, two) = (R::one(), R::splat(2.0));
    let magnitude = g.abs();
    let towards_peak = R::select(g.lt(R::zero()), -cosine, cosine);
    let rest = one - magnitude;
    let s = (rest * rest + two * magnitude * (one - towards_peak)).sqrt();
    let e = two * (one - cosine) / ((one - g) + s);
    [e, s, (one + g) * e / (two * s)]
}

/// The cosine at u in [0, 1], per lane; parameters as in [`eval`].
///
/// A lobe of g < 0 is that of |g| turned around, as Henyey–Greenstein's: its cosines fall along u.
/// In `f32` the cosine is off by at most 3e-7 + 2e-7/(2πp): it is that of a u off by 2e-7, and some
/// roundings more. For α ≤ 1 it is 3e-7 or less; a large α leaves next to no density around μ = 0, and
/// cosines there that can be off by 2e-4 (α = 1e4). With α = 0 and u < 1/2 it has the bits of
/// [`henyey_greenstein::sample`]. Cost: about twenty divisions, whatever the numbers.
#[inline(always)]
pub fn sample<R: Real>(u: R, g: R, alpha: R) -> R {
    let (one, two, half) = (R::one(), R::splat(2.0), R::splat(0.5));
    let magnitude = g.abs();
    let back = u.lt(half);
    let g_end = R::select(back, -magnitude, magnitude);
    let end = End::new(g_end, alpha);
    let x = end.solve(R::select(back, u, one - u) * norm(magnitude, alpha));
    // Henyey–Greenstein's own map from x to the cosine, away from the end.
    let a = (two * x - end.more) / (end.more - two * g_end * x);
    let away = a - half * g_end * ((one - a) * (one + a));
    let away = away.max(-one).min(one);
    R::select(back ^ g.lt(R::zero()), away, -away)
}

/// The u of a cosine in [−1, 1], counted from the back of the lobe; error at most 8e-7 in `f32`.
///
/// * `g`, `alpha`: as in [`eval`], per lane.
#[inline(always)]
pub fn invert<R: Real>(cos_theta: R, g: R, alpha: R) -> R {
    let magnitude = g.abs();
    let forward = R::select(g.lt(R::zero()), -cos_theta, cos_theta);
    let end = End::new(-magnitude, alpha);
    let [e, s, x] = place(-forward, end.g);
    end.tail(x, e, s) / norm(magnitude, alpha)
}
