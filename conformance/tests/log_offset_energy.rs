//! What log/offset codes do to the energy of an operator: form factors of an empty box, whose rows sum to one.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_conformance::truth::empty_box::EmptyBox;
use etendue_core::codec::log_offset::{LogOffset, Quantiser};

struct Matrix {
    n: usize,
    values: Vec<f32>,
}

impl Matrix {
    fn of_box(cells: usize) -> Self {
        let b = EmptyBox::new([1.0, 1.5, 0.7], cells);
        Self { n: b.len(), values: b.form_factors.iter().map(|f| f.max(0.0) as f32).collect() }
    }
}

impl Matrix {
    fn max(&self) -> f32 {
        self.values.iter().fold(0.0_f32, |a, b| a.max(*b))
    }
}

/// Sums of rows after a round trip, less one: mean and root mean square, and the relative L2 error of the entries.
#[derive(Debug)]
struct Errors {
    bias: f64,
    rows: f64,
    entries: f64,
}

fn errors(m: &Matrix, q: &LogOffset) -> Errors {
    let (mut bias, mut square, mut difference, mut total) = (0.0, 0.0, 0.0, 0.0);
    for row in m.values.chunks_exact(m.n) {
        let (mut sum, mut before) = (0.0, 0.0);
        for x in row {
            let y = f64::from(q.decode(q.encode(*x)));
            let x = f64::from(*x);
            sum += y;
            before += x;
            difference += (y - x).powi(2);
            total += x * x;
        }
        bias += sum - before;
        square += (sum - before).powi(2);
    }
    let n = m.n as f64;
    Errors { bias: bias / n, rows: (square / n).sqrt(), entries: (difference / total).sqrt() }
}

fn compare(cells: usize) -> [Errors; 8] {
    let m = Matrix::of_box(cells);
    let (published, fitted) = (LogOffset::published(m.max()).unwrap(), LogOffset::fitted(&m.values).unwrap());
    let losing = LogOffset::fitted_losing(&m.values, 1e-4).unwrap();
    println!("n = {}: fitted width {}, losing 1e-4 {}", m.n, fitted.width(), losing.width());
    let list = [
        ("published, plain", published.clone()),
        ("published, mean", published.clone().mean_preserving()),
        ("published, energy", published.clone().energy_preserving()),
        ("published, measured", published.measured(&m.values)),
        ("fitted, plain", fitted.clone()),
        ("fitted, energy", fitted.clone().energy_preserving()),
        ("fitted, measured", fitted.measured(&m.values)),
        ("losing 1e-4, measured", losing.measured(&m.values)),
    ];
    list.map(|(name, q)| {
        let e = errors(&m, &q);
        println!("{name:24} row bias {:+.2e}  row rms {:.2e}  entries {:.3e}", e.bias, e.rows, e.entries);
        e
    })
}

#[test]
fn measured_decodes_keep_the_energy_and_fits_shrink_the_error() {
    let [plain, mean, energy, measured, fitted, fitted_energy, fitted_measured, losing] = compare(8);
    // The sum is exact but for roundings of 256 numbers.
    assert!(measured.bias.abs() <= 1e-7 && fitted_measured.bias.abs() <= 1e-7, "{measured:?}");
    assert!(losing.bias <= 0.0 && losing.bias >= -1.0001e-4, "{losing:?}");
    // No decode of the same codes has smaller squares.
    for other in [&plain, &mean, &energy] {
        assert!(measured.entries <= other.entries);
    }
    // Less than half the width: about half the error.
    assert!(fitted.entries <= 0.65 * plain.entries && fitted_energy.entries <= 0.65 * energy.entries);
    // Entries: even in the logarithm, h / sqrt 3 relative.
    let h: f64 = 25.0 / 510.0;
    assert!((plain.entries / (h / 3.0_f64.sqrt()) - 1.0).abs() <= 0.2, "{plain:?}");
}

/// Averaged over where the cells lie, decoded over true is e^t with t even in \[-h, h\] whatever the numbers: sinh(h)/h.
#[test]
fn on_average_over_the_cells_only_the_energy_preserving_decode_is_unbiased() {
    let m = Matrix::of_box(8);
    let truth: f64 = m.values.iter().map(|x| f64::from(*x)).sum();
    let width = 25.0_f32;
    let h = f64::from(width) / 510.0;
    let excess = h.sinh() / h - 1.0;
    let mut bias = [0.0; 3];
    let shifts = 64;
    for i in 0..shifts {
        // One whole step, from where no entry has code 255.
        let shift = h * (1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(shifts));
        let plain = LogOffset::try_new(width, (f64::from(m.max()) * shift.exp()) as f32).unwrap();
        let mut counts = [0_u32; 256];
        m.values.iter().for_each(|x| counts[usize::from(plain.encode(*x))] += 1);
        let decodings = [plain.clone(), plain.clone().mean_preserving(), plain.energy_preserving()];
        for (bias, q) in bias.iter_mut().zip(decodings) {
            let sum: f64 = counts.iter().zip(q.values()).map(|(n, v)| f64::from(*n) * f64::from(*v)).sum();
            *bias += (sum / truth - 1.0) / f64::from(shifts);
        }
    }
    println!("bias of plain, mean, energy: {bias:?}; sinh(h)/h - 1 = {excess:e}");
    for (bias, expected) in bias.into_iter().zip([excess, 2.0 * excess, 0.0]) {
        assert!((bias - expected).abs() <= 0.05 * excess, "{bias:e} is not {expected:e}");
    }
}

#[test]
#[ignore = "2 s, prints n = 1536: cargo test -p etendue-conformance --test log_offset_energy -- --ignored --nocapture"]
fn errors_of_a_larger_box() {
    let [plain, _, _, measured, ..] = compare(16);
    assert!(measured.bias.abs() <= 1e-7 && measured.entries <= plain.entries);
}
