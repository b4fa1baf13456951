//! A parsed expression in postfix form, evaluated over any scalar without allocating.

use num_dual::DualNum;

/// Most values that an expression may hold at once while it is evaluated.
pub(super) const MAX_STACK: usize = 32;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    Abs,
    Sign,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Tanh,
}

/// One operation on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Operation {
    Number(f64),
    Parameter(usize),
    Signal(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    /// The exponent is a number of the text.
    PowerBy(f64),
    Power,
    Apply(Function),
    Smaller,
    Larger,
}

impl Operation {
    /// How many values it takes from the stack; it puts one back.
    fn arguments(self) -> usize {
        match self {
            Self::Number(_) | Self::Parameter(_) | Self::Signal(_) => 0,
            Self::Negate | Self::PowerBy(_) | Self::Apply(_) => 1,
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide => 2,
            Self::Power | Self::Smaller | Self::Larger => 2,
        }
    }
}

/// An expression that is known to fit the stack.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Program(Box<[Operation]>);

impl Program {
    /// `None` where the operations need more than [`MAX_STACK`] values, or do not leave exactly one.
    pub fn new(operations: Vec<Operation>) -> Option<Self> {
        let mut height = 0_usize;
        for operation in &operations {
            height = height.checked_sub(operation.arguments())? + 1;
            if height > MAX_STACK {
                return None;
            }
        }
        (height == 1).then(|| Self(operations.into()))
    }

    /// Whether the expression has no kink, at which its derivative is one-sided.
    pub fn is_smooth(&self) -> bool {
        let kinked = |operation: &Operation| {
            matches!(
                operation,
                Operation::Smaller | Operation::Larger | Operation::Apply(Function::Abs | Function::Sign)
            )
        };
        !self.0.iter().any(kinked)
    }

    /// Whether the `k`-th parameter appears.
    pub fn uses_parameter(&self, k: usize) -> bool {
        self.0.contains(&Operation::Parameter(k))
    }

    /// The value of the expression.
    pub fn evaluate<N: Number>(&self, parameter: impl Fn(usize) -> N, signal: impl Fn(usize) -> N) -> N {
        let mut stack = [N::from(0.0); MAX_STACK];
        let mut height = 0; // `new` has shown that it stays within 1 ..= MAX_STACK.
        for &operation in &self.0 {
            height = height + 1 - operation.arguments();
            let (a, b) = (stack[height - 1], stack[height % MAX_STACK]);
            stack[height - 1] = match operation {
                Operation::Number(number) => N::from(number),
                Operation::Parameter(k) => parameter(k),
                Operation::Signal(k) => signal(k),
                Operation::Negate => -a,
                Operation::Add => a + b,
                Operation::Subtract => a - b,
                Operation::Multiply => a * b,
                Operation::Divide => a / b,
                Operation::PowerBy(exponent) => power_by(a, exponent),
                Operation::Power => power(a, b),
                Operation::Apply(function) => function.of(a),
                Operation::Smaller => {
                    if b.re() < a.re() || b.re().is_nan() {
                        b
                    } else {
                        a
                    }
                }
                Operation::Larger => {
                    if b.re() > a.re() || b.re().is_nan() {
                        b
                    } else {
                        a
                    }
                }
            };
        }
        stack[0]
    }
}

/// What an expression can be evaluated over: `f64`, or dual numbers over it, nested or not.
pub(super) trait Number: DualNum<Primitive = f64> + Copy {}

impl<N: DualNum<Primitive = f64> + Copy> Number for N {}

impl Function {
    fn of<N: Number>(self, x: N) -> N {
        match self {
            Self::Abs => {
                if x.re() < 0.0 {
                    -x
                } else {
                    x
                }
            }
            Self::Sign if x.re().is_nan() => x,
            Self::Sign if x.re() == 0.0 => N::from(0.0),
            Self::Sign => N::from(x.re().signum()),
            // The derivative at 0 is infinite; it is left out.
            Self::Sqrt if x.re() == 0.0 => N::from(0.0),
            Self::Sqrt => x.sqrt(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            // As at 0 of the square root.
            Self::Asin if x.re().abs() == 1.0 => N::from(x.re().asin()),
            Self::Acos if x.re().abs() == 1.0 => N::from(x.re().acos()),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Tanh => tanh(x),
        }
    }
}

/// (1 - e^(-2 |x|))/(1 + e^(-2 |x|)) sgn x: as sinh/cosh its derivative would overflow from |x| = 355 on.
fn tanh<N: Number>(x: N) -> N {
    let negative = x.re() < 0.0;
    let decay = (if negative { x } else { -x } * 2.0).exp_m1();
    let size = -decay / (decay + 2.0);
    if negative { -size } else { size }
}

/// Power to a number of the text: whole numbers take any base, others a base that is not negative.
fn power_by<N: Number>(base: N, exponent: f64) -> N {
    if exponent.fract() == 0.0 && exponent.abs() <= f64::from(i16::MAX) {
        return base.powi(exponent as i32);
    }
    if base.re() == 0.0 { at_zero(base, exponent) } else { base.powf(exponent) }
}

/// Power to an exponent that may vary, for a base that is not negative.
fn power<N: Number>(base: N, exponent: N) -> N {
    if base.re() < 0.0 {
        N::from(f64::NAN)
    } else if base.re() == 0.0 {
        at_zero(base, exponent.re())
    } else {
        base.powd(exponent)
    }
}

/// 0 to a power. The derivative, infinite for exponents below 1, is left out there.
fn at_zero<N: Number>(base: N, exponent: f64) -> N {
    if exponent == 1.0 { base } else { N::from(0.0_f64.powf(exponent)) }
}
