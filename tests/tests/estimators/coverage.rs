//! No file without a row: what is in a folder of core is in its registry, and so under test.

use std::collections::BTreeSet;
use std::path::Path;
use woodcock_tests::{fixtures, mutants};

/// The files of a folder of core that hold one thing each, without their ending.
fn files(folder: &str, not_things: &[&str]) -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../core/src")
        .join(folder);
    let entries = std::fs::read_dir(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let names = entries.map(|entry| {
        let name = entry.expect("a readable folder").file_name();
        let name = name.to_str().expect("a name in UTF-8");
        name.strip_suffix(".rs").unwrap_or(name).to_owned()
    });
    names
        .filter(|name| name != "mod" && !not_things.contains(&name.as_str()))
        .collect()
}

/// Names in a registry.
macro_rules! rows {
    ($registry:ident) => {{
        let mut names = BTreeSet::new();
        macro_rules! row {
            ($name:ident) => {
                assert!(
                    names.insert(stringify!($name).to_owned()),
                    "two rows of one name"
                );
            };
        }
        woodcock_core::$registry!(row);
        names
    }};
}

#[test]
fn every_file_has_a_row() {
    // What a folder holds besides one thing a file, with the reason.
    let nothing_else: &[&str] = &[];
    // Biased, and says so: a baseline.
    let baseline: &[&str] = &["ray_marching"];
    // What counts another medium's look-ups, and what adds a source instead of extinction.
    let not_extinction: &[&str] = &["audited", "emissive"];
    // What the ways to decide are made of (numbers by wavelength, the event, media) and what is made of them (flights,
    // and the transmittance that needs no decision).
    let besides_decisions: &[&str] =
        &["spectrum", "tentative", "medium", "flight", "transmittance"];
    for (folder, not_things, rows) in [
        ("free_flight", nothing_else, rows!(for_each_free_flight)),
        ("transmittance", baseline, rows!(for_each_transmittance)),
        ("phase", nothing_else, rows!(for_each_phase)),
        ("medium", not_extinction, rows!(for_each_medium)),
        ("spectral", besides_decisions, rows!(for_each_spectral)),
    ] {
        assert_eq!(
            files(folder, not_things),
            rows,
            "core/src/{folder} and its registry differ"
        );
        assert!(rows.len() >= 2, "{folder}: an empty registry tests nothing");
    }
}

/// A file that is no row is noticed: the check can fail.
#[test]
fn a_file_without_a_row_is_missed() {
    let rows = rows!(for_each_phase);
    assert_ne!(files("transmittance", &[]), rows);
    let fewer: BTreeSet<String> = rows.iter().skip(1).cloned().collect();
    assert_ne!(files("phase", &[]), fewer);
}

/// What the project says of its own suites: at least 300 registry checks, and 40 planted mistakes.
///
/// A check is a row judged on a fixture at a width; only those of the twelve fields with their four rays are counted.
#[test]
fn there_are_enough_checks_and_mistakes() {
    let judged = fixtures::all().len() * 3;
    // All rows but the two that serve special media, and the variants that share a file with a row.
    let flights = rows!(for_each_free_flight).len() - 2;
    let weights = rows!(for_each_transmittance).len() - 2 + 2;
    let checks = judged * (flights + weights);
    assert!(checks >= 300, "{checks} checks");
    let mistakes = mutants::all().len() + crate::spectral::mutants::MUTANTS.len();
    assert!(mistakes >= 40, "{mistakes} planted mistakes");
}
