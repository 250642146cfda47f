//! How the values of flags are written. Each function parses one, or says what it expected.

use std::str::FromStr;
use std::time::Duration;

/// A camera path, `--replay x,y,sample`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Replay {
    /// Column of the pixel in the whole picture.
    pub x: u32,
    /// Row of the pixel in the whole picture.
    pub y: u32,
    /// Index of the sample.
    pub sample: u32,
}

/// `WxH`, both positive.
pub(super) fn resolution(text: &str) -> Result<[u32; 2], String> {
    let expected = || "expected WIDTHxHEIGHT in pixels, as in 1280x720".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    match (width.parse(), height.parse()) {
        (Ok(0), _) | (_, Ok(0)) => Err("a picture needs at least one pixel".to_owned()),
        (Ok(width), Ok(height)) => Ok([width, height]),
        _ => Err(expected()),
    }
}

/// `x0,x1,y0,y1` in fractions of the picture: pbrt's order.
pub(super) fn crop(text: &str) -> Result<[f64; 4], String> {
    let [x0, x1, y0, y1] = numbers::<f64, 4>(text)
        .ok_or("expected x0,x1,y0,y1: fractions of the picture, as in 0.25,0.75,0,1")?;
    let inside = [x0, x1, y0, y1].iter().all(|v| (0.0..=1.0).contains(v));
    if inside && x0 < x1 && y0 < y1 {
        Ok([x0, x1, y0, y1])
    } else {
        Err("expected x0,x1,y0,y1 with 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1".to_owned())
    }
}

/// `x,y,sample`.
pub(super) fn replay(text: &str) -> Result<Replay, String> {
    let [x, y, sample] =
        numbers(text).ok_or("expected x,y,sample: pixel column, pixel row, sample index")?;
    Ok(Replay { x, y, sample })
}

/// A world point `x,y,z`.
pub(super) fn point(text: &str) -> Result<[f64; 3], String> {
    finite(text).ok_or_else(|| "expected a point x,y,z".to_owned())
}

/// A world segment `x0,y0,z0,x1,y1,z1`.
pub(super) fn segment(text: &str) -> Result<[f64; 6], String> {
    finite(text).ok_or_else(|| "expected a segment x0,y0,z0,x1,y1,z1".to_owned())
}

/// Seconds, positive.
pub(super) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|&s: &f64| s > 0.0);
    seconds
        .and_then(|s| Duration::try_from_secs_f64(s).ok())
        .ok_or_else(|| "expected a positive number of seconds".to_owned())
}

/// A positive part of one, as `0.01` or `1%`.
pub(super) fn relative(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 100.0),
        None => (text, 1.0),
    };
    let number = number.trim().parse().ok().map(|n: f64| n / unit);
    let number = number.filter(|n| *n >= 1e-6 && *n <= 1.0);
    number.ok_or_else(|| "expected a relative error, as in 0.01 or 1%".to_owned())
}

/// A positive number.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|n: &f64| *n > 0.0 && n.is_finite());
    number.ok_or_else(|| "expected a positive number".to_owned())
}

/// Bytes, with an optional suffix K, M, G or T for powers of 1024 (`512M`; `512MiB` and `512MB` mean the same).
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    let expected = || "expected a number of bytes, as in 800000000, 512M or 1.5G".to_owned();
    let lower = text.to_ascii_lowercase();
    let short = lower.strip_suffix("ib").or_else(|| lower.strip_suffix('b'));
    let short = short.unwrap_or(&lower);
    let (number, shift) = match short.as_bytes().last() {
        Some(b'k') => (&short[..short.len() - 1], 10),
        Some(b'm') => (&short[..short.len() - 1], 20),
        Some(b'g') => (&short[..short.len() - 1], 30),
        Some(b't') => (&short[..short.len() - 1], 40),
        _ => (short, 0),
    };
    if let Ok(whole) = number.parse::<u64>() {
        return whole
            .checked_mul(1 << shift)
            .filter(|&b| b > 0)
            .ok_or_else(expected);
    }
    let number: f64 = number.parse().map_err(|_| expected())?;
    let bytes = number * f64::from(shift).exp2();
    // `as` would saturate in silence.
    if bytes >= 1.0 && bytes < 64.0_f64.exp2() {
        Ok(bytes as u64)
    } else {
        Err(expected())
    }
}

/// Exactly `N` numbers separated by commas.
fn numbers<T: FromStr + Copy, const N: usize>(text: &str) -> Option<[T; N]> {
    let values: Option<Vec<T>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    values?.try_into().ok()
}

fn finite<const N: usize>(text: &str) -> Option<[f64; N]> {
    numbers(text).filter(|values: &[f64; N]| values.iter().all(|v| v.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(resolution("1280x720"), Ok([1280, 720]));
        assert_eq!(crop("0,0.5,0.25,1"), Ok([0.0, 0.5, 0.25, 1.0]));
        assert_eq!(
            replay("3,4,17"),
            Ok(Replay {
                x: 3,
                y: 4,
                sample: 17
            })
        );
        assert_eq!(point("-1,2.5,1e3"), Ok([-1.0, 2.5, 1000.0]));
        assert_eq!(segment("0,0,0,1,1,-1"), Ok([0.0, 0.0, 0.0, 1.0, 1.0, -1.0]));
        assert_eq!(seconds("1.5"), Ok(Duration::from_millis(1500)));
        assert_eq!((relative("0.02"), relative("2%")), (Ok(0.02), Ok(0.02)));
        for (text, expected) in [
            ("1", 1),
            ("3k", 3 << 10),
            ("512M", 512 << 20),
            ("512MiB", 512 << 20),
            ("1.5G", 3 << 29),
            ("2TB", 2 << 40),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for bad in ["", "12", "0x7", "7x0", "-3x3", "3x3x3", "99999999999x1"] {
            assert!(resolution(bad).is_err(), "{bad}");
        }
        for bad in [
            "0,1,0",
            "0,1,0,1,1",
            "1,0,0,1",
            "0,1,0.5,0.5",
            "-0.1,1,0,1",
            "0,1.1,0,1",
            "0,nan,0,1",
        ] {
            assert!(crop(bad).is_err(), "{bad}");
        }
        for bad in ["1,2", "1,2,-3", "1,2,3.5", "a,b,c"] {
            assert!(replay(bad).is_err(), "{bad}");
        }
        assert!(point("1,2,inf").is_err() && segment("1,2,3").is_err());
        for bad in ["0", "-1", "nan", "inf", "1e300", "ten"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1%", "nan", "2", "150%", "%", "1e-9"] {
            assert!(relative(bad).is_err(), "{bad}");
        }
        for bad in [
            "",
            "G",
            "-1",
            "0",
            "0.1",
            "nanG",
            "1e30",
            "99999999999T",
            "12X",
            "é",
        ] {
            assert!(bytes(bad).is_err(), "{bad}");
        }
    }
}
