//! Core against the tables: every entry of the file is met by some row.

use super::rows::{self, Case, Row};
use super::{draws, moment};
use std::f64::consts::PI;
use woodcock_core::for_each_phase;
use woodcock_core::phase::mie_fit::MieFit;
use woodcock_tests::refs::phase_functions::{Kind, Table, load};
use woodcock_tests::stats::assert_verdict;

/// Legendre polynomials P₁ … P₆.
fn legendre(c: f64) -> [f64; 6] {
    let (mut before, mut last) = (1.0, c);
    std::array::from_fn(|i| {
        let l = i as f64 + 1.0;
        let value = last;
        (before, last) = (last, ((2.0 * l + 1.0) * c * last - l * before) / (l + 1.0));
        value
    })
}

/// A column of the file beside the case that must reproduce it.
struct Columns<'a> {
    p: &'a [f64],
    cdf: &'a [f64],
    inv_cdf: &'a [f64],
    moments: [f64; 3],
}

fn compare<T: Row>(case: &Case<T>, table: &Table, columns: &Columns<'_>) {
    let Case { row, p, ref law } = *case;
    let name = case.name();
    let single = case.single();
    let [of_density, of_share] = T::TABLES;
    let close = |what: &str, at: f64, got: f64, expected: f64, by: f64| {
        assert!(
            (got - expected).abs() <= by,
            "{what} {at} of {name}: {got} for {expected}"
        );
    };
    for (i, &c) in table.cos.iter().enumerate() {
        let expected = columns.p[i];
        close("p", c, row.eval(c, p), expected, of_density * expected);
        close("cdf", c, row.cumulative(c, p), columns.cdf[i], of_share);
    }
    for (i, &xi) in table.xi.iter().enumerate() {
        let exact = columns.inv_cdf[i];
        close(
            "cdf of inverse",
            xi,
            row.cumulative(exact, p),
            xi,
            of_share.max(1e-11),
        );
        if !T::MONOTONE {
            continue;
        }
        // Core counts from the back of the lobe, the table from the cosine −1.
        let xi = if p[0] < 0.0 { 1.0 - xi } else { xi };
        close(
            "cosine at",
            xi,
            row.sample(xi, p),
            exact,
            of_density.max(1e-7),
        );
        let c = f64::from(row.sample(xi as f32, single));
        let [of_cosine, of_u] = T::errors(p);
        // The u itself, and g, are rounded to `f32` here.
        let by = 6e-7 + of_cosine + of_u / (2.0 * PI * law.eval(exact));
        close("cosine in f32 at", xi, c, exact, by);
    }
    let cosines = draws(100, |u| row.sample(u, single));
    for (power, &expected) in (1..).zip(&columns.moments) {
        let whole = law.over(-1.0, 1.0, |c| 2.0 * PI * c.powi(power) * row.eval(c, p));
        close(
            "moment",
            f64::from(power),
            whole,
            expected,
            of_density.max(1e-7),
        );
        let verdict = moment(&cosines, power, expected);
        assert_verdict(&format!("moment {power} of {name}"), verdict);
    }
}

/// Which entries of the file a row reproduces.
fn entries<T: Row>(table: &Table) -> Vec<(usize, Case<T>)> {
    let functions = table.functions.iter().enumerate();
    functions
        .filter_map(|(i, function)| Some((i, T::of(function.kind)?)))
        .collect()
}

pub(super) fn tables<T: Row>() {
    let table = load();
    for (i, case) in entries::<T>(&table) {
        let function = &table.functions[i];
        let columns = Columns {
            p: &function.p,
            cdf: &function.cdf,
            inv_cdf: &function.inv_cdf,
            moments: function.moments,
        };
        compare(&case, &table, &columns);
        for (l, &expected) in function.legendre.iter().enumerate() {
            let polynomial = |c: f64| 2.0 * PI * legendre(c)[l] * case.row.eval(c, case.p);
            let got = case.law.over(-1.0, 1.0, polynomial);
            let by = T::TABLES[0];
            assert!(
                (got - expected).abs() <= by,
                "P{} of {}: {got} for {expected}",
                l + 1,
                case.name()
            );
        }
    }
}

/// No entry is left out, and the rows that should have one do.
#[test]
fn every_function_of_the_file_is_met() {
    let table = load();
    let mut met = vec![0; table.functions.len()];
    macro_rules! count {
        ($name:ident) => {
            for (i, _) in entries::<rows::$name>(&table) {
                met[i] += 1;
            }
        };
    }
    for_each_phase!(count);
    for (function, met) in table.functions.iter().zip(met) {
        let twice = matches!(function.kind, Kind::Hg { .. } | Kind::Rayleigh {});
        assert!(
            met >= if twice { 2 } else { 1 },
            "{:?} is met by {met}",
            function.kind
        );
    }
}

#[test]
fn tables_of_the_file_are_met_by_tables() {
    let table = load();
    for reference in &table.tabulated {
        let case = rows::tabulated::through(&reference.nodes);
        let columns = Columns {
            p: &reference.p,
            cdf: &reference.cdf,
            inv_cdf: &reference.inv_cdf,
            moments: reference.moments,
        };
        compare(&case, &table, &columns);
    }
}

/// Spheres of one size and one wavelength, which the fit smooths over: a loose comparison of mean cosines.
///
/// The fit is for water in air: n = 1.33, no absorption worth naming. Size parameters are read at 0.55 µm.
#[test]
fn mean_cosines_of_droplets_are_near_those_of_spheres() {
    let spheres = load().mie;
    let (water, other): (Vec<_>, Vec<_>) = spheres
        .iter()
        .partition(|s| s.m[0] == 1.33 && s.m[1].abs() < 1e-4);
    assert_eq!((water.len(), other.len()), (3, 1));
    for (sphere, by) in water.iter().zip([0.005, 0.06, 0.015]) {
        let diameter = sphere.x * 0.55 / PI;
        let fit = MieFit::<f64>::new(diameter as f32).expect("a diameter within the fit");
        let difference = fit.mean_cosine() - sphere.g;
        assert!(
            difference.abs() < by,
            "{diameter} µm: {difference} off {}",
            sphere.g
        );
    }
    // Matter that absorbs, of another index, is no water.
    let sphere = other[0];
    let fit = MieFit::<f64>::new((sphere.x * 0.55 / PI) as f32).expect("a diameter within the fit");
    assert!((fit.mean_cosine() - sphere.g).abs() > 0.06);
}
