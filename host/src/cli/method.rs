//! How a method of `bench` is written: `path,kernel=scalar,keep=skipping`.

use clap::ValueEnum;

use super::args::Transmittance;
use crate::integrator::Integrator;
use crate::render::Kernel;

/// A method of rendering, as flags of `render`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MethodSpec {
    /// As written.
    pub name: String,
    /// `--integrator`; the scene's if not given.
    pub integrator: Option<Integrator>,
    /// `--kernel`.
    pub kernel: Kernel,
    /// `--transmittance`.
    pub transmittance: Option<Transmittance>,
    /// `--keep`, each.
    pub keep: Vec<String>,
    /// `--split`.
    pub split: Option<u32>,
}

impl MethodSpec {
    /// One whose text is right.
    pub(super) fn plain(text: &str) -> Self {
        method(text).unwrap_or_default()
    }
}

fn value<T: ValueEnum>(word: &str, what: &str) -> Result<T, String> {
    T::from_str(word, false).map_err(|_| {
        let known = T::value_variants()
            .iter()
            .filter_map(|v| v.to_possible_value());
        let known: Vec<_> = known.map(|v| v.get_name().to_owned()).collect();
        format!("no {what} {word:?}; there is {}", known.join(", "))
    })
}

/// An integrator's name, then `kernel=`, `transmittance=`, `keep=` and `split=`, separated by commas; any may be left out.
pub(super) fn method(text: &str) -> Result<MethodSpec, String> {
    let mut spec = MethodSpec {
        name: text.to_owned(),
        ..MethodSpec::default()
    };
    for word in text.split(',') {
        match word.split_once('=') {
            None => spec.integrator = Some(value(word, "integrator")?),
            Some(("kernel", word)) => spec.kernel = value(word, "kernel")?,
            Some(("transmittance", word)) => {
                spec.transmittance = Some(value(word, "transmittance")?);
            }
            Some(("keep", word)) => spec.keep.push(word.to_owned()),
            Some(("split", word)) => {
                let split = word.parse().ok().filter(|n| (1..=4096).contains(n));
                spec.split = Some(split.ok_or("split is a number from 1 to 4096")?);
            }
            Some((key, _)) => {
                return Err(format!(
                    "no {key:?}; there is kernel, transmittance, keep, split"
                ));
            }
        }
    }
    Ok(spec)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_read() {
        let spec =
            method("bdpt,kernel=scalar,transmittance=delta,keep=emission,keep=surfaces,split=4");
        let spec = spec.expect("a method");
        assert_eq!(spec.integrator, Some(Integrator::Bdpt));
        assert_eq!(spec.kernel, Kernel::Scalar);
        assert_eq!(spec.transmittance, Some(Transmittance::Delta));
        assert_eq!(spec.keep, ["emission", "surfaces"]);
        assert_eq!(spec.split, Some(4));
        assert_eq!(method("kernel=scalar").map(|s| s.integrator), Ok(None));
        for (bad, words) in [
            ("light", "there is path, bdpt"),
            ("path,lanes=8", "there is kernel"),
            ("path,kernel=vector", "there is packet, scalar"),
            ("split=0", "from 1 to 4096"),
            ("", "no integrator"),
        ] {
            let error = method(bad).expect_err(bad);
            assert!(error.contains(words), "{error}");
        }
    }
}
