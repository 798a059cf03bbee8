//! Arithmetic in scenarios: `"30 * i + normal(0, 2)"`.
//!
//! Only numbers, names, `+ - * / %`, brackets and the functions below are allowed. Nothing is ever run: the result is a
//! tree of numbers.

use super::laws::{Factor, LawOf, Several, Truncated};
use super::linear::Linear;
use super::range::Range;
use super::tokens::{Token, tokens};
use crate::scenario::{nearest, split_unit};
use plaus_dist::math;
use std::iter::Peekable;
use std::vec::IntoIter;

/// Most characters of a formula, and most brackets and signs in one another: reading goes as deep as they do.
const LONGEST: usize = 400;
const DEEPEST: usize = 32;

/// What functions there are, with how many numbers each takes.
const FUNCTIONS: &[(&str, usize, Function)] = &[
    ("abs", 1, Function::One(Range::abs)),
    ("sqrt", 1, Function::One(Range::sqrt)),
    ("floor", 1, Function::One(|a| a.rising(f64::floor))),
    ("exp", 1, Function::One(|a| a.rising(math::exp))),
    ("sin", 1, Function::One(|a| a.wave(math::sin))),
    ("cos", 1, Function::One(|a| a.wave(math::cos))),
    ("min", 2, Function::Two(Range::min)),
    ("max", 2, Function::Two(Range::max)),
    ("pow", 2, Function::Two(Range::pow)),
];

/// What laws can be drawn from within a formula, with how many numbers each takes; a choice takes any.
const LAWS: &[(&str, usize)] =
    &[("uniform", 2), ("normal", 2), ("truncated", 4), ("log_normal", 2), ("triangular", 3), ("choice", 0)];

#[derive(Debug, Clone, Copy)]
enum Function {
    One(fn(Range) -> Range),
    Two(fn(Range, Range) -> Range),
}

#[derive(Debug, Clone)]
enum Node {
    Number(f64),
    /// The value of this place: of a name, or of a law.
    Value(usize),
    Negative(Box<Node>),
    Sum(Box<[Node; 2]>),
    Product(Box<[Node; 2]>),
    Quotient(Box<[Node; 2]>),
    One(fn(Range) -> Range, Box<Node>),
    Two(fn(Range, Range) -> Range, Box<[Node; 2]>),
    /// The first selects one of the others.
    OneOf(Vec<Node>),
}

/// A formula that was read.
#[derive(Debug)]
pub(super) struct Formula {
    root: Node,
    /// Names in it, each once. Their values come first, those of its laws after them.
    pub(super) names: Vec<String>,
    laws: Vec<(&'static str, Vec<Node>)>,
}

impl Formula {
    /// Reads a formula.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        if text.chars().count() > LONGEST {
            return Err(format!("a formula has at most {LONGEST} characters"));
        }
        let (mut depth, mut signs, mut deepest) = (0_usize, 0_usize, 0_usize);
        for c in text.chars().filter(|c| !c.is_whitespace()) {
            signs = if c == '-' { signs + 1 } else { 0 };
            depth = if c == '(' { depth + 1 } else { depth.saturating_sub(usize::from(c == ')')) };
            deepest = deepest.max(depth + signs);
        }
        if deepest > DEEPEST {
            return Err(format!("nested too deeply: at most {DEEPEST} levels of brackets"));
        }
        let (digits, unit) = split_unit(text);
        if !unit.is_empty() {
            return Err(format!(
                "{text:?}: write {digits} without a unit; the unit is that of the key, as in `radius_mm`"
            ));
        }
        let mut formula = Self { root: Node::Number(0.0), names: Vec::new(), laws: Vec::new() };
        let tokens = tokens(text)?;
        // Places of names are known before those of laws.
        for (index, token) in tokens.iter().enumerate() {
            if let (Token::Name(name), false) = (token, tokens.get(index + 1) == Some(&Token::Sign('('))) {
                formula.names.extend(Some(name.to_string()).filter(|name| !formula.names.contains(name)));
            }
        }
        let mut reader = Reader { formula, rest: tokens.into_iter().peekable() };
        let whole = reader.sum().and_then(|node| match reader.rest.next() {
            None => Ok(node),
            Some(token) => Err(Unread::At(token)),
        });
        let mut formula = reader.formula;
        formula.root = whole.map_err(|unread| match unread {
            Unread::Wrong(message) => message,
            unread => format!("{text:?} cannot be read as arithmetic: {}", unread.hint(text)),
        })?;
        Ok(formula)
    }

    /// How many laws are drawn from.
    pub(super) fn laws(&self) -> usize {
        self.laws.len()
    }

    /// The law of this place, for the values of its names and of the laws before it. `None` if a number of it is
    /// uncertain.
    pub(super) fn law(&self, place: usize, values: &[Range]) -> Option<LawOf> {
        let (law, nodes) = &self.laws[place];
        let mut numbers = Vec::with_capacity(nodes.len());
        for node in nodes {
            let Range(low, high) = node.of(values);
            if low != high {
                return None;
            }
            numbers.push(low);
        }
        Some(match (*law, numbers.as_slice()) {
            ("uniform", &[low, high]) => LawOf::Uniform([low, high]),
            ("normal", &[mean, sd]) => LawOf::Normal([mean, sd]),
            ("truncated", &[mean, sd, from, to]) => LawOf::Truncated(Truncated { mean, sd, from, to }),
            ("log_normal", &[median, spread]) => LawOf::LogNormal(Factor { median, spread }),
            ("triangular", &[low, peak, high]) => LawOf::Triangular([low, peak, high]),
            _ => LawOf::Choice(Several { of: numbers, weights: Vec::new() }),
        })
    }

    /// What the law of this place is called, and its numbers as formulas of the same values.
    pub(super) fn numbers_of(&self, place: usize) -> (&'static str, Vec<Self>) {
        let (law, nodes) = &self.laws[place];
        let alone = |node: &Node| Self { root: node.clone(), names: self.names.clone(), laws: Vec::new() };
        (law, nodes.iter().map(alone).collect())
    }

    /// One of `count` values, chosen by a whole number from 0 that comes before them.
    pub(super) fn one_of(count: usize) -> Self {
        Self { root: Node::OneOf((0..=count).map(Node::Value).collect()), names: Vec::new(), laws: Vec::new() }
    }

    /// What it comes to.
    pub(super) fn of(&self, values: &[Range]) -> Range {
        self.root.of(values)
    }

    /// The same as a sum of multiples of what its values are; `None` if it is none.
    pub(super) fn linear<V: Copy + PartialEq>(&self, values: &[Linear<V>]) -> Option<Linear<V>> {
        self.root.linear(values)
    }

    fn call(&mut self, name: &str, nodes: Vec<Node>) -> Result<Node, String> {
        let count = |wanted: usize| format!("{name}(…) takes {wanted} numbers, but has {}", nodes.len());
        if let Some(&(law, wanted)) = LAWS.iter().find(|(known, _)| *known == name) {
            if (wanted > 0 && nodes.len() != wanted) || nodes.is_empty() {
                return Err(count(wanted.max(1)));
            }
            self.laws.push((law, nodes));
            return Ok(Node::Value(self.names.len() + self.laws.len() - 1));
        }
        let Some(&(_, wanted, function)) = FUNCTIONS.iter().find(|(known, ..)| *known == name) else {
            let known: Vec<&str> =
                FUNCTIONS.iter().map(|(known, ..)| *known).chain(LAWS.iter().map(|law| law.0)).collect();
            let near = nearest(name, known.iter().copied());
            let near = near.map(|near| format!("did you mean {near:?}? ")).unwrap_or_default();
            return Err(format!("there is no function {name:?}; {near}there are {}", known.join(", ")));
        };
        let wrong = count(wanted);
        let mut nodes = nodes.into_iter();
        match (function, nodes.next(), nodes.next(), nodes.next()) {
            (Function::One(f), Some(one), None, None) => Ok(Node::One(f, Box::new(one))),
            (Function::Two(f), Some(one), Some(other), None) => Ok(Node::Two(f, Box::new([one, other]))),
            _ => Err(wrong),
        }
    }
}

/// Reads tokens from left to right; a sign binds tighter than `* / %`, and these tighter than `+ -`.
struct Reader<'a> {
    formula: Formula,
    rest: Peekable<IntoIter<Token<'a>>>,
}

/// Why tokens are no formula.
enum Unread<'a> {
    /// For a reason in words.
    Wrong(String),
    /// Another token should stand here.
    At(Token<'a>),
    /// It ends too early.
    Ends,
}

impl Unread<'_> {
    fn hint(&self, text: &str) -> String {
        let count = |bracket: char| text.chars().filter(|&c| c == bracket).count();
        match self {
            _ if text.trim().is_empty() => "it is empty".to_owned(),
            _ if count('(') > count(')') => "a bracket is open".to_owned(),
            _ if count('(') < count(')') => "a bracket is closed that was not opened".to_owned(),
            Self::At(token) => format!("{token} is out of place"),
            Self::Ends | Self::Wrong(_) => "a number is missing at its end".to_owned(),
        }
    }
}

impl<'a> Reader<'a> {
    fn is_next(&mut self, sign: char) -> bool {
        self.rest.next_if_eq(&Token::Sign(sign)).is_some()
    }

    fn sum(&mut self) -> Result<Node, Unread<'a>> {
        let mut node = self.product()?;
        loop {
            node = match self.rest.next_if(|token| matches!(token, Token::Sign('+' | '-'))) {
                Some(Token::Sign('+')) => Node::Sum(Box::new([node, self.product()?])),
                Some(_) => Node::Sum(Box::new([node, Node::Negative(Box::new(self.product()?))])),
                None => return Ok(node),
            };
        }
    }

    fn product(&mut self) -> Result<Node, Unread<'a>> {
        let mut node = self.factor()?;
        loop {
            node = match self.rest.next_if(|token| matches!(token, Token::Sign('*' | '/' | '%'))) {
                Some(Token::Sign('*')) => Node::Product(Box::new([node, self.factor()?])),
                Some(Token::Sign('/')) => Node::Quotient(Box::new([node, self.factor()?])),
                Some(_) => Node::Two(Range::modulo, Box::new([node, self.factor()?])),
                None => return Ok(node),
            };
        }
    }

    fn factor(&mut self) -> Result<Node, Unread<'a>> {
        match self.rest.next().ok_or(Unread::Ends)? {
            Token::Number(value) => Ok(Node::Number(value)),
            Token::Sign('-') => Ok(Node::Negative(Box::new(self.factor()?))),
            Token::Sign('(') => {
                let node = self.sum()?;
                self.close().map(|()| node)
            }
            Token::Name(name) if self.is_next('(') => {
                let mut nodes = Vec::new();
                while self.rest.peek() != Some(&Token::Sign(')')) {
                    nodes.push(self.sum()?);
                    if !self.is_next(',') {
                        break;
                    }
                }
                self.close()?;
                self.formula.call(name, nodes).map_err(Unread::Wrong)
            }
            Token::Name(name) => {
                let place = self.formula.names.iter().position(|known| known == name);
                place.map(Node::Value).ok_or(Unread::At(Token::Name(name)))
            }
            token => Err(Unread::At(token)),
        }
    }

    fn close(&mut self) -> Result<(), Unread<'a>> {
        match self.rest.next() {
            Some(Token::Sign(')')) => Ok(()),
            token => Err(token.map_or(Unread::Ends, Unread::At)),
        }
    }
}

impl Node {
    fn of(&self, values: &[Range]) -> Range {
        match self {
            Self::Number(value) => Range::point(*value),
            Self::Value(place) => values[*place],
            Self::Negative(inner) => inner.of(values).minus(),
            Self::Sum(inner) => inner[0].of(values).plus(inner[1].of(values)),
            Self::Product(inner) => inner[0].of(values).times(inner[1].of(values)),
            Self::Quotient(inner) => inner[0].of(values).over(inner[1].of(values)),
            Self::One(f, inner) => f(inner.of(values)),
            Self::Two(f, inner) => f(inner[0].of(values), inner[1].of(values)),
            Self::OneOf(nodes) => {
                let Range(low, high) = nodes[0].of(values);
                let some = nodes.iter().skip(1 + low as usize).take(1 + (high - low) as usize);
                some.map(|node| node.of(values)).reduce(Range::or).unwrap_or(Range::NONE)
            }
        }
    }

    fn linear<V: Copy + PartialEq>(&self, values: &[Linear<V>]) -> Option<Linear<V>> {
        Some(match self {
            Self::Number(value) => Linear::number(*value),
            Self::Value(place) => values[*place].clone(),
            Self::Negative(inner) => inner.linear(values)?.times(-1.0),
            Self::Sum(inner) => inner[0].linear(values)?.plus(&inner[1].linear(values)?),
            Self::Product(inner) => {
                let [a, b] = [inner[0].linear(values)?, inner[1].linear(values)?];
                match (a.alone(), b.alone()) {
                    (_, Some(factor)) => a.times(factor),
                    (Some(factor), _) => b.times(factor),
                    _ => return None,
                }
            }
            Self::Quotient(inner) => inner[0].linear(values)?.times(1.0 / inner[1].linear(values)?.alone()?),
            Self::One(..) | Self::Two(..) | Self::OneOf(_) => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worth(text: &str, values: &[f64]) -> f64 {
        let formula = Formula::read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let Range(low, high) = formula.of(&values.iter().map(|value| Range::point(*value)).collect::<Vec<_>>());
        assert_eq!(low.to_bits(), high.to_bits(), "{text}");
        low
    }

    #[test]
    fn arithmetic_is_as_on_paper() {
        assert_eq!(worth("0.5 * width + 20 * i", &[6.0, 3.0]), 63.0);
        assert_eq!(worth("2 - 3 - 4 * -2", &[]), 7.0);
        assert_eq!(worth("7 % 3 + -7 % 3 + 1e1", &[]), 1.0 + 2.0 + 10.0);
        assert_eq!(worth("max(min(1, 2), min(3, 4)) * 2 + 1", &[]), 7.0);
        assert_eq!(worth("sin(30) + cos(60) + sqrt(4) + abs(-3) + floor(1.7) + pow(2, 3)", &[]), 15.0);
        assert_eq!(worth("minor + minor", &[2.0]), 4.0, "a name that begins as a function does");
    }

    #[test]
    fn what_is_no_arithmetic_is_told_so() {
        let deep = format!("{}1{}", "(".repeat(40), ")".repeat(40));
        let long = "1 + ".repeat(200) + "1";
        for (text, part) in [
            ("", "it is empty"),
            ("1 +", "cannot be read"),
            ("2 ^ 3", "pow(a, b)"),
            ("20mm", "write 20 without a unit"),
            ("30 mm", "write 30 without a unit"),
            ("2 * 20mm", "without units"),
            ("sine(3)", "did you mean \"sin\"?"),
            ("min(3)", "takes 2 numbers, but has 1"),
            ("normal(3)", "takes 2 numbers"),
            ("std::process::exit(1)", "arithmetic may"),
            ("0x10", "without units"),
            ("1 + 2)", "not opened"),
            ("2 * (1 + 3", "a bracket is open"),
            ("2 3", "\"3\" is out of place"),
            ("2 < 3", "the operators are"),
            ("a.b()", "arithmetic may"),
            ("{ loop {} }", "arithmetic may"),
            ("\"a\"", "numbers"),
            (&deep, "nested too deep"),
            (&long, "at most 400 characters"),
            (&"-".repeat(300), "nested too deep"),
        ] {
            let error = Formula::read(text).expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    /// The range of a difference holds whatever points give; and it is no wider where both are sums of multiples.
    #[test]
    fn differences_are_exact() {
        let ranges = [Range(0.7, 1.4), Range(-2.0, 3.0)];
        let range = |value: usize| ranges[value];
        for (low, high, exact) in [
            ("a", "2 * a", true),
            ("0.1 + a", "0.1 + a + a", true),
            ("a + b", "b + 3 * a / 2 - 1", true),
            ("-(b - a) * 2", "(a - b) * -(1 + 1)", true),
            ("a + b", "max(a, b) * 0 + b + a", false),
            ("a * b", "a * b + 1", false),
            ("a", "a / b", false),
        ] {
            let [low, high] = [low, high].map(|text| Formula::read(text).unwrap());
            let known = |formula: &Formula| -> Vec<usize> {
                formula.names.iter().map(|name| usize::from(name == "b")).collect()
            };
            let linear = |formula: &Formula| {
                let values: Vec<Linear<usize>> = known(formula).into_iter().map(Linear::value).collect();
                formula.linear(&values)
            };
            let gap = linear(&high).zip(linear(&low)).map(|(high, low)| high.plus(&low.times(-1.0)).range(range));
            assert_eq!(gap.is_some(), exact);
            let Some(gap) = gap else { continue };
            let mut seen = Range(f64::INFINITY, f64::NEG_INFINITY);
            for corner in 0..4 {
                let point = [ranges[0], ranges[1]].map(|Range(low, high)| [low, high]);
                let point = [point[0][corner & 1], point[1][corner >> 1]];
                let at = |formula: &Formula| {
                    let values: Vec<Range> =
                        known(formula).into_iter().map(|which| Range::point(point[which])).collect();
                    formula.of(&values).0
                };
                let difference = at(&high) - at(&low);
                seen = Range(seen.0.min(difference), seen.1.max(difference));
            }
            // Rounding of a few numbers below 10.
            assert!((seen.0 - gap.0).abs() < 1e-14 && (seen.1 - gap.1).abs() < 1e-14, "{seen:?} {gap:?}");
        }
    }
}
