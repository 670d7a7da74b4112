//! Inputs of flights, phase functions and Fresnel's equations.

use super::put;
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

/// Mean cosines: none, hardly any, and both peaks.
const HARD_G: [f32; 9] = [0.0, 1e-12, -1e-6, 1e-3, 0.5, -0.5, 0.99, -0.99, 0.9999];

fn g(i: usize, r: &mut Random) -> f32 {
    HARD_G.get(i % 16).copied().unwrap_or_else(|| r.range(-0.99, 0.99) as f32)
}

pub(super) fn items(kernel: Kernel, count: usize, r: &mut Random) -> Vec<u32> {
    use Kernel as K;
    let mut items = Vec::new();
    for i in 0..count {
        let wo = if r.below(8) == 0 { [0.0, 0.0, 1.0] } else { r.direction() };
        match kernel {
            K::EvalPhase => {
                let wi = match r.below(4) {
                    0 => wo.map(|x| -x),
                    1 => wo,
                    _ => r.direction(),
                };
                put(&mut items, &[g(i, r)]);
                put(&mut items, [wo, wi].as_flattened());
            }
            K::SamplePhase => {
                put(&mut items, &[g(i, r)]);
                put(&mut items, &wo);
                let u = [0.0, 0.5, 1.0 - 1.0 / 16_777_216.0];
                let u = u.get(i / 16).copied().unwrap_or_else(|| r.unit());
                put(&mut items, &[u, r.unit()]);
            }
            K::Transmittance => {
                let sigma = [0; 3].map(|_| if r.below(6) == 0 { 0.0 } else { r.log_range(1e-6, 1e4) });
                put(&mut items, &sigma);
                put(&mut items, &[r.log_range(1e-6, 1e3)]);
            }
            K::FresnelDielectric => {
                let cos = [0.0, 1.0, 1e-6, 0.5].get(i % 16).copied().unwrap_or_else(|| r.unit());
                let ratio =
                    [1.0, 1.5, 1.0 / 1.5].get(i % 5).copied().unwrap_or_else(|| r.log_range(0.3, 3.0));
                put(&mut items, &[cos, ratio]);
            }
            _ => {
                let cos = [0.0, 1.0, 1e-6, 0.5].get(i % 16).copied().unwrap_or_else(|| r.unit());
                let k = if r.below(8) == 0 { 0.0 } else { r.log_range(1e-3, 20.0) };
                put(&mut items, &[cos, r.log_range(0.02, 10.0), k]);
            }
        }
    }
    items
}
