//! The errors that the functions state, as data.

/// What one function promises over one domain; measured by `tests/math_accuracy.rs`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// The function's name in [`super`].
    pub name: &'static str,
    /// Where the statement holds.
    pub domain: &'static str,
    /// No error found in the domain is larger \[ulp\]: every 61st float (70 million pairs for two arguments), plus a margin
    /// of about 5 % for the rest.
    pub worst_ulp: f64,
    /// The mean error over the domain's floats, or over the test's sample of pairs, is not larger \[ulp\].
    pub mean_ulp: f64,
}

const fn row(name: &'static str, domain: &'static str, worst_ulp: f64, mean_ulp: f64) -> Accuracy {
    Accuracy { name, domain, worst_ulp, mean_ulp }
}

/// The stated error of every function that is not exact.
pub const ACCURACY: &[Accuracy] = &[
    row("ln", "x > 0", 0.86, 0.26),
    row("log2", "x > 0", 0.84, 0.26),
    row("exp", "every x (beyond +-104 infinity and 0)", 0.93, 0.07),
    row("exp2", "every x (beyond +-151 infinity and 0)", 0.90, 0.07),
    row("pow", "0 <= x <= 1, 0 <= y <= 1e5", 0.95, 0.18),
    row("pow", "x > 0, any y", 1.00, 0.25),
    row("sin_cos.0", "|x| <= 3216", 0.92, 0.05),
    row("sin_cos.1", "|x| <= 3216", 0.92, 0.05),
    row("tan", "|x| <= 3216", 2.50, 0.075),
    row("asin", "-1 <= x <= 1", 1.15, 0.03),
    row("acos", "-1 <= x <= 1", 1.15, 0.35),
    row("atan", "finite x", 1.35, 0.19),
    row("atan2", "finite x, y", 1.50, 0.29),
    row("cbrt", "finite x", 0.53, 0.26),
];

/// The row of a function, if it has one.
#[must_use]
pub fn accuracy(name: &str) -> Option<&'static Accuracy> {
    ACCURACY.iter().find(|row| row.name == name)
}
