//! Contenders for `log_offset`: one byte (or two) per entry of an operator, there and back.
//!
//! The operator is the form factors of an empty box, 1 m by 1.5 m by 0.7 m, 16 x 16 patches to a face (n = 1536). The error is
//! that of the irradiance that the decoded matrix gives: the relative L2 norm over the patches by area, root mean square
//! over twelve lights, each face lit evenly and the middle patch of each face alone. The work is 64 rows, spread over the box.
#![allow(clippy::disallowed_methods, reason = "errors in f64; rivals as anyone would write them")]

use crate::figure::{Contender, Contest, Curves, Series};
use etendue_conformance::truth::empty_box::EmptyBox;
use etendue_core::codec::log_offset::{ByFormula, LogOffset, PUBLISHED_WIDTH, Quantiser};
use half::{bf16, f16};
use std::hint::black_box;
use std::rc::Rc;

const CELLS: usize = 16;
/// Every 24th row.
const ROW_STEP: usize = 24;

struct Operator {
    n: usize,
    values: Vec<f32>,
    areas: Vec<f64>,
    /// Irradiance of every light, exact.
    irradiance: Vec<Vec<f64>>,
}

impl Operator {
    fn of_box() -> Self {
        let b = EmptyBox::new([1.0, 1.5, 0.7], CELLS);
        let values: Vec<f32> = b.form_factors.iter().map(|f| f.max(0.0) as f32).collect();
        let mut this = Self { n: b.len(), irradiance: Vec::new(), areas: b.areas, values };
        this.irradiance = this.relit(&this.values);
        this
    }

    fn max(&self) -> f32 {
        self.values.iter().fold(0.0, |a, b| if *b > a { *b } else { a })
    }

    /// Irradiance of the lights by a matrix.
    fn relit(&self, matrix: &[f32]) -> Vec<Vec<f64>> {
        let face = CELLS * CELLS;
        let middle = face / 2 + CELLS / 2;
        let sum = |row: &[f32]| row.iter().map(|x| f64::from(*x)).sum::<f64>();
        let rows = || matrix.chunks_exact(self.n);
        (0..6)
            .flat_map(|f| {
                let (from, alone) = (f * face, f * face + middle);
                let lit = rows().map(|row| sum(&row[from..from + face])).collect();
                [lit, rows().map(|row| f64::from(row[alone])).collect()]
            })
            .collect()
    }

    /// The error of a matrix as the module defines it.
    fn error(&self, decoded: &[f32]) -> f64 {
        let of_light = |(now, truth): (&Vec<f64>, &Vec<f64>)| {
            let (mut difference, mut total) = (0.0, 0.0);
            for ((a, b), area) in now.iter().zip(truth).zip(&self.areas) {
                difference += area * (a - b).powi(2);
                total += area * b * b;
            }
            difference / total
        };
        let relit = self.relit(decoded);
        let lights = relit.len() as f64;
        (relit.iter().zip(&self.irradiance).map(of_light).sum::<f64>() / lights).sqrt()
    }

    fn rows(&self) -> Vec<f32> {
        self.values.chunks_exact(self.n).step_by(ROW_STEP).flatten().copied().collect()
    }
}

/// An 8-bit float without sign and subnormals: 0, then 255 numbers with `mantissa` bits after the leading one, the
/// largest scaled to `max`.
#[derive(Clone, Copy)]
struct MiniFloat {
    shift: u32,
    offset: u32,
    scale: f32,
    inverse: f32,
}

impl MiniFloat {
    fn new(mantissa: u32, max: f32) -> Self {
        // Code 255 is the largest number below 2.
        let top = f32::from_bits(0x4000_0000 - (1 << (23 - mantissa)));
        let shift = 23 - mantissa;
        Self { shift, offset: (top.to_bits() >> shift) - 255, scale: top / max, inverse: max / top }
    }

    #[inline(always)]
    fn encode(self, x: f32) -> u8 {
        let bits = (x * self.scale).to_bits();
        let even = (bits >> self.shift) & 1;
        let rounded = (bits + (1 << (self.shift - 1)) - 1 + even) >> self.shift;
        rounded.saturating_sub(self.offset).min(255) as u8
    }

    #[inline(always)]
    fn decode(self, code: u8) -> f32 {
        let x = f32::from_bits((u32::from(code) + self.offset) << self.shift) * self.inverse;
        if code == 0 { 0.0 } else { x }
    }
}

/// A loop over slices.
type Loop<A, B> = Rc<dyn Fn(&[A], &mut [B])>;

/// A way there and back.
struct Way<C> {
    name: &'static str,
    ours: bool,
    encode: Loop<f32, C>,
    decode: Loop<C, f32>,
}

impl<C: Copy + Default + 'static> Way<C> {
    fn new(
        name: &'static str,
        ours: bool,
        encode: impl Fn(&[f32], &mut [C]) + 'static,
        decode: impl Fn(&[C], &mut [f32]) + 'static,
    ) -> Self {
        Self { name, ours, encode: Rc::new(encode), decode: Rc::new(decode) }
    }

    /// A rival: one number at a time, in loops that the compiler widens as it can.
    fn each(
        name: &'static str,
        encode: impl Fn(f32) -> C + 'static,
        decode: impl Fn(C) -> f32 + 'static,
    ) -> Self {
        Self::new(
            name,
            false,
            move |x, c| x.iter().zip(c).for_each(|(x, c)| *c = encode(*x)),
            move |c, x| c.iter().zip(x).for_each(|(c, x)| *x = decode(*c)),
        )
    }

    /// The contender of the way there and that of the way back.
    fn contenders(self, op: &Operator, rows: &[f32]) -> [Contender; 2] {
        let Self { name, ours, encode, decode } = self;
        let mut codes = vec![C::default(); op.values.len()];
        let mut back = vec![0.0; op.values.len()];
        encode(&op.values, &mut codes);
        decode(&codes, &mut back);
        let error = op.error(&back);
        let (rows, mut codes) = (rows.to_vec(), vec![C::default(); rows.len()]);
        encode(&rows, &mut codes);
        let (codes_in, mut back) = (codes.clone(), vec![0.0; rows.len()]);
        let there = Box::new(move || {
            encode(black_box(&rows), &mut codes);
            black_box(&mut codes);
        });
        let and_back = Box::new(move || {
            decode(black_box(&codes_in), &mut back);
            black_box(&mut back);
        });
        let name = name.to_string();
        [
            Contender { name: name.clone(), ours, error, work: there },
            Contender { name, ours, error, work: and_back },
        ]
    }
}

/// A map through core's own loops.
fn portable(name: &'static str, map: impl Quantiser + Clone + 'static) -> Way<u8> {
    let other = map.clone();
    Way::new(
        name,
        true,
        move |x, c| map.encode_slice(x, c).expect("equally long"),
        move |c, x| other.decode_slice(c, x).expect("equally long"),
    )
}

/// A map through the widest registers.
fn widest(name: &'static str, map: LogOffset) -> Way<u8> {
    let other = map.clone();
    Way::new(
        name,
        true,
        move |x, c| etendue_cpu::log_offset::encode(&map, x, c).expect("equally long"),
        move |c, x| etendue_cpu::log_offset::decode(&other, c, x).expect("equally long"),
    )
}

/// The published formula with the platform's own logarithm, as it is usually written.
fn std_formula(max: f32) -> Way<u8> {
    Way::each(
        "published formula, std ln and exp",
        move |x: f32| {
            let t = ((x / max).ln() + PUBLISHED_WIDTH) * (255.0 / PUBLISHED_WIDTH);
            (t + 0.5).max(0.0) as u8
        },
        move |c: u8| {
            let x = max * (f32::from(c) / 255.0 * PUBLISHED_WIDTH - PUBLISHED_WIDTH).exp();
            if c == 0 { 0.0 } else { x }
        },
    )
}

fn ways(op: &Operator) -> Vec<[Contender; 2]> {
    let max = op.max();
    let rows = op.rows();
    let published = LogOffset::published(max).expect("form factors are positive and finite");
    let formula = ByFormula::try_new(PUBLISHED_WIDTH, max).expect("as the map");
    let fitted = LogOffset::fitted(&op.values).expect("form factors are positive and finite");
    let losing = LogOffset::fitted_losing(&op.values, 1e-4).expect("form factors are positive and finite");
    let searched = {
        let (map, other) = (published.clone(), published.clone());
        Way::new(
            "published, binary search",
            true,
            move |x: &[f32], c: &mut [u8]| {
                x.iter().zip(c).for_each(|(x, c)| *c = map.encode_by_search(*x));
            },
            move |c: &[u8], x: &mut [f32]| other.decode_slice(c, x).expect("equally long"),
        )
    };
    let bytes = [
        portable("published formula in f32", formula),
        searched,
        portable("published, portable", published.clone()),
        widest("published, AVX2", published.clone()),
        widest("published, mean-preserving, AVX2", published.clone().mean_preserving()),
        widest("published, energy-preserving, AVX2", published.clone().energy_preserving()),
        widest("published, measured, AVX2", published.measured(&op.values)),
        widest("fitted, AVX2", fitted.clone()),
        widest("fitted, measured, AVX2", fitted.measured(&op.values)),
        widest("fitted losing 1e-4, measured, AVX2", losing.measured(&op.values)),
        std_formula(max),
        Way::each(
            "linear, 8 bits",
            move |x| (x * (255.0 / max) + 0.5) as u8,
            move |c: u8| f32::from(c) * (max / 255.0),
        ),
        Way::each(
            "square root, 8 bits",
            move |x| ((x * (1.0 / max)).sqrt() * 255.0 + 0.5) as u8,
            move |c: u8| {
                let r = f32::from(c) * (1.0 / 255.0);
                r * r * max
            },
        ),
        mini_float("float of 5 + 3 bits", 3, max),
        mini_float("float of 4 + 4 bits", 4, max),
    ];
    let words = [
        Way::each("f16, 16 bits (half 2.7)", |x| f16::from_f32(x).to_bits(), |c| f16::from_bits(c).to_f32()),
        Way::each(
            "bf16, 16 bits (half 2.7)",
            |x| bf16::from_f32(x).to_bits(),
            |c| bf16::from_bits(c).to_f32(),
        ),
    ];
    let of_words = words.map(|w: Way<u16>| w.contenders(op, &rows));
    bytes.map(|w| w.contenders(op, &rows)).into_iter().chain(of_words).collect()
}

fn mini_float(name: &'static str, mantissa: u32, max: f32) -> Way<u8> {
    let f = MiniFloat::new(mantissa, max);
    Way::each(name, move |x| f.encode(x), move |c| f.decode(c))
}

const ERROR_LABEL: &str = "relative error of the irradiance, rms over 12 lights";

/// Encoding, then decoding 64 rows.
pub fn contests() -> [Contest; 2] {
    let op = Operator::of_box();
    let items = op.rows().len() as u64;
    let (there, back) = ways(&op).into_iter().map(|[a, b]| (a, b)).unzip();
    let contest = |title, file, contenders| Contest {
        title,
        file,
        error_label: ERROR_LABEL,
        item: "value",
        items,
        contenders,
    };
    [
        contest("Log/offset codes: encoding form factors", "log_offset_encode", there),
        contest("Log/offset codes: decoding form factors", "log_offset_decode", back),
    ]
}

/// The error over the width: what a fit gains, and where it begins to lose.
pub fn widths() -> Curves {
    let op = Operator::of_box();
    let round_trip = |map: &LogOffset| {
        let (mut codes, mut back) = (vec![0; op.values.len()], vec![0.0; op.values.len()]);
        etendue_cpu::log_offset::encode(map, &op.values, &mut codes).expect("equally long");
        etendue_cpu::log_offset::decode(map, &codes, &mut back).expect("equally long");
        op.error(&back)
    };
    let mut series = ["plain", "mean-preserving", "energy-preserving", "measured"]
        .map(|name| Series { name: name.to_string(), points: Vec::new() });
    for width in
        [4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.5, 13.0, 14.0, 16.0, 18.0, 20.0, 22.5, 25.0, 30.0, 40.0_f32]
    {
        let plain = LogOffset::try_new(width, op.max()).expect("in range");
        let maps = [
            plain.clone(),
            plain.clone().mean_preserving(),
            plain.clone().energy_preserving(),
            plain.measured(&op.values),
        ];
        for (series, map) in series.iter_mut().zip(&maps) {
            series.points.push((f64::from(width), round_trip(map)));
        }
    }
    Curves {
        title: "Log/offset codes: the width (25 in the source)",
        file: "log_offset_width",
        x_label: "width of the range, natural logarithm",
        y_label: ERROR_LABEL,
        series: series.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rivals_are_written_right() {
        let f = MiniFloat::new(4, 0.2);
        assert_eq!((f.encode(0.2), f.encode(0.0), f.encode(1.0)), (255, 0, 255));
        for code in 0..=255 {
            assert_eq!(f.encode(f.decode(code)), code);
        }
        // Half a step is 1/32 of the number at most.
        for i in 0..1000 {
            let x = 0.2 * (-0.01 * f64::from(i)).exp() as f32;
            assert!((f.decode(f.encode(x)) / x - 1.0).abs() <= 1.0 / 32.0);
        }
    }

    #[test]
    fn errors_are_ordered_as_they_must_be() {
        let [there, back] = contests();
        let error =
            |name: &str| there.contenders.iter().find(|c| c.name == name).expect("it takes part").error;
        assert_eq!(there.contenders.len(), back.contenders.len());
        assert!(error("published, portable") == error("published, AVX2"));
        assert!(error("fitted, AVX2") < error("published, AVX2"));
        assert!(error("published, measured, AVX2") < error("published, AVX2"));
        assert!(error("published, AVX2") < error("linear, 8 bits"));
    }

    /// Prints errors and times: `cargo test --release -p etendue-benches log_offset -- --ignored --nocapture`.
    #[test]
    #[ignore = "a measurement, ten seconds: cargo test --release -p etendue-benches log_offset -- --ignored --nocapture"]
    fn table() {
        for curve in widths().series {
            println!("{}: {:.4?}", curve.name, curve.points);
        }
        for mut contest in contests() {
            println!("{}", contest.title);
            let mut best = vec![f64::INFINITY; contest.contenders.len()];
            for _ in 0..100 {
                for (best, c) in best.iter_mut().zip(&mut contest.contenders) {
                    let start = std::time::Instant::now();
                    (c.work)();
                    *best = best.min(start.elapsed().as_secs_f64());
                }
            }
            for (best, c) in best.iter().zip(&contest.contenders) {
                let speed = contest.items as f64 / best * 1e-6;
                println!("{:38} error {:.3e}  {speed:7.0} M values/s", c.name, c.error);
            }
        }
    }
}
