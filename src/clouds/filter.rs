//! Conditions on columns: a small language of expressions.
//!
//! ```text
//! or      = and { ("or" | "||") and }
//! and     = not { ("and" | "&&") not }
//! not     = ("not" | "!") not | compare
//! compare = sum [ ("==" | "!=" | "<" | "<=" | ">" | ">=") sum ]
//! sum     = product { ("+" | "-") product }
//! product = power { ("*" | "/" | "%") power }
//! power   = sign [ "^" power ]
//! sign    = "-" sign | number | 'text' | name | function "(" or { "," or } ")" | "(" or ")"
//! ```

mod tokens;

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use super::columns::{ColumnValues, FrameColumns};
use super::error::{CloudError, CloudPart};
use tokens::{Token, TokenKind, error, tokens};

/// A condition on the columns of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleFilter {
    root: Expression,
    columns: Vec<NamedColumn>,
}

/// A column that a filter names, with the place of the name.
#[derive(Clone, Debug, PartialEq)]
struct NamedColumn {
    name: String,
    place: Range<usize>,
}

/// An expression, with the place of its operator.
#[derive(Clone, Debug, PartialEq)]
struct Expression {
    kind: ExpressionKind,
    place: Range<usize>,
}

#[derive(Clone, Debug, PartialEq)]
enum ExpressionKind {
    Number(f64),
    Text(String),
    /// An index in the filter's list of columns.
    Column(usize),
    Call(Function, Vec<Expression>),
    Compare(Relation, Box<[Expression; 2]>),
    Arithmetic(Arithmetic, Box<[Expression; 2]>),
    Negate(Box<Expression>),
    Not(Box<Expression>),
    And(Box<[Expression; 2]>),
    Or(Box<[Expression; 2]>),
}

/// The kind of an expression's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Number,
    Text,
    Condition,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Equal,
    Different,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Power,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Function {
    Abs,
    Sqrt,
    Floor,
    Min,
    Max,
    Sin,
    Cos,
}

/// The names of the functions, with the number of their arguments.
const FUNCTIONS: [(&str, Function, usize); 7] = [
    ("abs", Function::Abs, 1),
    ("sqrt", Function::Sqrt, 1),
    ("floor", Function::Floor, 1),
    ("min", Function::Min, 2),
    ("max", Function::Max, 2),
    ("sin", Function::Sin, 1),
    ("cos", Function::Cos, 1),
];

/// The name of the number of a particle in its frame, unless the file has such a column.
const INDEX: &str = "index";

/// The depth of brackets, beyond which an expression is refused: it is read recursively.
const DEEPEST: usize = 64;

impl ParticleFilter {
    /// Parses a condition, such as `z > 0 and (type == 2 or element == 'O')`.
    ///
    /// # Errors
    ///
    /// Returns the first place that is wrong.
    pub fn parse(text: &str) -> Result<Self, CloudError> {
        let mut parser =
            Parser { tokens: tokens(text)?, next: 0, end: text.len(), depth: 0, columns: Vec::new() };
        let root = parser.or()?;
        if let Some(token) = parser.tokens.get(parser.next) {
            let message = format!("`{}` is not expected here", &text[token.place.clone()]);
            return Err(error(token.place.clone(), message, "join two conditions by `and` or `or`"));
        }
        Ok(Self { root, columns: parser.columns })
    }

    /// Looks up the columns of a moment.
    pub(super) fn bind<'a>(&'a self, columns: &'a FrameColumns<'a>) -> Result<BoundFilter<'a>, CloudError> {
        let bind = |NamedColumn { name, place }: &'a NamedColumn| {
            if name == INDEX && !columns.has(name) {
                return Ok(BoundColumn::Index);
            }
            Ok(match columns.column(name, &CloudPart::Filter(place.clone()))? {
                ColumnValues::Numbers(numbers) => BoundColumn::Numbers(numbers),
                ColumnValues::Labels(labels, names) => BoundColumn::Labels(labels, names),
            })
        };
        let bound = BoundFilter {
            root: &self.root,
            columns: self.columns.iter().map(bind).collect::<Result<_, _>>()?,
        };
        bound.expect(&self.root, Kind::Condition)?;
        Ok(bound)
    }
}

/// A filter with the columns of a moment.
#[derive(Debug)]
pub(super) struct BoundFilter<'a> {
    root: &'a Expression,
    columns: Vec<BoundColumn<'a>>,
}

#[derive(Debug)]
enum BoundColumn<'a> {
    Index,
    Numbers(Cow<'a, [f64]>),
    Labels(&'a [u32], &'a [String]),
}

impl BoundFilter<'_> {
    /// Returns the rows, out of `count`, that meet the condition.
    pub(super) fn rows(&self, count: usize) -> Vec<u32> {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        (0..count).into_par_iter().filter(|row| self.holds(self.root, *row as usize)).collect()
    }

    /// Returns the kind of an expression, and checks its parts.
    fn kind(&self, node: &Expression) -> Result<Kind, CloudError> {
        match &node.kind {
            ExpressionKind::Number(_) => Ok(Kind::Number),
            ExpressionKind::Text(_) => Ok(Kind::Text),
            ExpressionKind::Column(column) => Ok(match &self.columns[*column] {
                BoundColumn::Labels(..) => Kind::Text,
                BoundColumn::Index | BoundColumn::Numbers(_) => Kind::Number,
            }),
            ExpressionKind::Call(_, arguments) => {
                arguments.iter().try_for_each(|argument| self.expect(argument, Kind::Number))?;
                Ok(Kind::Number)
            }
            ExpressionKind::Arithmetic(_, sides) => {
                sides.iter().try_for_each(|side| self.expect(side, Kind::Number))?;
                Ok(Kind::Number)
            }
            ExpressionKind::Negate(inner) => self.expect(inner, Kind::Number).map(|()| Kind::Number),
            ExpressionKind::Not(inner) => self.expect(inner, Kind::Condition).map(|()| Kind::Condition),
            ExpressionKind::And(sides) | ExpressionKind::Or(sides) => {
                sides.iter().try_for_each(|side| self.expect(side, Kind::Condition))?;
                Ok(Kind::Condition)
            }
            ExpressionKind::Compare(comparison, sides) => {
                let is_equality = matches!(comparison, Relation::Equal | Relation::Different);
                let kind = match self.kind(&sides[0])? {
                    Kind::Text if is_equality => Kind::Text,
                    _ => Kind::Number,
                };
                sides.iter().try_for_each(|side| self.expect(side, kind))?;
                Ok(Kind::Condition)
            }
        }
    }

    fn expect(&self, node: &Expression, expected: Kind) -> Result<(), CloudError> {
        let found = self.kind(node)?;
        if found == expected {
            return Ok(());
        }
        let word = |kind: Kind| match kind {
            Kind::Number => "a number",
            Kind::Text => "a text",
            Kind::Condition => "a condition",
        };
        let help = match (expected, found) {
            (Kind::Number, Kind::Text) => "texts can be compared with `==` and `!=` alone",
            (Kind::Text, _) => "write a text in single quotes, as 'O'",
            (Kind::Condition, _) => "compare it, as `z > 0`",
            _ => "write a number or a column of numbers",
        };
        let message = format!("this is {}, where {} is needed", word(found), word(expected));
        Err(error(node.place.clone(), message, help))
    }

    fn holds(&self, node: &Expression, row: usize) -> bool {
        match &node.kind {
            ExpressionKind::And(sides) => sides.iter().all(|side| self.holds(side, row)),
            ExpressionKind::Or(sides) => sides.iter().any(|side| self.holds(side, row)),
            ExpressionKind::Not(inner) => !self.holds(inner, row),
            ExpressionKind::Compare(comparison, sides) => {
                let texts = sides.each_ref().map(|side| self.text(side, row));
                if let [Some(one), Some(other)] = texts {
                    return (one == other) == (*comparison == Relation::Equal);
                }
                let [one, other] = sides.each_ref().map(|side| self.number(side, row));
                match comparison {
                    Relation::Equal => one == other,
                    Relation::Different => one != other,
                    Relation::Less => one < other,
                    Relation::LessOrEqual => one <= other,
                    Relation::Greater => one > other,
                    Relation::GreaterOrEqual => one >= other,
                }
            }
            _ => false,
        }
    }

    fn text<'b>(&'b self, node: &'b Expression, row: usize) -> Option<&'b str> {
        match &node.kind {
            ExpressionKind::Text(text) => Some(text),
            ExpressionKind::Column(column) => match &self.columns[*column] {
                BoundColumn::Labels(labels, names) => names.get(labels[row] as usize).map(String::as_str),
                BoundColumn::Index | BoundColumn::Numbers(_) => None,
            },
            _ => None,
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "rows are below 2^32")]
    fn number(&self, node: &Expression, row: usize) -> f64 {
        match &node.kind {
            ExpressionKind::Number(number) => *number,
            ExpressionKind::Column(column) => match &self.columns[*column] {
                BoundColumn::Numbers(numbers) => numbers[row],
                BoundColumn::Index => row as f64,
                BoundColumn::Labels(..) => f64::NAN,
            },
            ExpressionKind::Negate(inner) => -self.number(inner, row),
            ExpressionKind::Arithmetic(operation, sides) => {
                let [one, other] = sides.each_ref().map(|side| self.number(side, row));
                match operation {
                    Arithmetic::Add => one + other,
                    Arithmetic::Subtract => one - other,
                    Arithmetic::Multiply => one * other,
                    Arithmetic::Divide => one / other,
                    Arithmetic::Remainder => one.rem_euclid(other),
                    Arithmetic::Power => libm::pow(one, other),
                }
            }
            ExpressionKind::Call(function, arguments) => {
                let argument =
                    |index: usize| arguments.get(index).map_or(f64::NAN, |node| self.number(node, row));
                match function {
                    Function::Abs => argument(0).abs(),
                    Function::Sqrt => argument(0).sqrt(),
                    Function::Floor => argument(0).floor(),
                    Function::Min => argument(0).min(argument(1)),
                    Function::Max => argument(0).max(argument(1)),
                    Function::Sin => libm::sin(argument(0)),
                    Function::Cos => libm::cos(argument(0)),
                }
            }
            _ => f64::NAN,
        }
    }
}

struct Parser {
    tokens: Vec<Token>,
    next: usize,
    end: usize,
    depth: usize,
    columns: Vec<NamedColumn>,
}

impl Parser {
    /// Takes the next token if it is one of these signs.
    fn take(&mut self, signs: &[&str]) -> Option<(&'static str, Range<usize>)> {
        let Token { kind: TokenKind::Sign(sign), place } = self.tokens.get(self.next)? else { return None };
        let found = signs.contains(sign).then(|| (*sign, place.clone()))?;
        self.next += 1;
        Some(found)
    }

    /// Parses operands joined by signs, from left to right.
    fn joined(
        &mut self,
        signs: &[&str],
        operand: fn(&mut Self) -> Result<Expression, CloudError>,
        join: impl Fn(&str, Box<[Expression; 2]>) -> ExpressionKind,
    ) -> Result<Expression, CloudError> {
        let mut left = operand(self)?;
        let mut count = 0;
        while let Some((sign, place)) = self.take(signs) {
            count += 1;
            // Such chains become as deep as they are long, and are evaluated recursively.
            if count > 16 * DEEPEST {
                return Err(too_deep(place));
            }
            let right = operand(self)?;
            left = Expression { kind: join(sign, Box::new([left, right])), place };
        }
        Ok(left)
    }

    fn or(&mut self) -> Result<Expression, CloudError> {
        self.joined(&["||"], Self::and, |_, sides| ExpressionKind::Or(sides))
    }

    fn and(&mut self) -> Result<Expression, CloudError> {
        self.joined(&["&&"], Self::not, |_, sides| ExpressionKind::And(sides))
    }

    fn not(&mut self) -> Result<Expression, CloudError> {
        let Some((_, place)) = self.take(&["!"]) else { return self.compare() };
        self.nested(&place, |parser| {
            Ok(Expression { kind: ExpressionKind::Not(Box::new(parser.not()?)), place: place.clone() })
        })
    }

    fn compare(&mut self) -> Result<Expression, CloudError> {
        let left = self.sum()?;
        let Some((sign, place)) = self.take(&["==", "!=", "<", "<=", ">", ">="]) else { return Ok(left) };
        let comparison = match sign {
            "==" => Relation::Equal,
            "!=" => Relation::Different,
            "<" => Relation::Less,
            "<=" => Relation::LessOrEqual,
            ">" => Relation::Greater,
            _ => Relation::GreaterOrEqual,
        };
        let right = self.sum()?;
        if let Some((_, place)) = self.take(&["==", "!=", "<", "<=", ">", ">="]) {
            return Err(error(place, "a second comparison in a row", "write `0 < z and z < 2`"));
        }
        Ok(Expression { kind: ExpressionKind::Compare(comparison, Box::new([left, right])), place })
    }

    fn sum(&mut self) -> Result<Expression, CloudError> {
        self.joined(&["+", "-"], Self::product, |sign, sides| {
            let operation = if sign == "+" { Arithmetic::Add } else { Arithmetic::Subtract };
            ExpressionKind::Arithmetic(operation, sides)
        })
    }

    fn product(&mut self) -> Result<Expression, CloudError> {
        self.joined(&["*", "/", "%"], Self::sign, |sign, sides| {
            let operation = match sign {
                "*" => Arithmetic::Multiply,
                "/" => Arithmetic::Divide,
                _ => Arithmetic::Remainder,
            };
            ExpressionKind::Arithmetic(operation, sides)
        })
    }

    /// Parses a sign, which binds less than a power: `-x^2` is `-(x^2)`.
    fn sign(&mut self) -> Result<Expression, CloudError> {
        let Some((_, place)) = self.take(&["-"]) else { return self.power() };
        self.nested(&place, |parser| {
            Ok(Expression { kind: ExpressionKind::Negate(Box::new(parser.sign()?)), place: place.clone() })
        })
    }

    fn power(&mut self) -> Result<Expression, CloudError> {
        let base = self.operand()?;
        let Some((_, place)) = self.take(&["^"]) else { return Ok(base) };
        self.nested(&place, |parser| {
            let sides = Box::new([base, parser.sign()?]);
            Ok(Expression {
                kind: ExpressionKind::Arithmetic(Arithmetic::Power, sides),
                place: place.clone(),
            })
        })
    }

    fn nested(
        &mut self,
        place: &Range<usize>,
        parse: impl FnOnce(&mut Self) -> Result<Expression, CloudError>,
    ) -> Result<Expression, CloudError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(too_deep(place.clone()));
        }
        let node = parse(self)?;
        self.depth -= 1;
        Ok(node)
    }

    fn operand(&mut self) -> Result<Expression, CloudError> {
        const MISSING: &str = "write a number, a column, or a text in single quotes";
        let Some(Token { kind, place }) = self.tokens.get(self.next).cloned() else {
            let start = self.end.saturating_sub(1);
            return Err(error(start..self.end, "the condition ends too early", MISSING));
        };
        self.next += 1;
        let kind = match kind {
            TokenKind::Number(number) => ExpressionKind::Number(number),
            TokenKind::Text(text) => ExpressionKind::Text(text),
            TokenKind::Name(name) => return self.name(name, place),
            TokenKind::Sign("(") => {
                return self.nested(&place, |parser| {
                    let inside = parser.or()?;
                    parser.close(&place)?;
                    Ok(inside)
                });
            }
            TokenKind::Sign(sign) => {
                return Err(error(place, format!("`{sign}` is not expected here"), MISSING));
            }
        };
        Ok(Expression { kind, place })
    }

    fn close(&mut self, open: &Range<usize>) -> Result<(), CloudError> {
        let closed = self.take(&[")"]).map(|_| ());
        closed.ok_or_else(|| error(open.clone(), "the bracket is not closed", "write a `)` where it ends"))
    }

    /// Parses what begins with a name: a column or a call.
    fn name(&mut self, name: String, place: Range<usize>) -> Result<Expression, CloudError> {
        let Some((_, open)) = self.take(&["("]) else {
            let known = self.columns.iter().position(|column| column.name == name);
            let column = known.unwrap_or(self.columns.len());
            if known.is_none() {
                self.columns.push(NamedColumn { name, place: place.clone() });
            }
            return Ok(Expression { kind: ExpressionKind::Column(column), place });
        };
        let Some((_, function, count)) = FUNCTIONS.into_iter().find(|(known, ..)| *known == name) else {
            let known = FUNCTIONS.map(|(known, ..)| format!("`{known}`")).join(", ");
            return Err(error(
                place,
                format!("there is no function `{name}`"),
                format!("the functions are {known}"),
            ));
        };
        self.nested(&place.clone(), |parser| {
            let mut arguments = vec![parser.or()?];
            while parser.take(&[","]).is_some() {
                arguments.push(parser.or()?);
            }
            parser.close(&open)?;
            if arguments.len() != count {
                let message = format!("`{name}` of {} numbers", arguments.len());
                return Err(error(place.clone(), message, format!("write {count}, separated by commas")));
            }
            Ok(Expression { kind: ExpressionKind::Call(function, arguments), place })
        })
    }
}

fn too_deep(place: Range<usize>) -> CloudError {
    error(place, "the condition is too deeply nested", "write fewer brackets and signs")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{Column, Snapshot, Values};

    fn snapshot() -> Snapshot {
        let numbers = |name: &str, values: [f64; 4]| Column {
            name: name.to_owned(),
            values: Values::Numbers(values.to_vec()),
        };
        let names = vec!["O".to_owned(), "H".to_owned()];
        let elements = Values::Labels { labels: vec![0, 1, 1, 0], names };
        let columns = vec![
            numbers("x", [-2.0, -1.0, 0.0, 3.0]),
            numbers("speed.x", [1.0, 4.0, 9.0, f64::NAN]),
            Column { name: "element".to_owned(), values: elements },
        ];
        Snapshot { count: 4, columns, ..Snapshot::default() }
    }

    fn rows(text: &str) -> Result<Vec<u32>, CloudError> {
        let (filter, snapshot) = (ParticleFilter::parse(text)?, snapshot());
        let columns = FrameColumns::of(&snapshot);
        Ok(filter.bind(&columns)?.rows(4))
    }

    #[test]
    fn conditions_choose_rows() {
        for (text, expected) in [
            ("x < 0", &[0, 1][..]),
            ("x >= -1 and not x > 0", &[1, 2]),
            ("element == 'O' || x == 0", &[0, 2, 3]),
            ("element != 'O'", &[1, 2]),
            ("'H' == element", &[1, 2]),
            ("element == 'Xx'", &[]),
            ("index % 2 == 1", &[1, 3]),
            ("-x^2 < -3", &[0, 3]),
            ("2 + 3 * x == -1", &[1]),
            ("(2 + 3) * x == -5", &[1]),
            ("8 - 4 - 2 == 2 and x / 2 ^ -1 == 6", &[3]),
            ("sqrt(speed.x) == 2 or max(x, 2.5) == 3", &[1, 3]),
            ("speed.x < 1e3", &[0, 1, 2]),
            ("!(speed.x < 1E+3)", &[3]),
            ("`speed.x` == 9.", &[2]),
            ("x < 0 or x > 0 and x > 5", &[0, 1]),
        ] {
            assert_eq!(rows(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn mistakes_have_places() {
        for (text, place, message) in [
            ("z > 0", "z", "no column `z`"),
            ("x > 0 x", "x", "not expected"),
            ("x = 0", "=", "means nothing"),
            ("x > (1 + 2", "(", "not closed"),
            ("x > 'a", "'a", "not closed"),
            ("element > 3", "element", "a text, where a number"),
            ("element == 3", "3", "a number, where a text"),
            ("x + 1", "+", "a number, where a condition"),
            ("0 < x < 2", "<", "second comparison"),
            ("log(x) > 2", "log", "no function"),
            ("min(x) > 2", "min", "of 1 numbers"),
            ("x >", ">", "ends too early"),
            ("", "", "ends too early"),
            ("x > $", "$", "not part"),
            ("x > 1.2.3", "1.2.3", "not a number"),
            ("not x", "x", "a number, where a condition"),
        ] {
            let error = rows(text).unwrap_err();
            let CloudPart::Filter(found) = &error.part else { panic!("{text}") };
            assert_eq!(&text[found.clone()], place, "{text}");
            assert!(error.message.contains(message), "{text}: {error}");
        }
        for deep in ["(".repeat(100_000), "-".repeat(100_000), "!".repeat(100_000), "x^".repeat(100_000)] {
            assert!(rows(&deep).unwrap_err().message.contains("deep"));
        }
        assert!(rows(&format!("x{}", "+x".repeat(100_000))).unwrap_err().message.contains("deep"));
    }
}
