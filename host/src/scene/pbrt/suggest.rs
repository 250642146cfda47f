//! "Did you mean": the nearest of the words that would have been understood.

use super::super::{Place, SceneError};

/// Most names listed.
const SHOWN: usize = 40;
/// Most names searched for one that is near.
const MANY: usize = 2000;

/// The candidate within a third of its length in edits, if any.
pub(super) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    // A megabyte of rubbish is nobody's typo.
    if word.len() > 64 {
        return None;
    }
    candidates
        .into_iter()
        .map(|candidate| (distance(word, candidate), candidate))
        .filter(|&(edits, candidate)| edits <= 1 + candidate.len() / 4)
        .min_by_key(|&(edits, _)| edits)
        .map(|(_, candidate)| candidate)
}

/// Something that a scene mentions and never defines.
pub(super) fn undefined<'a>(
    what: &str,
    name: &str,
    place: &Place,
    known: impl Iterator<Item = &'a str>,
) -> SceneError {
    let error = SceneError::at(place, format!("{what} \"{name}\" is not defined"));
    // A million names, looked through for each of a million mistakes, would take for ever.
    if known.size_hint().0 > MANY {
        return error;
    }
    let mut known: Vec<&str> = known.collect();
    // Hash maps have no order of their own, messages should.
    known.sort_unstable();
    match nearest(name, known.iter().copied()) {
        Some(near) => error.help(format!("did you mean \"{near}\"?")),
        None if known.is_empty() => error.help(format!("the scene defines no {what}")),
        None => {
            let shown = known.len().min(SHOWN);
            let more = if known.len() > shown { ", …" } else { "" };
            error.help(format!("there are {}{more}", known[..shown].join(", ")))
        }
    }
}

/// Insertions, deletions, replacements and swaps of neighbours that turn one word into the other;
/// upper and lower case count as half-way the same and so as equal.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<u8> = a.bytes().map(|c| c.to_ascii_lowercase()).collect();
    let b: Vec<u8> = b.bytes().map(|c| c.to_ascii_lowercase()).collect();
    let mut older = vec![0; b.len() + 1];
    let mut old: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1; b.len() + 1];
        for j in 0..b.len() {
            let replaced = old[j] + usize::from(a[i] != b[j]);
            row[j + 1] = replaced.min(old[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                row[j + 1] = row[j + 1].min(older[j - 1] + 1);
            }
        }
        older = std::mem::replace(&mut old, row);
    }
    old[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_edits() {
        assert_eq!(distance("shape", "Shape"), 0);
        assert_eq!(distance("Sahpe", "Shape"), 1);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("kitten", "sitting"), 3);
    }

    #[test]
    fn suggests_only_what_is_near() {
        let words = ["Shape", "Scale", "Sampler"];
        assert_eq!(nearest("Shaep", words), Some("Shape"));
        assert_eq!(nearest("Trumpet", words), None);
    }
}
