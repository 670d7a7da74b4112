//! Names, shapes and lengths of the kernels, and that each does something.

use etendue_core::backend::BackendError;
use etendue_core::kernel::{Kernel, evaluate};
use std::collections::BTreeSet;

/// Words that are harmless as numbers, flags and sizes alike: the float 1, but small integers where sizes are wanted.
fn constants(kernel: Kernel) -> Vec<u32> {
    let one = 1.0_f32.to_bits();
    match kernel {
        Kernel::SampleBitmap
        | Kernel::EmissionScan
        | Kernel::EmissionScanTexels
        | Kernel::EmissionBrightest => vec![1, 1, 0x00ff_ffff],
        Kernel::CdfPick | Kernel::CdfPmf => vec![0, 1 << 31],
        Kernel::SampleParallelogram | Kernel::InvertParallelogram => [0, 0, 0, one, 0, 0, 0, one, 0].to_vec(),
        Kernel::CameraRay => {
            let mut c = vec![one; 16];
            (c[11], c[15]) = (4, 4);
            c
        }
        // One cell of a metre at the origin, of value 1.
        Kernel::GridAt | Kernel::GridOpticalLength => {
            let row = |k: usize| [0, 1, 2, 3].map(|i| if i == k { one } else { 0 });
            [[1; 4], row(0), row(1), row(2), [one; 4]].concat()
        }
        // A patch that sees itself, area 1, three bounces.
        Kernel::PolynomialApply => vec![1, one],
        Kernel::PolynomialApplyHalf => vec![1, one, one],
        Kernel::PolynomialSeries => vec![1, 3, one],
        _ => vec![one; kernel.shape().constants],
    }
}

#[test]
fn names_are_unique_and_name_a_module() {
    let names: BTreeSet<_> = Kernel::ALL.iter().map(|k| k.name()).collect();
    assert_eq!(names.len(), Kernel::ALL.len());
    assert!(names.iter().all(|n| n.split("::").count() == 2));
}

#[test]
fn every_kernel_answers_some_item_and_overwrites_its_output() {
    for kernel in Kernel::ALL {
        let shape = kernel.shape();
        let constants = constants(*kernel);
        let mut answered = false;
        // A few items of small floats of both signs: at least one of them has an answer that is not all zeros.
        for k in 0..64_u32 {
            let mut item: Vec<u32> = (0..shape.item as u32)
                .map(|i| (((k * 7 + i * 5) % 11) as f32 * 0.125 - 0.5 * ((k + i) % 2) as f32).to_bits())
                .collect();
            match kernel {
                Kernel::CdfPmf | Kernel::SrgbDecode => item[0] = k,
                // The whole triangle as a piece, of some area.
                Kernel::StartPlace | Kernel::StartWithin | Kernel::StartDensity => {
                    item[..6].copy_from_slice(&[0, 0, 1 << 24, 0, 0, 1 << 24]);
                    if let Some(rest) = item.get_mut(9..13) {
                        rest.copy_from_slice(&[1.0, 0.5, 0.25, 0.25_f32].map(f32::to_bits));
                    }
                }
                Kernel::RoundShape => item[7] = k % 2,
                // Codes, and texels that count: floats of few bits end in zeros.
                Kernel::Bc1EncodeRangeFit | Kernel::Bc4EncodeRangeFit => (item[0], item[16]) = (k, 0xffff),
                // A box around the origin of a long ray.
                Kernel::Slab => {
                    item[6..].copy_from_slice(&[9.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0_f32].map(f32::to_bits))
                }
                _ => {}
            }
            let mut out = vec![0xdead_beef; shape.out];
            evaluate(*kernel, &constants, &item, &mut out).unwrap();
            assert!(!out.contains(&0xdead_beef), "{} leaves words unwritten", kernel.name());
            answered |= out.iter().any(|w| *w != 0);
        }
        assert!(answered, "{} never answers", kernel.name());
    }
}

#[test]
fn wrong_lengths_are_refused_by_slice() {
    for kernel in Kernel::ALL {
        let shape = kernel.shape();
        let constants = constants(*kernel);
        let items = vec![0; 2 * shape.item];
        let mut out = vec![0; 2 * shape.out];
        let slice = |c: &[u32], i: &[u32], o: &mut [u32]| match evaluate(*kernel, c, i, o) {
            Err(BackendError::WrongLength { slice, .. }) => slice,
            other => panic!("{}: {other:?}", kernel.name()),
        };
        assert!(evaluate(*kernel, &constants, &items, &mut out).is_ok());
        assert_eq!(slice(&constants, &items, &mut vec![0; 2 * shape.out + 1]), "out");
        assert_eq!(slice(&constants, &items, &mut out[1..]), "out");
        if shape.item > 1 {
            assert_eq!(slice(&constants, &items[1..], &mut out), "items");
        }
        if shape.constants > 0 {
            assert_eq!(slice(&constants[..shape.constants - 1], &items, &mut out), "constants");
        }
        let longer: Vec<u32> = constants.iter().chain(&[7]).copied().collect();
        if shape.open {
            assert!(kernel.check(&longer, &items, &out).is_ok());
        } else {
            assert_eq!(slice(&longer, &items, &mut out), "constants");
        }
    }
}
