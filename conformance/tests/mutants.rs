//! The suite against wrong backends: each must be caught by the check that is there for it, and the right ones pass.
//!
//! Kernel mutants wrap the reference and spoil one kernel's words. Session mutants trace with a tracer of their own,
//! written here from the rendering equation, with one fault switched on; with none it is a second estimator that must
//! agree with all that the suite knows.
#![allow(clippy::disallowed_methods, reason = "the mutants' own arithmetic")]

mod spoils;
mod tracer;

use etendue_conformance::analytic::{self, Estimator};
use etendue_conformance::golden;
use etendue_conformance::invariance;
use etendue_conformance::kernels::measure;
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::{Level, trios};
use etendue_core::backend::{Arithmetic, Backend, BackendError, BackendInfo, Capabilities, Session};
use etendue_core::kernel::{self, Kernel};
use etendue_core::scene::CompiledScene;
use spoils::{Mutant, Spoil, float, scale};
use std::sync::Arc;
use tracer::{Fault, TracerBackend};

struct KernelMutant {
    kernel: Kernel,
    spoil: Spoil,
}

impl Backend for KernelMutant {
    fn info(&self) -> BackendInfo {
        ReferenceBackend.info()
    }
    fn capabilities(&self) -> Capabilities {
        ReferenceBackend.capabilities()
    }
    fn arithmetic(&self) -> Arithmetic {
        Arithmetic::Ieee
    }
    fn open(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        ReferenceBackend.open(scene)
    }
    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError> {
        kernel::evaluate(kernel, constants, items, out)?;
        if kernel == self.kernel {
            let shape = kernel.shape();
            for (item, out) in items.chunks_exact(shape.item).zip(out.chunks_exact_mut(shape.out)) {
                (self.spoil)(constants, item, out);
            }
        }
        Ok(())
    }
}

/// Name, kernel, and what is done to its answers.
const KERNEL_MUTANTS: &[Mutant] = &[
    ("dividing by 2^32", Kernel::U32ToUnit, |_, item, out| {
        out[0] = (item[0] as f32 / 4_294_967_296.0).to_bits();
    }),
    ("pi cut after five decimals", Kernel::PdfCosineHemisphere, |_, _, out| {
        scale(out, 1.000_000_8);
    }),
    ("the cosine forgotten", Kernel::PdfCosineHemisphere, |_, item, out| {
        out[0] = if float(item[2]) > 0.0 { std::f32::consts::FRAC_1_PI.to_bits() } else { 0 };
    }),
    ("the density off by 2", Kernel::PdfLobes, |_, _, out| scale(out, 2.0)),
    ("hits on edges missed", Kernel::Triangle, |_, _, out| {
        let (b1, b2) = (float(out[2]), float(out[3]));
        if b1 == 0.0 || b2 == 0.0 || b1 + b2 == 1.0 {
            out.fill(0);
        }
    }),
    ("the end of the interval missed", Kernel::Triangle, |_, item, out| {
        if out[1] == item[6] {
            out.fill(0);
        }
    }),
    ("a box entered too late", Kernel::Slab, |_, _, out| scale(&mut out[1..], 1.0 + 4.0 * f32::EPSILON)),
    ("the far root of a sphere", Kernel::RoundShape, |_, item, out| {
        if item[7] == 0 && float(out[1]) > 0.0 {
            out[1] = (float(out[1]) * 1.5).to_bits();
        }
    }),
    ("no scramble", Kernel::SobolBits4, |_, item, out| {
        out[0] = item[2].reverse_bits();
    }),
    ("the next entry at the boundary", Kernel::CdfPick, |constants, item, out| {
        if constants.contains(&item[0]) && out[0] > 0 {
            out[0] -= 1;
        }
    }),
    ("sRGB not decoded", Kernel::SrgbDecode, |_, item, out| {
        out[0] = (item[0] as f32 / 255.0).to_bits();
    }),
    ("gamma 2.2 for sRGB", Kernel::SrgbDecode, |_, item, out| {
        out[0] = (item[0] as f32 / 255.0).powf(2.2).to_bits();
    }),
    ("rows of a bitmap upside down", Kernel::SampleBitmap, |constants, item, out| {
        let mut turned = item.to_vec();
        turned[1] ^= 1 << 31;
        kernel::evaluate(Kernel::SampleBitmap, constants, &turned, out).expect("same lengths");
    }),
    ("the balance heuristic", Kernel::PowerHeuristic, |_, item, out| {
        let (a, b) = (float(item[0]), float(item[1]));
        out[0] = if a > 0.0 { 1.0 / (1.0 + b / a) } else { 0.0 }.to_bits();
    }),
    ("a light's density without its pick", Kernel::PdfLight, |constants, _, out| {
        scale(out, 1.0 / float(constants[2]));
    }),
    ("backward for forward", Kernel::EvalPhase, |_, item, out| {
        let mut turned = item.to_vec();
        turned[0] ^= 1 << 31;
        kernel::evaluate(Kernel::EvalPhase, &[], &turned, out).expect("same lengths");
    }),
    ("the phase function about the way back", Kernel::SamplePhase, |_, _, out| {
        out.iter_mut().for_each(|x| *x ^= 1 << 31);
    }),
    ("no absorption", Kernel::Transmittance, |_, _, out| out.fill(1.0_f32.to_bits())),
    ("a grid a quarter of a cell off", Kernel::GridAt, |constants, item, out| {
        let mut moved = item.to_vec();
        moved[0] = (float(item[0]) + 0.25 / float(constants[4])).to_bits();
        kernel::evaluate(Kernel::GridAt, constants, &moved, out).expect("same lengths");
    }),
    ("the value where a way begins for its mean", Kernel::GridOpticalLength, |constants, item, out| {
        kernel::evaluate(Kernel::GridAt, constants, &item[..3], out).expect("same lengths");
        scale(out, float(item[6]));
    }),
    ("one step in a hundred forgotten", Kernel::GridOpticalLength, |_, _, out| scale(out, 0.99)),
    ("Schlick for Fresnel", Kernel::FresnelDielectric, |_, item, out| {
        let (cos, ratio) = (float(item[0]), float(item[1]));
        out[0] = etendue_core::bsdf::fresnel::schlick(cos, ratio).to_bits();
    }),
    ("k forgotten", Kernel::FresnelConductor, |_, item, out| {
        kernel::evaluate(Kernel::FresnelConductor, &[], &[item[0], item[1], 0], out).expect("same lengths");
    }),
    ("the exponent n of Phong's norm instead of n + 1", Kernel::EvalPhong, |_, item, out| {
        let n = float(item[3]);
        scale(out, n / (n + 1.0));
    }),
    ("a NaN at the end of the unit interval", Kernel::SamplePowerCosine, |_, item, out| {
        if item[0] == (1.0_f32 - 1.0 / 16_777_216.0).to_bits() {
            out[2] = f32::NAN.to_bits();
        }
    }),
    ("an ulp too much in a logarithm", Kernel::Ln, |_, _, out| {
        out[0] = out[0].wrapping_add(1);
    }),
];

#[test]
fn the_unspoiled_wrapper_passes() {
    let same = KernelMutant { kernel: Kernel::Ln, spoil: |_, _, _| {} };
    for k in Kernel::ALL {
        let row = measure(&same, *k, 1000).expect("all kernels are there");
        assert!(row.passes(), "{}", k.name());
    }
}

#[test]
fn every_kernel_mutant_is_caught_by_its_kernel() {
    for (name, kernel, spoil) in spoils::MUTANTS.iter().copied().chain([KERNEL_MUTANTS]).flatten() {
        let mutant = KernelMutant { kernel: *kernel, spoil: *spoil };
        let row = measure(&mutant, *kernel, 4000).expect("all kernels are there");
        assert!(!row.passes(), "\"{name}\" passes as {}", kernel.name());
        // Caught by the truth alone, not only by its bits: the tolerance has teeth.
        let limit = row.tolerance.truth.limit;
        assert!(row.worst > limit, "\"{name}\" is within the tolerance: {} <= {limit}", row.worst);
        for other in Kernel::ALL.iter().filter(|k| **k != *kernel).take(8) {
            assert!(measure(&mutant, *other, 200).expect("all kernels are there").passes());
        }
    }
}

/// Trio mutants must be caught by the property tests, which know no truth.
#[test]
fn trio_mutants_are_caught_by_properties() {
    let spoiled: &[(&str, Kernel, Spoil, &str)] = &[
        (
            "uniform instead of cosine",
            Kernel::SampleCosineHemisphere,
            |_, item, out| {
                kernel::evaluate(Kernel::SampleHemisphere, &[], item, out).expect("same lengths");
            },
            "trio/cosine_hemisphere/chi_square",
        ),
        ("a density 1 % too large", Kernel::PdfSphere, |_, _, out| scale(out, 1.01), "trio/sphere/integral"),
        (
            "coordinates swapped on the way back",
            Kernel::InvertHemisphere,
            |_, _, out| out.swap(0, 1),
            "trio/hemisphere/round_trip",
        ),
        (
            "a weight without the lobe's share",
            Kernel::SampleLobes,
            |_, item, out| {
                if item[3..6] != [0; 3] && item[..3] != [0; 3] {
                    scale(&mut out[4..7], 1.3);
                }
            },
            "trio/lobes(both)/weights",
        ),
        (
            "the other lobe's density",
            Kernel::PdfLobes,
            |_, item, out| {
                if item[3..6] != [0; 3] && item[..3] != [0; 3] {
                    let mut diffuse = item.to_vec();
                    diffuse[3..6].fill(0);
                    kernel::evaluate(Kernel::PdfLobes, &[], &diffuse, out).expect("same lengths");
                }
            },
            "trio/lobes(both)/chi_square",
        ),
        (
            "the whole's chance for the piece's",
            Kernel::StartDensity,
            |_, item, out| scale(out, 1.0 / float(item[10])),
            "trio/first_shot(quarter)/integral",
        ),
        (
            "starts uniform on their piece",
            Kernel::StartPlace,
            |_, item, out| {
                let mut flat = item.to_vec();
                flat[6..9].fill(1.0_f32.to_bits());
                kernel::evaluate(Kernel::StartPlace, &[], &flat, out).expect("same lengths");
            },
            "trio/first_shot(whole)/chi_square",
        ),
        (
            "starts beside where they are looked for",
            Kernel::StartPlace,
            |_, _, out| out.swap(1, 2),
            "trio/first_shot(small)/round_trip",
        ),
        (
            "the power heuristic on one side alone",
            Kernel::LightShare,
            |_, _, out| {
                let (a, b) = (float(out[0]), 1.0 - float(out[0]));
                out[0] = (a * a / (a * a + b * b)).to_bits();
            },
            "trio/first_shot(needle)/conservation",
        ),
        (
            "the brightest channel on one side alone",
            Kernel::StartFlux,
            |_, item, out| {
                let e = [0, 1, 2].map(|k| float(item[k]));
                let all = float(item[3]) + float(item[4]) * e[0].max(e[1]).max(e[2]);
                for (out, e) in out.iter_mut().zip(e) {
                    *out = (e / all).to_bits();
                }
            },
            "trio/first_shot(whole)/conservation",
        ),
        (
            "as published, without the chance",
            Kernel::PieceFlux,
            |_, item, out| scale(out, float(item[7])),
            "trio/first_shot(small)/published",
        ),
        (
            "hidden starts that carry nothing when asked and all when not",
            Kernel::LookFactor,
            |_, item, out| {
                if item[1] != 0 {
                    out[0] = 0;
                }
            },
            "trio/first_shot/looks",
        ),
        (
            "starts that bunch in one part",
            Kernel::EvenWord,
            |_, item, out| out[0] = item[1] ^ item[0],
            "trio/first_shot/even_words",
        ),
    ];
    for (name, kernel, spoil, expected) in spoiled {
        let mutant = KernelMutant { kernel: *kernel, spoil: *spoil };
        let found = trios::check(&mutant, 1 << 15).expect("all kernels are there");
        let failed: Vec<_> = found.iter().filter(|f| !f.1).map(|f| f.0.as_str()).collect();
        assert!(failed.contains(expected), "\"{name}\": expected {expected} to fail, found {failed:?}");
    }
    let right = trios::check(&ReferenceBackend, 1 << 15).expect("all kernels are there");
    assert!(right.iter().all(|f| f.1), "{:?}", right.iter().filter(|f| !f.1).collect::<Vec<_>>());
}

/// Runs the analytic cases of these names.
fn analytic_failures(backend: &dyn Backend, names: &[&str]) -> Vec<String> {
    let mut failed = Vec::new();
    for case in analytic::cases().iter().filter(|c| names.contains(&c.name.as_str())) {
        for (name, passed, detail) in
            analytic::check(backend, Estimator::Path, case, Level::Quick).expect("surfaces only")
        {
            if !passed {
                failed.push(format!("{name}: {detail}"));
            }
        }
    }
    failed
}

/// Session faults, each with the analytic case that must see it.
const SESSION_MUTANTS: &[(Fault, &str)] = &[
    (Fault::CosineForgotten, "point_over_plane"),
    (Fault::MisWeightDropped, "square_light"),
    (Fault::LightPickBiased, "light_choice"),
    (Fault::RouletteNotCompensated, "furnace_cube"),
    (Fault::EmissionTwoSided, "disk_light"),
    (Fault::NormalFlipped, "integrating_sphere_centre"),
    (Fault::EnergyLost, "integrating_sphere_centre"),
    (Fault::EdgesMissed, "furnace_view"),
    (Fault::SrgbNotDecoded, "texture_mean"),
    (Fault::DepthOffByOne, "furnace_after_1_bounces"),
    (Fault::EnvironmentDropped, "open_floor"),
    (Fault::ShadowsForgotten, "shadow"),
    (Fault::TieRule, "coincident_surfaces"),
    (Fault::DistanceNotSquared, "cie171_5_2"),
    (Fault::PiWrong, "point_over_plane"),
    (Fault::NoScramble, "disk_light"),
];

#[test]
fn every_session_mutant_is_caught_by_its_scene() {
    let mut missed = String::new();
    let mut sound: Vec<&str> = Vec::new();
    for (fault, case) in SESSION_MUTANTS {
        assert!(analytic::cases().iter().any(|c| c.name == *case), "no case {case}");
        if analytic_failures(&TracerBackend { fault: Some(*fault) }, &[case]).is_empty() {
            missed.push_str(&format!("{fault:?} passes {case}\n"));
        }
        if !sound.contains(case) {
            sound.push(case);
        }
    }
    assert!(missed.is_empty(), "{missed}");
    let right = analytic_failures(&TracerBackend { fault: None }, &sound);
    assert!(right.is_empty(), "the faultless tracer fails: {right:?}");
}

#[test]
#[ignore = "ten seconds: cargo nextest run -p etendue-conformance --run-ignored only goldens_catch_what_they_are_for"]
fn goldens_catch_what_they_are_for() {
    for (name, faults) in [
        ("room", &[Fault::EnergyLost, Fault::EmissionTwoSided][..]),
        ("stage", &[Fault::LightPickBiased]),
        ("terrace", &[Fault::SrgbNotDecoded]),
    ] {
        let scene = golden::scenes().into_iter().find(|s| s.name == name).expect("scenes have these names");
        let of = |fault| {
            golden::check(&TracerBackend { fault }, Estimator::Path, &scene, Level::Quick)
                .expect("surfaces only")
        };
        for fault in faults {
            let found = of(Some(*fault));
            assert!(found.iter().any(|f| !f.1), "{fault:?} passes {name}: {found:?}");
        }
        let right = of(None);
        assert!(right.iter().all(|f| f.1), "the faultless tracer fails {name}: {right:?}");
    }
}

#[test]
fn a_film_that_forgets_a_block_is_caught() {
    let found = invariance::check(&TracerBackend { fault: Some(Fault::BlockForgotten) }, Level::Quick);
    let failed = match found {
        Ok(list) => list.iter().any(|f| !f.1 && f.0.ends_with("/blocks")),
        Err(_) => true,
    };
    assert!(failed);
}
