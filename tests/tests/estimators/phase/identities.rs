//! Special cases: rows that must agree with one another, and figures that are known.

use super::{cosines, uniforms};
use std::f64::consts::PI;
use woodcock_core::phase::mie_fit::MieFit;
use woodcock_core::phase::tabulated::{Tabulated, fill_cumulative};
use woodcock_core::phase::{self, draine, henyey_greenstein, rayleigh, two_lobe::TwoLobe};
use woodcock_core::real::{Mask, Real};
use woodcock_packet::lanes::{LANES, Lanes};

const G: [f32; 9] = [0.0, 1e-7, 0.01, 0.5, -0.5, 0.9, -0.99, 0.9999, 1.0 - 1e-7];

#[test]
fn draine_without_squares_is_henyey_greenstein() {
    for g in G {
        for u in uniforms() {
            let one = draine::sample(u, g, 0.0);
            let other = henyey_greenstein::sample(u, g);
            if u < 0.5 {
                assert_eq!(one.to_bits(), other.to_bits(), "at {u:e}, g {g}");
            } else {
                assert!(
                    (one - other).abs() <= 4e-7,
                    "{one} for {other} at {u:e}, g {g}"
                );
            }
        }
        for c in cosines(1000) {
            let (one, other) = (draine::eval(c, g, 0.0), henyey_greenstein::eval(c, g));
            assert_eq!(one.to_bits(), other.to_bits());
            let (one, other) = (draine::invert(c, g, 0.0), henyey_greenstein::invert(c, g));
            assert!(
                (one - other).abs() <= 1e-6,
                "{one} for {other} at {c}, g {g}"
            );
        }
    }
}

#[test]
fn draine_without_a_lobe_is_rayleigh() {
    for u in uniforms() {
        let (one, other) = (draine::sample(u, 0.0, 1.0), rayleigh::sample(u));
        assert!((one - other).abs() <= 4e-7, "{one} for {other} at {u:e}");
    }
    for c in cosines(1000) {
        let (one, other) = (draine::eval(c, 0.0, 1.0), rayleigh::eval(c));
        assert!((one / other - 1.0).abs() <= 3e-7);
    }
}

#[test]
fn draine_of_alpha_one_is_cornette_shanks() {
    for g in [-0.7_f64, 0.0, 0.3, 0.9] {
        for c in cosines(100).map(f64::from) {
            let exact = 3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + c * c)
                / ((2.0 + g * g) * (1.0 + g * g - 2.0 * g * c).powf(1.5));
            let one = draine::eval(c, g, 1.0);
            assert!((one / exact - 1.0).abs() < 1e-7, "{one} for {exact}");
        }
    }
}

/// Nothing is left of a lobe that has no share, not even a rounding.
#[test]
fn a_lobe_alone_is_itself() {
    for (share, g) in [(1.0, 0.8_f32), (0.0, -0.3)] {
        let lobes = TwoLobe {
            share,
            g1: 0.8,
            g2: -0.3,
        };
        for u in uniforms() {
            let (one, other) = (lobes.sample(u), henyey_greenstein::sample(u, g));
            assert_eq!(one.to_bits(), other.to_bits());
        }
        for c in cosines(1000) {
            let (one, other) = (lobes.eval(c), henyey_greenstein::eval(c, g));
            assert_eq!(one.to_bits(), other.to_bits());
        }
    }
}

#[test]
fn a_flat_table_is_isotropic() {
    let cosines = [-1.0, -0.25, 1.0];
    let mut cumulative = [0.0; 3];
    fill_cumulative(&cosines, &[7.0; 3], &mut cumulative).expect("a good table");
    let flat = Tabulated::new(&cosines, &[7.0; 3], &cumulative).expect("a good table");
    for u in uniforms() {
        let (one, other) = (flat.sample(u), phase::isotropic::sample(u));
        assert!((one - other).abs() <= 2e-7, "{one} for {other} at {u:e}");
        assert!((flat.eval(one) / phase::isotropic::eval(one) - 1.0).abs() <= 3e-7);
    }
}

/// Parameters of the fit as another program computes them, four digits of them.
#[test]
fn the_fit_has_its_known_parameters() {
    let known = [
        (0.05, [0.0345, 0.0257, 250.0, 0.2522]),
        (0.15, [0.3473, -0.0223, 250.0, 0.1115]),
        (1.0, [0.8620, 0.5069, 250.0, 0.2408]),
        (2.0, [0.9181, 0.3875, 11.3792, 0.4121]),
        (3.0, [0.9459, 0.4220, 14.3405, 0.3809]),
        (6.0, [0.9774, 0.5212, 18.2751, 0.4595]),
        (20.0, [0.9946, 0.5938, 27.1137, 0.4982]),
    ];
    for (diameter, expected) in known {
        let fit = MieFit::<f64>::new(diameter).expect("a diameter within the fit");
        let found = [fit.g_hg, fit.g_draine, fit.alpha, fit.share];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!(
                (found - expected).abs() < 6e-5,
                "{found} for {expected} at {diameter} µm"
            );
        }
    }
}

/// Where one range of the fit ends and the next begins, the mean cosine hardly moves.
#[test]
fn ranges_of_the_fit_meet() {
    for diameter in [0.1_f32, 1.5, 5.0] {
        let mean = |d| {
            MieFit::<f64>::new(d)
                .expect("a diameter within the fit")
                .mean_cosine()
        };
        let jump = mean(diameter.next_up()) - mean(diameter.next_down());
        assert!(jump.abs() < 0.015, "{jump} at {diameter} µm");
    }
}

#[test]
fn the_smallest_droplets_scatter_like_molecules() {
    let fit = MieFit::<f64>::new(1e-4).expect("a diameter within the fit");
    for c in cosines(100).map(f64::from) {
        let ratio = fit.eval(c) / rayleigh::eval(c);
        assert!((ratio - 1.0).abs() < 2e-3, "{ratio} at {c}");
    }
}

/// The mixture of rows by mask: each lane follows its own law.
#[test]
fn lanes_of_both_laws_share_a_packet() {
    use woodcock_core::phase::Phase;
    use woodcock_packet::lanes::LaneMask;
    let g = [0.0, 0.3, -0.3, 0.9, 0.5, -0.8, 0.1, 0.99];
    for bits in [0, 0xff, 0b1010_0110] {
        let wide = Phase::<Lanes> {
            g: Lanes::new(g),
            rayleigh: LaneMask::from_bits(bits),
        };
        for i in 0..100 {
            let u = i as f32 / 100.0;
            let cosines = wide.sample::<true>(Lanes::splat(u)).to_array();
            let densities = wide.eval::<true>(Lanes::splat(u)).to_array();
            for lane in 0..LANES {
                let one = Phase::<f32> {
                    g: g[lane],
                    rayleigh: bits >> lane & 1 == 1,
                };
                assert_eq!(cosines[lane].to_bits(), one.sample::<true>(u).to_bits());
                assert_eq!(densities[lane].to_bits(), one.eval::<true>(u).to_bits());
                if !one.rayleigh {
                    assert_eq!(
                        one.sample::<false>(u).to_bits(),
                        one.sample::<true>(u).to_bits()
                    );
                }
            }
        }
    }
}
