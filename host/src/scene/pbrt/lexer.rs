//! Tokens of pbrt's language: words, strings, brackets.
//!
//! Numbers are words too; whoever expects one asks [`Token::number`]. Works on bytes, because comments
//! come in all encodings; only strings must be UTF-8.

use std::sync::Arc;

use super::super::{Place, SceneError, Source};

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `[`
    Open,
    /// `]`
    Close,
    /// `"…"`, quotes included in the span.
    String,
    /// Anything else up to a space, quote, bracket or comment.
    Word,
}

/// A token with its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) start: usize,
    pub(super) end: usize,
    line: usize,
    line_start: usize,
}

/// Cuts one source into tokens.
#[derive(Debug)]
pub(super) struct Lexer {
    source: Arc<Source>,
    at: usize,
    line: usize,
    line_start: usize,
    peeked: Option<Option<Token>>,
}

impl Lexer {
    /// Starts at the beginning, or after a byte order mark.
    ///
    /// # Errors
    /// UTF-16 text, which pbrt does not read either.
    pub(super) fn new(source: Arc<Source>) -> Result<Self, SceneError> {
        let bytes = source.bytes();
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            let message = "the file is UTF-16; a scene must be UTF-8";
            return Err(SceneError::of_file(source.name(), message));
        }
        let at = if bytes.starts_with(b"\xef\xbb\xbf") {
            3
        } else {
            0
        };
        Ok(Self {
            source,
            at,
            line: 1,
            line_start: at,
            peeked: None,
        })
    }

    /// The next token without taking it; `None` at the end.
    pub(super) fn peek(&mut self) -> Result<Option<Token>, SceneError> {
        if let Some(token) = self.peeked {
            return Ok(token);
        }
        let token = self.scan()?;
        self.peeked = Some(token);
        Ok(token)
    }

    /// The next token; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Token>, SceneError> {
        match self.peeked.take() {
            Some(token) => Ok(token),
            None => self.scan(),
        }
    }

    /// Place of a token of this source.
    pub(super) fn place(&self, token: &Token) -> Place {
        let Token { start, end, .. } = *token;
        Place::on_line(&self.source, start, end, token.line, token.line_start)
    }

    /// Place from the first byte of one token to the last of another.
    pub(super) fn joined(&self, first: &Token, last: &Token) -> Place {
        let Token {
            start,
            line,
            line_start,
            ..
        } = *first;
        Place::on_line(&self.source, start, last.end, line, line_start)
    }

    /// Continues at a place of this source.
    pub(super) fn skip_to(&mut self, place: &Place) {
        self.at = place.span().start;
        (self.line, self.line_start) = place.line_and_start();
        self.peeked = None;
    }

    /// The place just behind the last byte.
    pub(super) fn end(&self) -> Place {
        let len = self.source.bytes().len();
        Place::on_line(&self.source, len, len, self.line, self.line_start)
    }

    /// The bytes of a token.
    pub(super) fn bytes(&self, token: &Token) -> &[u8] {
        &self.source.bytes()[token.start..token.end]
    }

    /// A token's text for a message.
    pub(super) fn shown(&self, token: &Token) -> String {
        let text: String = String::from_utf8_lossy(self.bytes(token))
            .chars()
            .take(60)
            .collect();
        text.escape_debug().to_string().replace("\\\"", "\"")
    }

    /// The number that a word spells.
    ///
    /// # Errors
    /// Anything but a finite decimal number.
    pub(super) fn number(&self, token: &Token) -> Result<f64, SceneError> {
        let bytes = self.bytes(token);
        if token.kind == Kind::Word
            && let [digit @ b'0'..=b'9'] = bytes
        {
            return Ok(f64::from(digit - b'0'));
        }
        let shown = self.shown(token);
        let fail = |message: String| Err(SceneError::at(&self.place(token), message));
        if token.kind != Kind::Word {
            return fail(format!("expected a number, found {shown}"));
        }
        let value = std::str::from_utf8(bytes).ok().and_then(|t| t.parse().ok());
        match value {
            Some(value) if f64::is_finite(value) => Ok(value),
            Some(_) => fail(format!("{shown} is not a finite number")),
            None => fail(format!("expected a number, found {shown}")),
        }
    }

    /// The text of a string token, escapes replaced.
    pub(super) fn text(&self, token: &Token) -> Result<String, SceneError> {
        let bytes = self.bytes(token);
        let inner = &bytes[1..bytes.len() - 1];
        let escape = |at: usize, message: &str| {
            let start = token.start + 1 + at;
            SceneError::at(&Place::new(&self.source, start, start + 2), message)
        };
        let mut out = Vec::with_capacity(inner.len());
        let mut i = 0;
        while i < inner.len() {
            if inner[i] != b'\\' {
                out.push(inner[i]);
                i += 1;
                continue;
            }
            out.push(match inner.get(i + 1) {
                Some(b'b') => 8,
                Some(b'f') => 12,
                Some(b'n') => b'\n',
                Some(b'r') => b'\r',
                Some(b't') => b'\t',
                Some(&c @ (b'\\' | b'\'' | b'"')) => c,
                _ => {
                    let known = "the escapes are \\b \\f \\n \\r \\t \\\\ \\' \\\"";
                    return Err(escape(i, "unknown escape in a string").help(known));
                }
            });
            i += 2;
        }
        String::from_utf8(out)
            .map_err(|_| SceneError::at(&self.place(token), "this string is not UTF-8"))
    }

    fn scan(&mut self) -> Result<Option<Token>, SceneError> {
        let source = Arc::clone(&self.source);
        let bytes = source.bytes();
        loop {
            match bytes.get(self.at) {
                None => return Ok(None),
                Some(b'\n') => {
                    self.at += 1;
                    self.line += 1;
                    self.line_start = self.at;
                }
                Some(b' ' | b'\t' | b'\r') => self.at += 1,
                Some(b'#') => self.at += length(&bytes[self.at..], |b| b == b'\n'),
                Some(_) => break,
            }
        }
        let start = self.at;
        let rest = &bytes[start..];
        let (kind, len) = match rest[0] {
            b'[' => (Kind::Open, 1),
            b']' => (Kind::Close, 1),
            b'"' => (Kind::String, self.string(rest)?),
            _ => {
                let ends =
                    |b| matches!(b, b' ' | b'\n' | b'\t' | b'\r' | b'"' | b'[' | b']' | b'#');
                (Kind::Word, length(rest, ends))
            }
        };
        self.at += len;
        Ok(Some(Token {
            kind,
            start,
            end: self.at,
            line: self.line,
            line_start: self.line_start,
        }))
    }

    /// Length of the string that `rest` begins with, quotes included.
    fn string(&self, rest: &[u8]) -> Result<usize, SceneError> {
        let mut i = 1;
        loop {
            match rest.get(i) {
                Some(b'"') => return Ok(i + 1),
                Some(b'\\') if !matches!(rest.get(i + 1), None | Some(b'\n')) => i += 2,
                Some(b'\n') | None => {
                    let len = if rest.get(i - 1) == Some(&b'\r') {
                        i - 1
                    } else {
                        i
                    };
                    let start = self.at;
                    let place = Place::on_line(
                        &self.source,
                        start,
                        start + len,
                        self.line,
                        self.line_start,
                    );
                    return Err(SceneError::at(&place, "this string has no closing quote")
                        .help("a string ends on the line that it begins on"));
                }
                Some(_) => i += 1,
            }
        }
    }
}

/// How many bytes come before the first that `ends`.
fn length(bytes: &[u8], ends: impl Fn(u8) -> bool) -> usize {
    bytes.iter().position(|&b| ends(b)).unwrap_or(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lexer(text: &[u8]) -> Lexer {
        Lexer::new(Source::new("t", text.to_vec())).expect("UTF-8")
    }

    #[test]
    fn words_strings_brackets_and_comments() {
        let mut lexer = lexer(b"\xef\xbb\xbfShape \"a\\\"b\"[1 -2.5e3]# \xff caf\xe9 \"\n.5#x\n]");
        let mut seen = Vec::new();
        while let Some(token) = lexer.next().expect("lexes") {
            seen.push((token.kind, lexer.shown(&token)));
        }
        let text: Vec<&str> = seen.iter().map(|(_, t)| t.as_str()).collect();
        assert_eq!(text[0], "Shape");
        assert_eq!(text[2..], ["[", "1", "-2.5e3", "]", ".5", "]"]);
        assert_eq!(seen[1].0, Kind::String);
    }

    #[test]
    fn numbers_are_finite() {
        for (text, value) in [
            ("7", 7.0),
            ("-1", -1.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("+2e-3", 2e-3),
        ] {
            let mut lexer = lexer(text.as_bytes());
            let token = lexer.next().expect("lexes").expect("a token");
            assert_eq!(lexer.number(&token).expect("a number"), value);
        }
        for text in [
            "nan",
            "inf",
            "-infinity",
            "1e999",
            "1.2.3",
            "0x10",
            "\"1\"",
            "[",
        ] {
            let mut lexer = lexer(text.as_bytes());
            let token = lexer.next().expect("lexes").expect("a token");
            assert!(lexer.number(&token).is_err(), "{text}");
        }
    }

    #[test]
    fn strings_end_on_their_line() {
        for text in ["\"abc", "\"abc\n\"", "\"abc\\", "\"abc\\\n\"", "\"abc\r\n"] {
            let error = lexer(text.as_bytes()).next().expect_err("unterminated");
            assert!(error.to_string().starts_with("t:1:1: "), "{error}");
        }
    }

    #[test]
    fn escapes_are_replaced() {
        let mut good = lexer(br#""a\t\"\\\n""#);
        let token = good.next().expect("lexes").expect("a token");
        assert_eq!(good.text(&token).expect("text"), "a\t\"\\\n");
        let mut bad = lexer(br#"  "ab\q""#);
        let token = bad.next().expect("lexes").expect("a token");
        let error = bad.text(&token).expect_err("unknown escape");
        assert!(error.to_string().starts_with("t:1:6: "), "{error}");
    }
}
