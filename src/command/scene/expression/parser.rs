//! From the text of an expression to operations on a stack.
//!
//! ```text
//! sum     = product  { ("+" | "-") product }
//! product = signed   { ("*" | "/") signed }
//! signed  = ("+" | "-") signed | power
//! power   = operand [ "^" signed ]
//! operand = number | name | name "(" sum [ "," sum ] ")" | "(" sum ")"
//! ```
//! A sign binds less than a power and powers group from the right, as in mathematics. (The crate exmex reads
//! `-x^2` as `(-x)^2` and `2^3^2` as `(2^3)^2`, and knows no `1e-3`: a scene would silently mean another
//! load.)

use std::fmt;

use super::error::ExpressionProblem as Problem;
use super::functions::{BINARY, Binary, CONSTANTS, UNARY, Unary, entry, find, names};
use crate::scene::text::shorten;

/// Longest expression, in bytes.
const LONGEST: usize = 2000;
/// Deepest nesting: the parser calls itself once a level.
const DEEPEST: usize = 100;

/// One operation; it takes its operands from a stack and leaves its result there.
#[derive(Clone, Copy)]
pub(super) enum Operation {
    Number(f64),
    /// Index into the variables.
    Variable(usize),
    /// With the name of the function.
    Unary(&'static str, Unary),
    Binary(&'static str, Binary),
}

/// By name: the address of a function differs from process to process, and this text tells whether two scenes
/// are alike.
impl fmt::Debug for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => f.debug_tuple("Number").field(number).finish(),
            Self::Variable(index) => f.debug_tuple("Variable").field(index).finish(),
            Self::Unary(name, _) => f.debug_tuple("Unary").field(name).finish(),
            Self::Binary(name, _) => f.debug_tuple("Binary").field(name).finish(),
        }
    }
}

/// Translates `text`.
pub(super) fn compile(text: &str, variables: &[&str]) -> Result<Vec<Operation>, Problem> {
    if text.len() > LONGEST {
        return Err(Problem::TooMuch {
            what: "long",
            allowed: "2000 characters",
        });
    }
    let mut parser = Parser {
        text,
        position: 0,
        depth: 0,
        variables,
        program: Vec::new(),
    };
    parser.sum()?;
    match parser.peek() {
        None => Ok(parser.program),
        Some(_) => Err(parser.unexpected("an operator (+ - * / ^) or the end")),
    }
}

struct Parser<'a> {
    text: &'a str,
    /// Byte of the text that comes next.
    position: usize,
    depth: usize,
    variables: &'a [&'a str],
    program: Vec<Operation>,
}

impl<'a> Parser<'a> {
    fn sum(&mut self) -> Result<(), Problem> {
        self.product()?;
        loop {
            let operation = match self.peek() {
                Some('+') => Operation::Binary("+", |a, b| a + b),
                Some('-') => Operation::Binary("-", |a, b| a - b),
                _ => return Ok(()),
            };
            self.position += 1;
            self.product()?;
            self.program.push(operation);
        }
    }

    fn product(&mut self) -> Result<(), Problem> {
        self.signed()?;
        loop {
            let operation = match self.peek() {
                Some('*') => Operation::Binary("*", |a, b| a * b),
                Some('/') => Operation::Binary("/", |a, b| a / b),
                _ => return Ok(()),
            };
            self.position += 1;
            self.signed()?;
            self.program.push(operation);
        }
    }

    fn signed(&mut self) -> Result<(), Problem> {
        if self.depth == DEEPEST {
            return Err(Problem::TooMuch {
                what: "deeply nested",
                allowed: "100 levels",
            });
        }
        self.depth += 1;
        match self.peek() {
            Some('-') => {
                self.position += 1;
                self.signed()?;
                self.program.push(Operation::Unary("-", |a| -a));
            }
            Some('+') => {
                self.position += 1;
                self.signed()?;
            }
            _ => self.power()?,
        }
        self.depth -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), Problem> {
        self.operand()?;
        if self.peek() == Some('^') {
            self.position += 1;
            self.signed()?;
            self.program.push(Operation::Binary("^", f64::powf));
        }
        Ok(())
    }

    fn operand(&mut self) -> Result<(), Problem> {
        match self.peek() {
            Some('(') => {
                self.position += 1;
                self.sum()?;
                self.expect(')', "')' or an operator")
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if is_name(c) => self.name(),
            _ => Err(self.unexpected("a number, a name or '('")),
        }
    }

    fn number(&mut self) -> Result<(), Problem> {
        let rest = self.rest();
        let digits = |from: usize| rest.bytes().skip(from).take_while(u8::is_ascii_digit).count();
        let mut length = digits(0);
        if rest.as_bytes().get(length) == Some(&b'.') {
            length += 1 + digits(length + 1);
        }
        // Only with digits: the e of "2*e" is a name.
        if matches!(rest.as_bytes().get(length), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.as_bytes().get(length + 1), Some(b'+' | b'-')));
            let exponent = digits(length + 1 + sign);
            if exponent > 0 {
                length += 1 + sign + exponent;
            }
        }
        let text = rest.get(..length).unwrap_or_default();
        let Ok(number) = text.parse::<f64>() else {
            return Err(self.unexpected("a number"));
        };
        if number.is_infinite() {
            let number = shorten(text);
            return Err(Problem::TooLarge { number });
        }
        self.position += length;
        self.program.push(Operation::Number(number));
        Ok(())
    }

    fn name(&mut self) -> Result<(), Problem> {
        let rest = self.rest();
        let length = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        let name = rest.get(..length).unwrap_or_default();
        self.position += length;
        if self.peek() == Some('(') {
            return self.call(name);
        }
        let variable = self.variables.iter().position(|v| *v == name);
        if let Some(index) = variable {
            self.program.push(Operation::Variable(index));
        } else if let Some(constant) = find(&CONSTANTS, name) {
            self.program.push(Operation::Number(constant));
        } else if find(&UNARY, name).is_some() || find(&BINARY, name).is_some() {
            return Err(Problem::NoArguments { name: name.into() });
        } else {
            return Err(self.unknown_name(name));
        }
        Ok(())
    }

    fn call(&mut self, name: &str) -> Result<(), Problem> {
        self.position += 1;
        let operation = if let Some((name, function)) = entry(&UNARY, name) {
            self.sum()?;
            Operation::Unary(name, function)
        } else if let Some((name, function)) = entry(&BINARY, name) {
            self.sum()?;
            self.expect(',', "',' and a second argument")?;
            self.sum()?;
            Operation::Binary(name, function)
        } else if self.variables.contains(&name) || find(&CONSTANTS, name).is_some() {
            self.position -= 1;
            return Err(self.unexpected("an operator (+ - * / ^) or the end"));
        } else {
            return Err(Problem::UnknownFunction {
                name: shorten(name),
                allowed: names(),
            });
        };
        self.expect(')', "')' or an operator")?;
        self.program.push(operation);
        Ok(())
    }

    fn expect(&mut self, wanted: char, expected: &'static str) -> Result<(), Problem> {
        if self.peek() != Some(wanted) {
            return Err(self.unexpected(expected));
        }
        self.position += wanted.len_utf8();
        Ok(())
    }

    /// The next character that is not blank.
    fn peek(&mut self) -> Option<char> {
        let blank = self.rest().len() - self.rest().trim_start().len();
        self.position += blank;
        self.rest().chars().next()
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.position..).unwrap_or_default()
    }

    fn unexpected(&self, expected: &'static str) -> Problem {
        match self.rest().chars().next() {
            None => Problem::Ends { expected },
            Some(found) => Problem::Unexpected {
                found: shorten(&found.to_string()),
                column: 1 + self.text.get(..self.position).unwrap_or_default().chars().count(),
                expected,
            },
        }
    }

    fn unknown_name(&self, name: &str) -> Problem {
        let constants = CONSTANTS.iter().map(|constant| constant.0);
        let allowed: Vec<_> = self.variables.iter().copied().chain(constants).collect();
        Problem::UnknownName {
            name: shorten(name),
            allowed: allowed.join(", "),
        }
    }
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
