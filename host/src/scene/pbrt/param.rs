//! Parameters: `"type name" value` or `"type name" [ value … ]`.

use super::super::{Place, SceneError};
use super::diagnostics::Diagnostics;
use super::lexer::{Kind, Lexer, Token};
use super::suggest::nearest;

/// Most parameters of one directive; no directive knows half as many.
pub(super) const MOST: usize = 256;

/// The types of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Blackbody,
    Bool,
    Float,
    Integer,
    Normal,
    Point2,
    Point3,
    Rgb,
    Spectrum,
    String,
    Texture,
    Vector2,
    Vector3,
}

/// The spelling of each type.
const TYPES: [(&str, Type); 13] = [
    ("blackbody", Type::Blackbody),
    ("bool", Type::Bool),
    ("float", Type::Float),
    ("integer", Type::Integer),
    ("normal", Type::Normal),
    ("point2", Type::Point2),
    ("point3", Type::Point3),
    ("rgb", Type::Rgb),
    ("spectrum", Type::Spectrum),
    ("string", Type::String),
    ("texture", Type::Texture),
    ("vector2", Type::Vector2),
    ("vector3", Type::Vector3),
];

impl Type {
    pub(super) fn name(self) -> &'static str {
        let found = TYPES.iter().find(|(_, ty)| *ty == self);
        found.map_or("?", |(name, _)| name)
    }

    /// Numbers that make up one value.
    fn arity(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 | Self::Spectrum => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }
}

/// A string with its place.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) text: String,
    pub(super) place: Place,
}

/// The values of a parameter; which kind depends on its type.
#[derive(Clone, Debug)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Strings(Vec<Text>),
    Bools(Vec<bool>),
}

/// One parameter of a list.
#[derive(Clone, Debug)]
pub(super) struct Param {
    pub(super) ty: Type,
    pub(super) name: String,
    pub(super) values: Values,
    /// The declaration, `"float g"`.
    pub(super) declared: Place,
    /// The first byte of the values to the last, brackets included.
    pub(super) valued: Place,
}

impl Param {
    /// Place of the nth value: read again, because a place for each of a million voxels would outweigh
    /// the voxels.
    pub(super) fn nth(&self, n: usize) -> Place {
        let Ok(mut lexer) = Lexer::new(self.valued.source().clone()) else {
            return self.valued.clone();
        };
        lexer.skip_to(&self.valued);
        let mut left = n;
        while let Ok(Some(token)) = lexer.next() {
            match token.kind {
                Kind::Open => {}
                Kind::Close => break,
                _ if left == 0 => return lexer.place(&token),
                _ => left -= 1,
            }
        }
        self.valued.clone()
    }
}

/// Reads parameters up to the first token that is not a string.
pub(super) fn read_list(
    lexer: &mut Lexer,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Param>, SceneError> {
    let mut list: Vec<Param> = Vec::new();
    while let Some(token) = lexer.peek()?
        && token.kind == Kind::String
    {
        lexer.next()?;
        if let Some(param) = read_one(lexer, &token, diagnostics)? {
            if let Some(older) = list.iter().find(|older| older.name == param.name) {
                let message = format!("parameter \"{}\" is given twice", param.name);
                diagnostics.warn(
                    SceneError::at(&param.declared, message)
                        .note(&older.declared, "this one does not count"),
                );
            }
            if list.len() == MOST {
                let message = format!("more than {MOST} parameters");
                return Err(SceneError::at(&param.declared, message));
            }
            list.push(param);
        }
    }
    Ok(list)
}

fn read_one(
    lexer: &mut Lexer,
    declaration: &Token,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Param>, SceneError> {
    let declared = lexer.place(declaration);
    let text = lexer.text(declaration)?;
    let mut words = text.split_whitespace();
    let (Some(type_name), Some(name), None) = (words.next(), words.next(), words.next()) else {
        let message = "expected a parameter's type and name";
        return Err(SceneError::at(&declared, message).help("for example \"float fov\" 45"));
    };
    let Some(ty) = type_named(type_name) else {
        diagnostics.refuse(unknown_type(&declared, type_name))?;
        skip_values(lexer, &declared)?;
        return Ok(None);
    };
    let mut values = match ty {
        Type::Bool => Values::Bools(Vec::new()),
        Type::String | Type::Texture => Values::Strings(Vec::new()),
        _ => Values::Numbers(Vec::new()),
    };
    let valued = each_value(lexer, &declared, |lexer, token| {
        push(lexer, token, ty, &mut values)
    })?;
    if let Values::Numbers(numbers) = &values
        && numbers.len() % ty.arity() != 0
    {
        let message = format!(
            "\"{} {name}\" takes numbers in groups of {}, found {}",
            ty.name(),
            ty.arity(),
            numbers.len()
        );
        return Err(SceneError::at(&valued, message));
    }
    Ok(Some(Param {
        ty,
        name: name.to_owned(),
        values,
        declared,
        valued,
    }))
}

fn type_named(name: &str) -> Option<Type> {
    // pbrt has called it both.
    let name = if name == "normal3" { "normal" } else { name };
    TYPES.iter().find(|(n, _)| *n == name).map(|&(_, ty)| ty)
}

fn unknown_type(place: &Place, name: &str) -> SceneError {
    let error = SceneError::at(place, format!("unknown parameter type \"{name}\""));
    let older = [("point", "point3"), ("vector", "vector3"), ("color", "rgb")];
    if let Some((_, now)) = older.iter().find(|(old, _)| *old == name) {
        return error.help(format!("pbrt-v4 calls it \"{now}\""));
    }
    let names = TYPES.map(|(name, _)| name);
    match nearest(name, names) {
        Some(near) => error.help(format!("did you mean \"{near}\"?")),
        None => error.help(format!("the types are {}", names.join(", "))),
    }
}

/// Hands over each value, and returns the place of all.
fn each_value(
    lexer: &mut Lexer,
    declared: &Place,
    mut value: impl FnMut(&Lexer, &Token) -> Result<(), SceneError>,
) -> Result<Place, SceneError> {
    let missing = |lexer: &Lexer| {
        SceneError::at(&lexer.end(), "the file ends where a value should be")
            .note(declared, "of this parameter")
    };
    let first = lexer.next()?.ok_or_else(|| missing(lexer))?;
    let begin = lexer.place(&first);
    match first.kind {
        Kind::Close => Err(SceneError::at(&begin, "expected a value, found ]")),
        Kind::String | Kind::Word => value(lexer, &first).map(|()| begin),
        Kind::Open => loop {
            let Some(token) = lexer.next()? else {
                return Err(SceneError::at(&begin, "this bracket is never closed"));
            };
            match token.kind {
                Kind::Close => return Ok(lexer.joined(&first, &token)),
                Kind::Open => {
                    let message = "expected a value or ], found another [";
                    return Err(SceneError::at(&lexer.place(&token), message)
                        .note(&begin, "this list is still open"));
                }
                _ => value(lexer, &token).map_err(|error| {
                    // A directive inside of a list means that the bracket before it was forgotten.
                    if token.kind == Kind::Word && lexer.bytes(&token)[0].is_ascii_uppercase() {
                        error.note(&begin, "a list is open since this bracket")
                    } else {
                        error
                    }
                })?,
            }
        },
    }
}

fn skip_values(lexer: &mut Lexer, declared: &Place) -> Result<(), SceneError> {
    each_value(lexer, declared, |_, _| Ok(())).map(|_| ())
}

fn push(lexer: &Lexer, token: &Token, ty: Type, values: &mut Values) -> Result<(), SceneError> {
    let expected = |what: &str| {
        let message = format!("expected {what}, found {}", lexer.shown(token));
        Err(SceneError::at(&lexer.place(token), message))
    };
    match values {
        Values::Bools(bools) => match lexer.bytes(token) {
            b"true" | b"\"true\"" => bools.push(true),
            b"false" | b"\"false\"" => bools.push(false),
            _ => return expected("true or false"),
        },
        Values::Strings(strings) => {
            if token.kind != Kind::String {
                return expected("a string in quotes");
            }
            strings.push(Text {
                text: lexer.text(token)?,
                place: lexer.place(token),
            });
        }
        // A spectrum may also be a name, or a file's.
        Values::Numbers(numbers) if ty == Type::Spectrum && token.kind == Kind::String => {
            if !numbers.is_empty() {
                return expected("a number");
            }
            *values = Values::Strings(vec![Text {
                text: lexer.text(token)?,
                place: lexer.place(token),
            }]);
        }
        Values::Numbers(numbers) => {
            if ty == Type::Integer {
                let text = lexer.bytes(token);
                let digits = text.strip_prefix(b"-").unwrap_or(text);
                let digits = digits.strip_prefix(b"+").unwrap_or(digits);
                if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
                    return expected("an integer");
                }
                let value = lexer.number(token)?;
                if value.abs() > f64::from(i32::MAX) {
                    return expected("an integer of at most 31 bits");
                }
                numbers.push(value);
            } else {
                numbers.push(lexer.number(token)?);
            }
        }
    }
    Ok(())
}
