//! The accuracy tables as a file: what `etendue conformance --accuracy` prints, and what has drifted from it.

use crate::about::about;
use crate::kernels::{AccuracyRow, measure};
use etendue_core::backend::{Arithmetic, Backend, BackendError, BackendInfo};
use etendue_core::kernel::Kernel;

/// Random items per kernel for the table.
pub const TABLE_COUNT: usize = crate::kernels::FULL_COUNT;

/// The accuracy of a backend's kernels.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyReport {
    /// Whose they are.
    pub info: BackendInfo,
    /// How its operations round.
    pub arithmetic: Arithmetic,
    /// One for each kernel that it has.
    pub rows: Vec<AccuracyRow>,
    /// Names of those that it has not.
    pub missing: Vec<&'static str>,
}

/// Measures every kernel of a backend with so many random items ([`TABLE_COUNT`]), for [`markdown`].
///
/// # Errors
/// The backend's own; a kernel that it does not support is none.
pub fn accuracy_report(backend: &dyn Backend, count: usize) -> Result<AccuracyReport, BackendError> {
    let mut report = AccuracyReport {
        info: backend.info(),
        arithmetic: backend.arithmetic(),
        rows: Vec::new(),
        missing: Vec::new(),
    };
    for kernel in Kernel::ALL {
        match measure(backend, *kernel, count) {
            Ok(row) => report.rows.push(row),
            Err(BackendError::Unsupported { .. }) => report.missing.push(kernel.name()),
            Err(e) => return Err(e),
        }
    }
    Ok(report)
}

/// Three significant digits, without trailing noise.
fn short(x: f64) -> String {
    if x == 0.0 {
        "0".to_string()
    } else if !x.is_finite() || x >= 1000.0 {
        format!("{x:.3e}")
    } else if x >= 1.0 {
        format!("{x:.2}")
    } else {
        format!("{x:.3}")
    }
}

const HEAD: &str = "# Accuracy

Written by `etendue conformance --accuracy`; CI measures it again and fails when a number has drifted. Timings \
are in [docs/error-against-speed.md](docs/error-against-speed.md).

Each kernel is compared with an independent second implementation (the truth: f64, exact integers or a closed \
form), on hard inputs and seeded random ones, and with the scalar reference in core (the peer: the only \
difference a right backend may have is its adapter's rounding). `core::math` has a table of its own, from dense \
sweeps over all arguments: `etendue_core::math::ACCURACY`.

Unit `ulp`: f32 spacing at the truth; `u`: 2^-24 of the scale that the input's rounding sets (1 for \
directions); `bits`: nothing may differ. Undecided: items whose answer hangs on a comparison within rounding; \
they are held to the peer alone. Flushed: items in which an adapter without subnormal numbers lost one; they are held to an absolute \
bound, or to nothing where such a number was among their inputs.

";

/// Reports as a Markdown file: the same text for the same rows, no timings.
pub fn markdown(reports: &[AccuracyReport]) -> String {
    let mut out = String::from(HEAD);
    for (i, report) in reports.iter().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        section(report, &mut out);
    }
    out
}

fn section(report: &AccuracyReport, out: &mut String) {
    let name = report.info.name;
    // The CPU's numbers are the same on every machine, with any number of threads: its heading is too. Domains and sources are
    // stated once, with them.
    let first = report.arithmetic == Arithmetic::Ieee && name != "wgpu";
    if first {
        out.push_str(&format!("## Kernels of `{name}`\n\n"));
    } else {
        let kind = report.arithmetic.describe();
        out.push_str(&format!(
            "## Kernels of `{name}` on {}\n\nArithmetic: {kind}.\n\n",
            report.info.adapter
        ));
    }
    out.push_str(
        "| kernel | worst | mean | unit | allowed | worst to peer | mean to peer | allowed to peer | equal bits | cases | \
         undecided | flushed | ",
    );
    out.push_str(if first { "domain | source | why not zero |\n" } else { "why not zero |\n" });
    out.push_str("|---|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    out.push_str(if first { "---|---|---|\n" } else { "---|\n" });
    for r in &report.rows {
        out.push_str(&format!(
            "| `{}` | {} | {} | {} | {} | {} | {} | {} | {:.4} % | {} | {} | {} | ",
            r.kernel.name(),
            short(r.worst),
            short(r.mean),
            r.tolerance.unit,
            short(r.truth_limit()),
            short(r.peer_worst),
            short(r.peer_mean),
            short(r.peer_limit()),
            100.0 * r.equal_share(),
            r.cases,
            r.undecided,
            r.flushed,
        ));
        if first {
            let a = about(r.kernel);
            out.push_str(&format!("{} | {} | ", a.domain, a.source));
        }
        out.push_str(&format!("{} |\n", reasons(r)));
    }
    if !report.missing.is_empty() {
        out.push_str(&format!("\nNot there: {}.\n", report.missing.join(", ")));
    }
}

/// Why the bounds that held are not zero.
fn reasons(row: &AccuracyRow) -> String {
    let t = &row.tolerance;
    let mut list = vec![t.truth.reason];
    if row.peer_limit() > 0.0 {
        list.push(t.peer.reason);
    }
    if row.flushed > 0 {
        list.push(t.flushed.reason);
    }
    list.join("; ")
}

/// What differs between two texts of [`markdown`], line by line; empty where nothing does.
///
/// Numbers may differ by one unit of their last printed digit: the truths call the platform's f64 functions, and their last
/// bit differs between systems. Everything else must be equal to the letter.
pub fn drift(stated: &str, measured: &str) -> Vec<String> {
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let (stated, measured) = (lines(stated), lines(measured));
    let mut found = Vec::new();
    for i in 0..stated.len().max(measured.len()) {
        match (stated.get(i), measured.get(i)) {
            (Some(a), Some(b)) if same_line(a, b) => {}
            (a, b) => found.push(format!(
                "line {}: stated `{}`, measured `{}`",
                i + 1,
                a.map_or("nothing", String::as_str),
                b.map_or("nothing", String::as_str)
            )),
        }
    }
    found
}

fn same_line(a: &str, b: &str) -> bool {
    let (a, b): (Vec<_>, Vec<_>) = (a.split(" | ").collect(), b.split(" | ").collect());
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a == b || same_number(a, b))
}

/// Decimals that differ by at most one in the last place; integers must be equal.
fn same_number(a: &str, b: &str) -> bool {
    let decimals = |s: &str| s.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(x), Ok(y)) if decimals(a) > 0 && decimals(a) == decimals(b) => {
            (x - y).abs() <= 1.01 * 10.0_f64.powi(-decimals(a))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_sees_a_changed_error_and_forgives_a_last_digit() {
        let row =
            |worst: &str, cases: &str| format!("# T\n| `a::b` | {worst} | 0.250 | ulp | {cases} | x |\n");
        assert!(drift(&row("0.766", "100"), &row("0.766", "100")).is_empty());
        assert!(drift(&row("0.766", "100"), &row("0.767", "100")).is_empty());
        assert_eq!(drift(&row("0.766", "100"), &row("0.769", "100")).len(), 1);
        assert_eq!(drift(&row("0.766", "100"), &row("0.766", "101")).len(), 1);
        assert_eq!(drift(&row("0.766", "100"), &row("0.76", "100")).len(), 1);
        assert_eq!(drift(&row("0.766", "100"), "# T\n").len(), 1);
        assert_eq!(drift("# T\n", &row("NaN", "100")).len(), 1);
    }
}
