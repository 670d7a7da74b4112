//! Kernels of media on grids.

use super::{Reader, Shared, Writer};
use crate::kernel::Kernel;
use crate::math::Vec3;
use crate::medium::grid::{Grid, majorants, regular};
use crate::scene::GridRecord;
use alloc::vec::Vec;
use bytemuck::Zeroable;

/// The grid of a batch.
pub(super) struct Owned {
    record: GridRecord,
    values: Vec<f32>,
    majorants: Vec<f32>,
}

impl Owned {
    /// From a batch's constants; `None` where there are fewer values than the size says, or none.
    pub(super) fn new(constants: &[u32]) -> Option<Self> {
        let mut r = Reader(constants);
        let size = [r.word(), r.word(), r.word()];
        let channels = if r.word() == 3 { 3 } else { 1 };
        let to_cells = [(); 3].map(|()| [(); 4].map(|()| r.float()));
        let count = size.iter().try_fold(channels as usize, |n, s| n.checked_mul(*s as usize))?;
        let values: Vec<f32> = r.0.get(..count)?.iter().map(|w| f32::from_bits(*w)).collect();
        let record = GridRecord { to_cells, size, channels, ..GridRecord::zeroed() };
        let majorants = majorants(size, channels as usize, &values);
        (count > 0).then_some(Self { record, values, majorants })
    }
}

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    let Some(owned) = &shared.grid else { return };
    let grid = Grid::of(&owned.record, &owned.values, &owned.majorants);
    match kernel {
        Kernel::GridAt => w.vec3(grid.at(r.vec3())),
        Kernel::GridOpticalLength => {
            let line = grid.line(r.vec3(), r.vec3());
            w.vec3(regular::optical_length(&grid, &line, r.float(), Vec3::ZERO));
        }
        _ => {}
    }
}
