//! The accuracy tables as a file: what `etendue conformance --accuracy` prints, and what has drifted from it.

use crate::about::about;
use crate::kernels::{AccuracyRow, measure};
use etendue_core::backend::{Backend, BackendError, BackendInfo};
use etendue_core::kernel::Kernel;

/// Random items per kernel for the table.
pub const TABLE_COUNT: usize = crate::kernels::FULL_COUNT;

/// The accuracy of every kernel, for [`markdown`].
///
/// # Errors
/// The backend's own.
pub fn accuracy_table(backend: &dyn Backend) -> Result<Vec<AccuracyRow>, BackendError> {
    Kernel::ALL.iter().map(|k| measure(backend, *k, TABLE_COUNT)).collect()
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

/// The rows as a Markdown file: the same text for the same rows, no timings.
pub fn markdown(info: &BackendInfo, rows: &[AccuracyRow]) -> String {
    let mut out = String::from("# Accuracy\n\n");
    out.push_str(
        "Written by `etendue conformance --accuracy`; CI measures it again and fails when a number has drifted. Timings \
         are in [docs/error-against-speed.md](docs/error-against-speed.md).\n\n\
         Each kernel is compared with an independent second implementation (the truth: f64, exact integers or a closed \
         form), on hard inputs and seeded random ones, and with the scalar reference in core (the peer: the only \
         difference a right backend may have is its adapter's rounding). `core::math` has a table of its own, from dense \
         sweeps over all arguments: `etendue_core::math::ACCURACY`.\n\n\
         Unit `ulp`: f32 spacing at the truth; `u`: 2^-24 of the scale that the input's rounding sets (1 for \
         directions); `bits`: nothing may differ. Undecided: items whose answer hangs on a comparison within rounding; \
         they are held to the peer alone.\n\n",
    );
    out.push_str(&format!("## Kernels of `{}`\n\n", info.name));
    out.push_str(
        "| kernel | worst | mean | unit | allowed | worst to peer | mean to peer | equal bits | cases | undecided | \
         domain | source | why not zero |\n",
    );
    out.push_str("|---|---:|---:|---|---:|---:|---:|---:|---:|---:|---|---|---|\n");
    for r in rows {
        let (t, a) = (&r.tolerance, about(r.kernel));
        out.push_str(&format!(
            "| `{}` | {} | {} | {} | {} | {} | {} | {:.4} % | {} | {} | {} | {} | {} |\n",
            r.kernel.name(),
            short(r.worst),
            short(r.mean),
            t.unit,
            short(t.truth.limit),
            short(r.peer_worst),
            short(r.peer_mean),
            100.0 * r.equal_share(),
            r.cases,
            r.undecided,
            a.domain,
            a.source,
            t.truth.reason,
        ));
    }
    out
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
