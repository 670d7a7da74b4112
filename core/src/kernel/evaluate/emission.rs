//! Kernels of `emission`.

use super::{Reader, Shared, Writer};
use crate::direct::emission::{self, Bitmap, VertexAlbedo};
use crate::kernel::Kernel;

/// Cells that the scanning kernels follow.
const MAX_CELLS: f32 = 4096.0;

fn bitmap<'a>(shared: &'a Shared<'_>) -> Bitmap<'a> {
    let texels = shared.constants.get(2..).unwrap_or(&[]);
    let size = [0, 1].map(|i| shared.constants.get(i).copied().unwrap_or(0));
    Bitmap::lenient(size, texels, &shared.decode)
}

fn write(w: &mut Writer<'_>, albedo: Option<VertexAlbedo>) {
    if let Some(albedo) = albedo {
        w.word(1);
        for at in albedo.at {
            w.vec3(at);
        }
    }
}

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    match kernel {
        Kernel::EmissionCoefficient => {
            let area = emission::piece_area([r.vec3(), r.vec3(), r.vec3()]);
            let (albedo, irradiance) = (r.vec3(), [r.vec3(), r.vec3(), r.vec3()]);
            w.vec3(emission::emission(albedo, area, irradiance));
            w.float(area);
        }
        Kernel::EmissionOverlap => {
            let overlap = emission::overlap_unit([r.pair(), r.pair(), r.pair()]);
            w.float(overlap.share);
            w.floats(overlap.bary);
        }
        Kernel::EmissionScan => {
            write(w, emission::scan(&bitmap(shared), [r.pair(), r.pair(), r.pair()], MAX_CELLS));
        }
        Kernel::EmissionScanTexels => {
            write(w, emission::scan_texels(&bitmap(shared), [r.pair(), r.pair(), r.pair()], MAX_CELLS));
        }
        Kernel::EmissionBrightest => {
            w.vec3(emission::brightest_in(&bitmap(shared), [r.pair(), r.pair(), r.pair()]));
        }
        _ => {}
    }
}
