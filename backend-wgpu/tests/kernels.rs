//! Every kernel that has a shader, against the truth and the scalar reference.

use etendue_conformance::kernels::{FULL_COUNT, QUICK_COUNT, measure};
use etendue_core::backend::BackendError;
use etendue_core::kernel::Kernel;
use etendue_wgpu::WgpuBackend;

/// `ETENDUE_KERNELS` chooses modules by name, for work on one of them.
#[test]
fn kernels_are_right() {
    let backend = WgpuBackend::request().unwrap();
    let only = std::env::var("ETENDUE_KERNELS").unwrap_or_default();
    let count = if std::env::var_os("ETENDUE_FULL").is_some() { FULL_COUNT } else { QUICK_COUNT };
    let mut wrong = 0;
    for kernel in Kernel::ALL.iter().filter(|k| only.is_empty() || only.split(',').any(|m| m == k.module())) {
        match measure(&backend, *kernel, count) {
            Ok(row) => {
                let ok = row.passes(true);
                wrong += u32::from(!ok);
                println!(
                    "{} {}: worst {:.3} {} of {}, {:.3} % equal of {}",
                    if ok { "ok   " } else { "WRONG" },
                    kernel.name(),
                    row.worst,
                    row.tolerance.unit,
                    row.tolerance.truth.limit,
                    100.0 * row.equal_share(),
                    row.cases
                );
            }
            Err(BackendError::Unsupported { .. }) => println!("none  {}", kernel.name()),
            Err(e) => {
                wrong += 1;
                println!("ERROR {}: {e}", kernel.name());
            }
        }
    }
    assert_eq!(wrong, 0);
}
