//! Numbers of twice the precision: 106 bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::DVec3;

/// A sum of two doubles, the second below the last digit of the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dd(pub(super) f64, f64);

impl Dd {
    fn two_sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let t = s - a;
        Self(s, (a - (s - t)) + (b - t))
    }

    pub(super) fn sqrt(self) -> Self {
        let root = Self::from(self.0.sqrt());
        // One step of Newton's doubles the digits.
        root + (self - root * root) / Self::from(2.0 * root.0)
    }

    pub(super) fn value(self) -> f64 {
        self.0 + self.1
    }
}

impl From<f64> for Dd {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

impl Add for Dd {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let s = Self::two_sum(self.0, b.0);
        let t = Self::two_sum(self.1, b.1);
        let s = Self::two_sum(s.0, s.1 + t.0);
        Self::two_sum(s.0, s.1 + t.1)
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let p = self.0 * b.0;
        let e = self.0.mul_add(b.0, -p);
        Self::two_sum(p, e + (self.0 * b.1 + self.1 * b.0))
    }
}

impl Div for Dd {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let q = Self::from(self.0 / b.0);
        let rest = self - q * b;
        q + Self::from(rest.value() / b.0)
    }
}

/// A vector of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dd3(pub(super) [Dd; 3]);

impl From<DVec3> for Dd3 {
    fn from(v: DVec3) -> Self {
        Self(v.to_array().map(Dd::from))
    }
}

impl Dd3 {
    pub(super) fn minus(self, b: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - b.0[i]))
    }

    pub(super) fn dot(self, b: Self) -> Dd {
        self.0[0] * b.0[0] + self.0[1] * b.0[1] + self.0[2] * b.0[2]
    }

    pub(super) fn cross(self, b: Self) -> Self {
        Self(std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.0[j] * b.0[k] - self.0[k] * b.0[j]
        }))
    }

    pub(super) fn length(self) -> Dd {
        self.dot(self).sqrt()
    }
}

#[test]
fn twice_the_digits_are_kept() {
    let third = Dd::from(1.0) / Dd::from(3.0);
    let rest = Dd::from(1.0) - third * Dd::from(3.0);
    assert!(rest.value().abs() < 1e-31);
    let root = Dd::from(2.0).sqrt();
    assert!((root * root - Dd::from(2.0)).value().abs() < 1e-31);
    assert!((third.0 * 3.0 - 1.0).abs() < 1e-15 && third.1 != 0.0);
}
