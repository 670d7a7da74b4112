//! For work on shaders: kernels by their modules, each with its numbers. The suite (`suite.rs`) is what holds them.

mod adapter;

use etendue_conformance::kernels::{FULL_COUNT, QUICK_COUNT, measure};
use etendue_core::backend::{Backend, BackendError};
use etendue_core::kernel::Kernel;

/// `ETENDUE_KERNELS=math,warp` chooses modules; `ETENDUE_FULL=1` takes as many items as the accuracy tables.
#[test]
#[ignore = "a tool: cargo test -p etendue-wgpu --test kernels -- --ignored --nocapture"]
fn kernels_are_right() {
    let Some(backend) = adapter::backend() else { return };
    println!("{}: {}", backend.info().adapter, backend.arithmetic().describe());
    let only = std::env::var("ETENDUE_KERNELS").unwrap_or_default();
    let count = if std::env::var_os("ETENDUE_FULL").is_some() { FULL_COUNT } else { QUICK_COUNT };
    let mut wrong = 0;
    for kernel in Kernel::ALL.iter().filter(|k| only.is_empty() || only.split(',').any(|m| m == k.module())) {
        match measure(&backend, *kernel, count) {
            Ok(row) => {
                let ok = row.passes();
                wrong += u32::from(!ok);
                println!(
                    "{} {}: worst {:.3} {} of {}, peer {:.3} of {}, {:.3} % equal of {}, {} flushed",
                    if ok { "ok   " } else { "WRONG" },
                    kernel.name(),
                    row.worst,
                    row.tolerance.unit,
                    row.truth_limit(),
                    row.peer_worst,
                    row.peer_limit(),
                    100.0 * row.equal_share(),
                    row.cases,
                    row.flushed,
                );
                if !ok && let Some(at) = &row.at {
                    let floats = |w: &[u32]| w.iter().map(|x| f32::from_bits(*x)).collect::<Vec<_>>();
                    let constants = &at.constants[..at.constants.len().min(24)];
                    println!("      constants {:?} item {:?}", floats(constants), floats(&at.items));
                }
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
