//! How deep and where a statistical run looks: constants, unless the environment says otherwise.
//!
//! Seeds are constants, so that a commit's result is fixed for ever. `WOODCOCK_SAMPLES=16` multiplies every
//! sample count and `WOODCOCK_SEED=7` moves every seed: a bias then grows fourfold in z, and luck fades.
//! Continuous integration sets neither.

use std::env::VarError;

/// The sample count `n`, multiplied by `WOODCOCK_SAMPLES` where that is set.
///
/// # Panics
/// When the variable is not a positive whole number or the product overflows: a run that silently ignored the
/// wish would be taken for the deeper one.
pub fn samples(n: usize) -> usize {
    scaled(n, variable("WOODCOCK_SAMPLES").as_deref())
}

/// The seed `base`, or another that depends on it and on `WOODCOCK_SEED` where that is set.
///
/// # Panics
/// When the variable is not a whole number of 64 bits.
pub fn seed(base: u64) -> u64 {
    moved(base, variable("WOODCOCK_SEED").as_deref())
}

fn variable(name: &str) -> Option<String> {
    match std::env::var(name) {
        Ok(text) => Some(text),
        Err(VarError::NotPresent) => None,
        Err(VarError::NotUnicode(bytes)) => panic!("{name} is not text: {}", bytes.display()),
    }
}

fn scaled(n: usize, factor: Option<&str>) -> usize {
    let Some(text) = factor else { return n };
    match text.parse::<usize>() {
        Ok(factor) if factor > 0 => n
            .checked_mul(factor)
            .unwrap_or_else(|| panic!("WOODCOCK_SAMPLES={text}: {n} samples times that overflow")),
        _ => panic!("WOODCOCK_SAMPLES={text}: expected a positive whole number"),
    }
}

fn moved(base: u64, by: Option<&str>) -> u64 {
    let Some(text) = by else { return base };
    match text.parse::<u64>() {
        // An odd constant keeps different bases and different moves apart; neighbours do not overlap.
        Ok(by) => base ^ by.wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(31),
        Err(_) => panic!("WOODCOCK_SEED={text}: expected a whole number below 2^64"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unset_changes_nothing() {
        assert_eq!(scaled(1 << 20, None), 1 << 20);
        assert_eq!(moved(42, None), 42);
    }

    #[test]
    fn set_values_deepen_and_move() {
        assert_eq!(scaled(1000, Some("16")), 16_000);
        assert_ne!(moved(42, Some("1")), 42);
        assert_ne!(moved(42, Some("1")), moved(42, Some("2")));
        assert_ne!(moved(42, Some("1")), moved(43, Some("1")));
    }

    #[test]
    #[should_panic(expected = "expected a positive whole number")]
    fn zero_samples_are_refused() {
        scaled(1000, Some("0"));
    }

    #[test]
    #[should_panic(expected = "expected a whole number")]
    fn a_word_is_no_seed() {
        moved(1, Some("lucky"));
    }
}
