//! The parameters of one directive, asked for by name.
//!
//! Every question is remembered, so that [`Params::finish`] can complain about what nobody asked for
//! and suggest a name that was.

use std::cell::{Cell, RefCell};
use std::sync::Arc;

use glam::DVec3;

use super::super::{Place, SceneError};
use super::diagnostics::Diagnostics;
use super::param::{Param, Text, Type, Values};
use super::suggest::nearest;

/// Parameters given to a directive, with those of `Attribute` behind them.
#[derive(Debug)]
pub(super) struct Params {
    /// What they belong to, for messages: `medium "homogeneous"`.
    owner: String,
    /// The directive.
    place: Place,
    given: Vec<(Param, Cell<bool>)>,
    inherited: Arc<Vec<Arc<Param>>>,
    asked: RefCell<Vec<&'static str>>,
    /// Memory of the lists that were taken from what is inherited \[bytes\].
    copied: Cell<u64>,
}

impl Params {
    pub(super) fn new(
        owner: impl Into<String>,
        place: Place,
        given: Vec<Param>,
        inherited: Arc<Vec<Arc<Param>>>,
    ) -> Self {
        Self {
            owner: owner.into(),
            place,
            given: given.into_iter().map(|p| (p, Cell::new(false))).collect(),
            inherited,
            asked: RefCell::new(Vec::new()),
            copied: Cell::new(0),
        }
    }

    /// Of the directive as a whole.
    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// Says more exactly what the parameters belong to, once that is known.
    pub(super) fn rename(&mut self, owner: String) {
        self.owner = owner;
    }

    /// The last parameter of this name; given ones win over inherited ones.
    ///
    /// # Errors
    /// One that is given with another type.
    pub(super) fn find(
        &self,
        name: &'static str,
        types: &[Type],
    ) -> Result<Option<&Param>, SceneError> {
        if !self.asked.borrow().contains(&name) {
            self.asked.borrow_mut().push(name);
        }
        let mut found = None;
        for (param, used) in self.given.iter().filter(|(p, _)| p.name == name) {
            used.set(true);
            found = Some(param);
        }
        if let Some(param) = found {
            if types.contains(&param.ty) {
                return Ok(Some(param));
            }
            let expected: Vec<&str> = types.iter().map(|ty| ty.name()).collect();
            let message = format!(
                "\"{name}\" of {} has type {}, expected {}",
                self.owner,
                param.ty.name(),
                expected.join(" or ")
            );
            return Err(SceneError::at(&param.declared, message));
        }
        let fits = |p: &&Arc<Param>| p.name == name && types.contains(&p.ty);
        Ok(self.inherited.iter().rev().find(fits).map(|p| &**p))
    }

    fn numbers<const N: usize>(
        &self,
        name: &'static str,
        ty: Type,
    ) -> Result<Option<([f64; N], &Param)>, SceneError> {
        let Some(param) = self.find(name, &[ty])? else {
            return Ok(None);
        };
        let Values::Numbers(numbers) = &param.values else {
            return Ok(None);
        };
        match <[f64; N]>::try_from(numbers.as_slice()) {
            Ok(values) => Ok(Some((values, param))),
            Err(_) => Err(self.count(param, N, numbers.len())),
        }
    }

    fn count(&self, param: &Param, expected: usize, found: usize) -> SceneError {
        let plural = if expected == 1 { "" } else { "s" };
        let message = format!(
            "\"{}\" of {} takes {expected} value{plural}, found {found}",
            param.name, self.owner
        );
        SceneError::at(&param.valued, message)
    }

    /// A single number that satisfies `valid`, in words `range`.
    pub(super) fn float(
        &self,
        name: &'static str,
        range: &str,
        valid: impl Fn(f64) -> bool,
    ) -> Result<Option<f64>, SceneError> {
        match self.numbers::<1>(name, Type::Float)? {
            Some(([value], param)) => self.checked(param, value, range, valid).map(Some),
            None => Ok(None),
        }
    }

    /// A single integer that satisfies `valid`, in words `range`.
    pub(super) fn integer(
        &self,
        name: &'static str,
        range: &str,
        valid: impl Fn(i64) -> bool,
    ) -> Result<Option<i64>, SceneError> {
        match self.numbers::<1>(name, Type::Integer)? {
            // 31 bits, checked when it was read: exact in f64.
            Some(([value], param)) => self
                .checked(param, value, range, |value| valid(value as i64))
                .map(|value| Some(value as i64)),
            None => Ok(None),
        }
    }

    fn checked(
        &self,
        param: &Param,
        value: f64,
        range: &str,
        valid: impl Fn(f64) -> bool,
    ) -> Result<f64, SceneError> {
        if valid(value) {
            return Ok(value);
        }
        let Self { owner, .. } = self;
        let message = format!(
            "\"{}\" of {owner} must be {range}, found {value}",
            param.name
        );
        Err(SceneError::at(&param.nth(0), message))
    }

    /// A single point.
    pub(super) fn point(&self, name: &'static str) -> Result<Option<DVec3>, SceneError> {
        let values = self.numbers::<3>(name, Type::Point3)?;
        Ok(values.map(|(values, _)| DVec3::from_array(values)))
    }

    /// Exactly four floats, and their place.
    pub(super) fn four(
        &self,
        name: &'static str,
        ty: Type,
    ) -> Result<Option<([f64; 4], Place)>, SceneError> {
        let values = self.numbers::<4>(name, ty)?;
        Ok(values.map(|(values, param)| (values, param.valued.clone())))
    }

    /// A single string.
    pub(super) fn string(&self, name: &'static str) -> Result<Option<&Text>, SceneError> {
        let Some(param) = self.find(name, &[Type::String])? else {
            return Ok(None);
        };
        match &param.values {
            Values::Strings(strings) if strings.len() == 1 => Ok(strings.first()),
            Values::Strings(strings) => Err(self.count(param, 1, strings.len())),
            _ => Ok(None),
        }
    }

    /// A single truth value.
    pub(super) fn boolean(&self, name: &'static str) -> Result<Option<bool>, SceneError> {
        let Some(param) = self.find(name, &[Type::Bool])? else {
            return Ok(None);
        };
        match &param.values {
            Values::Bools(bools) if bools.len() == 1 => Ok(bools.first().copied()),
            Values::Bools(bools) => Err(self.count(param, 1, bools.len())),
            _ => Ok(None),
        }
    }

    /// All numbers of a parameter, as they stand.
    pub(super) fn list(
        &self,
        name: &'static str,
        ty: Type,
    ) -> Result<Option<(&[f64], &Param)>, SceneError> {
        let Some(param) = self.find(name, &[ty])? else {
            return Ok(None);
        };
        match &param.values {
            Values::Numbers(numbers) => {
                if !self.given.iter().any(|(given, _)| given.name == name) {
                    let bytes = size_of_val(numbers.as_slice()) as u64;
                    self.copied.set(self.copied.get().saturating_add(bytes));
                }
                Ok(Some((numbers, param)))
            }
            _ => Ok(None),
        }
    }

    /// What lists from `Attribute` take once more here \[bytes\]: a few words may ask for them again and again.
    pub(super) fn copied(&self) -> u64 {
        self.copied.get()
    }

    /// Accepts a parameter of any of these types without looking at it: what changes nothing here.
    pub(super) fn ignore(&self, name: &'static str, types: &[Type]) -> Result<(), SceneError> {
        self.find(name, types).map(|_| ())
    }

    /// Refuses a parameter that pbrt knows and we do not yet.
    pub(super) fn unsupported(
        &self,
        name: &'static str,
        instead: &str,
        diagnostics: &mut Diagnostics,
    ) -> Result<(), SceneError> {
        for (param, used) in self.given.iter().filter(|(p, _)| p.name == name) {
            used.set(true);
            diagnostics.refuse(self.not_yet(param, instead))?;
        }
        match self.inherited.iter().rev().find(|p| p.name == name) {
            Some(param) => diagnostics.refuse(self.not_yet(param, instead)),
            None => Ok(()),
        }
    }

    /// "Not yet supported" at a parameter.
    pub(super) fn not_yet(&self, param: &Param, instead: &str) -> SceneError {
        let message = format!(
            "parameter \"{}\" of {} is not yet supported",
            param.name, self.owner
        );
        SceneError::at(&param.declared, message).help(instead)
    }

    /// Complains about parameters that nobody asked for.
    pub(super) fn finish(&self, diagnostics: &mut Diagnostics) -> Result<(), SceneError> {
        for (param, _) in self.given.iter().filter(|(_, used)| !used.get()) {
            let message = format!("{} has no parameter \"{}\"", self.owner, param.name);
            let error = SceneError::at(&param.declared, message);
            let asked = self.asked.borrow();
            let help = match nearest(&param.name, asked.iter().copied()) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None if asked.is_empty() => "it takes none".to_owned(),
                None => format!("it takes {}", asked.join(", ")),
            };
            diagnostics.refuse(error.help(help))?;
        }
        Ok(())
    }
}
