//! How a device rounds, found out by trying: the same operations there and here.

use super::{Binding, Gpu, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::{Arithmetic, BackendError};
use etendue_core::sampling::counter::Counter;

/// Words of a trial, of its answer, and how many there are.
const GIVEN: usize = 6;
const FOUND: usize = 7;
const TRIALS: usize = 1 << 10;
/// Answers in which no subnormal number takes part; the others follow.
const ORDINARY: usize = 5;

impl Gpu {
    /// How its operations round; tried once.
    ///
    /// A compiler that may reorder sums need not do so in a trial: where shaders are not kept as written nothing is promised.
    pub(crate) fn arithmetic(&self) -> Result<Arithmetic, BackendError> {
        if !self.is_exact() {
            return Ok(Arithmetic::Loose);
        }
        if let Some(known) = self.arithmetic.get() {
            return Ok(*known);
        }
        let found = self.try_arithmetic()?;
        Ok(*self.arithmetic.get_or_init(|| found))
    }

    fn try_arithmetic(&self) -> Result<Arithmetic, BackendError> {
        let link = Link { root: "//: use arithmetic\n", features: &[], mutations: &[] };
        let key = PipelineKey { name: "arithmetic".into(), entry: "arithmetic" };
        let pipeline = self.pipeline(key, link, &[Binding::Read, Binding::Write])?;
        let trials: Vec<[f32; GIVEN]> = (0..TRIALS as u32).map(trial).collect();
        let words = self.scoped(|| {
            let given = self.upload("trials", bytemuck::cast_slice(trials.as_flattened()))?;
            let found = self.room("answers", (FOUND * TRIALS) as u64)?;
            let group = self.bind(&pipeline, &[&given, &found]);
            let mut encoder = self.encoder();
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline.raw);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(TRIALS as u32 / 64, 1, 1);
            }
            self.submit_and_read(encoder, &found, (FOUND * TRIALS) as u64).wait(self)
        })?;
        Ok(judge(&trials, &words))
    }
}

/// A float of random sign and mantissa, with this biased exponent.
fn draw(word: u32, exponent: u32) -> f32 {
    f32::from_bits(word & 0x807f_ffff | exponent << 23)
}

fn trial(i: u32) -> [f32; GIVEN] {
    let random = Counter::new(0);
    let ([a, b, c, d], [e, f, exponents, _]) = (random.bits4(0, i, 0), random.bits4(0, i, 1));
    // 2^-16 to 2^16.
    let ordinary = |shift: u32| 111 + (exponents >> shift & 31);
    [
        draw(a, ordinary(0)),
        draw(b, ordinary(5)),
        draw(c, ordinary(10)),
        draw(d | 1, 0),
        // Their product is 2^-130 to 2^-128.
        draw(e, 27),
        draw(f, 97),
    ]
}

fn answer([a, b, c, d, e, f]: [f32; GIVEN]) -> [f32; FOUND] {
    [
        a * b + c,
        (a + b) - a,
        a / b,
        etendue_core::math::sqrt(a.abs()),
        a * b - a * c,
        d * 1_073_741_824.0,
        e * f,
    ]
}

fn judge(trials: &[[f32; GIVEN]], words: &[u32]) -> Arithmetic {
    let mut kind = Arithmetic::Ieee;
    for (trial, found) in trials.iter().zip(words.chunks_exact(FOUND)) {
        for (k, (expected, word)) in answer(*trial).into_iter().zip(found).enumerate() {
            if expected.to_bits() == *word {
                continue;
            }
            if k < ORDINARY || f32::from_bits(*word) != 0.0 {
                return Arithmetic::Loose;
            }
            kind = Arithmetic::FlushesSubnormals;
        }
    }
    kind
}
