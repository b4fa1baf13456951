//! The grammar of expressions, parsed with winnow's Pratt parser straight into postfix form.
//!
//! `+ - * /` from the left, `^` from the right and before a sign (-x^2 is -(x^2)), parentheses, numbers, names,
//! `pi`, and the functions of [`FUNCTIONS`]. There is nothing else: no assignment, no loop, no call out.

use super::program::{Function, Operation};
use winnow::ascii::{digit0, digit1};
use winnow::combinator::{Infix, Prefix, alt, cut_err, expression, opt, preceded};
use winnow::error::{ErrMode, ParserError};
use winnow::prelude::*;
use winnow::stream::{Location, Stateful, Stream};
use winnow::token::{one_of, take_while};
use winnow::{LocatingSlice, ModalResult};

/// Longest expression, in bytes, and deepest nesting of parentheses: together they bound the parser's recursion.
pub(super) const MAX_LENGTH: usize = 500;
const MAX_NESTING: usize = 24;

/// Functions and how they are applied.
const FUNCTIONS: &[(&str, Operation)] = &[
    ("abs", Operation::Apply(Function::Abs)),
    ("sign", Operation::Apply(Function::Sign)),
    ("sqrt", Operation::Apply(Function::Sqrt)),
    ("exp", Operation::Apply(Function::Exp)),
    ("ln", Operation::Apply(Function::Ln)),
    ("sin", Operation::Apply(Function::Sin)),
    ("cos", Operation::Apply(Function::Cos)),
    ("tan", Operation::Apply(Function::Tan)),
    ("asin", Operation::Apply(Function::Asin)),
    ("acos", Operation::Apply(Function::Acos)),
    ("atan", Operation::Apply(Function::Atan)),
    ("tanh", Operation::Apply(Function::Tanh)),
    ("min", Operation::Smaller),
    ("max", Operation::Larger),
];

/// Binding powers.
const SUM: i64 = 10;
const PRODUCT: i64 = 20;
const SIGN: i64 = 30;
const POWER: i64 = 40;

/// Names that an expression may use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names<'a> {
    pub parameters: &'a [String],
    pub signals: &'a [&'static str],
}

/// What is wrong in an expression, and after how many characters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Problem {
    pub at: usize,
    pub what: String,
}

type Input<'a> = Stateful<LocatingSlice<&'a str>, State<'a>>;
type Outcome<O> = ModalResult<O, Problem>;

#[derive(Debug)]
struct State<'a> {
    names: Names<'a>,
    nesting: usize,
}

impl<'a> ParserError<Input<'a>> for Problem {
    type Inner = Self;

    fn from_input(input: &Input<'a>) -> Self {
        unexpected(input, "a number, a name, `(` or a sign")
    }

    fn into_inner(self) -> Result<Self::Inner, Self> {
        Ok(self)
    }
}

/// Whether a name is one of the language.
pub(super) fn is_taken(name: &str) -> bool {
    name == "pi" || FUNCTIONS.iter().any(|(function, _)| *function == name)
}

/// Parses a whole text.
pub(super) fn parse(text: &str, names: Names) -> Result<Vec<Operation>, Problem> {
    let mut input = Input { input: LocatingSlice::new(text), state: State { names, nesting: 0 } };
    let counted = |problem: Problem| Problem { at: text[..problem.at].chars().count(), ..problem };
    let end = |input: &Input| unexpected(input, "an operator (+ - * / ^) or the end");
    match sum(&mut input) {
        Ok(operations) if input.eof_offset() == 0 => Ok(operations),
        Ok(_) => Err(counted(end(&input))),
        Err(ErrMode::Backtrack(problem) | ErrMode::Cut(problem)) => Err(counted(problem)),
        Err(ErrMode::Incomplete(_)) => Err(counted(end(&input))),
    }
}

fn unexpected(input: &Input, expected: &str) -> Problem {
    let found = input.input.chars().next().map_or_else(|| "the end".to_owned(), |found| format!("`{found}`"));
    Problem { at: input.current_token_start(), what: format!("expected {expected}, found {found}") }
}

/// An error after which no other reading of the text is tried.
fn final_error<O>(at: usize, what: String) -> Outcome<O> {
    Err(ErrMode::Cut(Problem { at, what }))
}

fn sum(input: &mut Input) -> Outcome<Vec<Operation>> {
    expression(operand).prefix(sign).infix(operator).parse_next(input)
}

fn spaces(input: &mut Input) -> Outcome<()> {
    take_while(0.., [' ', '\t', '\n', '\r']).void().parse_next(input)
}

fn sign<'a>(input: &mut Input<'a>) -> Outcome<Prefix<Input<'a>, Vec<Operation>, ErrMode<Problem>>> {
    spaces(input)?;
    let minus = one_of(['-', '+']).parse_next(input)? == '-';
    Ok(if minus { Prefix(SIGN, |_, a| Ok(then(a, Operation::Negate))) } else { Prefix(SIGN, |_, a| Ok(a)) })
}

fn operator<'a>(input: &mut Input<'a>) -> Outcome<Infix<Input<'a>, Vec<Operation>, ErrMode<Problem>>> {
    let symbol = one_of(['+', '-', '*', '/', '^']).parse_next(input)?;
    Ok(match symbol {
        '+' => Infix::Left(SUM, |_, a, b| Ok(both(a, b, Operation::Add))),
        '-' => Infix::Left(SUM, |_, a, b| Ok(both(a, b, Operation::Subtract))),
        '*' => Infix::Left(PRODUCT, |_, a, b| Ok(both(a, b, Operation::Multiply))),
        '/' => Infix::Left(PRODUCT, |_, a, b| Ok(both(a, b, Operation::Divide))),
        _ => Infix::Right(POWER, |_, a, b| {
            Ok(match b.as_slice() {
                [Operation::Number(exponent)] => then(a, Operation::PowerBy(*exponent)),
                [Operation::Number(exponent), Operation::Negate] => then(a, Operation::PowerBy(-exponent)),
                _ => both(a, b, Operation::Power),
            })
        }),
    })
}

fn then(mut a: Vec<Operation>, operation: Operation) -> Vec<Operation> {
    a.push(operation);
    a
}

fn both(mut a: Vec<Operation>, b: Vec<Operation>, operation: Operation) -> Vec<Operation> {
    a.extend(b);
    then(a, operation)
}

fn operand(input: &mut Input) -> Outcome<Vec<Operation>> {
    spaces(input)?;
    let operations = alt((number, group, named)).parse_next(input)?;
    spaces(input)?;
    Ok(operations)
}

/// An unsigned decimal number: a sign before it is an operator, which binds less than `^`.
fn number(input: &mut Input) -> Outcome<Vec<Operation>> {
    let at = input.current_token_start();
    let mantissa = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let exponent = opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1));
    let text: &str = (mantissa, exponent).take().parse_next(input)?;
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(vec![Operation::Number(value)]),
        _ => final_error(at, format!("`{text}` is not a finite number")),
    }
}

fn group(input: &mut Input) -> Outcome<Vec<Operation>> {
    open(input)?;
    let operations = cut_err(sum).parse_next(input)?;
    close(input)?;
    Ok(operations)
}

fn open(input: &mut Input) -> Outcome<()> {
    let at = input.current_token_start();
    '('.parse_next(input)?;
    input.state.nesting += 1;
    if input.state.nesting > MAX_NESTING {
        return final_error(at, format!("parentheses are nested more than {MAX_NESTING} deep"));
    }
    Ok(())
}

fn close(input: &mut Input) -> Outcome<()> {
    if opt(')').parse_next(input)?.is_none() {
        return Err(ErrMode::Cut(unexpected(input, "an operator (+ - * / ^) or `)`")));
    }
    input.state.nesting -= 1;
    Ok(())
}

/// A parameter, a signal, `pi`, or a function with its arguments.
fn named(input: &mut Input) -> Outcome<Vec<Operation>> {
    let at = input.current_token_start();
    let first = one_of(|c: char| c.is_ascii_alphabetic() || c == '_');
    let rest = take_while(0.., |c: char| c.is_ascii_alphanumeric() || c == '_');
    let name: &str = (first, rest).take().parse_next(input)?;
    let called = winnow::combinator::peek(opt(preceded(spaces, '('))).parse_next(input)?.is_some();
    if called {
        return call(input, at, name);
    }
    let Names { parameters, signals } = input.state.names;
    if let Some(k) = parameters.iter().position(|parameter| parameter == name) {
        return Ok(vec![Operation::Parameter(k)]);
    }
    if let Some(k) = signals.iter().position(|signal| *signal == name) {
        return Ok(vec![Operation::Signal(k)]);
    }
    if name == "pi" {
        return Ok(vec![Operation::Number(std::f64::consts::PI)]);
    }
    let known =
        format!("the parameters {} and, for this target, the signals {}", parameters.join(", "), signals.join(", "));
    final_error(at, format!("unknown name `{name}`; known are {known}"))
}

fn call(input: &mut Input, at: usize, name: &str) -> Outcome<Vec<Operation>> {
    let Some((_, operation)) = FUNCTIONS.iter().find(|(function, _)| *function == name) else {
        let known = FUNCTIONS.iter().map(|(function, _)| *function).collect::<Vec<_>>().join(", ");
        return final_error(at, format!("unknown function `{name}`; known are {known}"));
    };
    spaces(input)?;
    open(input)?;
    let mut operations = cut_err(sum).parse_next(input)?;
    if matches!(operation, Operation::Smaller | Operation::Larger) {
        if opt(',').parse_next(input)?.is_none() {
            return Err(ErrMode::Cut(unexpected(input, &format!("`,` and the second argument of `{name}`"))));
        }
        operations.extend(cut_err(sum).parse_next(input)?);
    }
    close(input)?;
    Ok(then(operations, *operation))
}
