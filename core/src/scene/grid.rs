//! Grids of media: checked, turned into records, with the largest value of each block beside the values.

use super::check::{finite, not_negative, out_of_range};
use super::compile::MAX_COUNT;
use super::compiled::{CompiledScene, GridRecord, NO_INDEX};
use super::desc::{GridDesc, MediumDesc};
use super::error::SceneError;
use crate::medium::grid::{blocks, majorants};
use alloc::format;
use alloc::string::ToString;

/// Most cells along an axis: coordinates in f32 then still tell thousandths of a cell.
const MAX_SIZE: u32 = 4096;
/// Largest extinction \[1/m\] that a density may make: its products with lengths stay finite.
const MAX_EXTINCTION: f32 = 1e18;

/// Adds the grids of a medium; the index of its density and of its albedo.
pub(super) fn add(out: &mut CompiledScene, place: &str, medium: &MediumDesc) -> Result<[u32; 2], SceneError> {
    let mut indices = [NO_INDEX; 2];
    if let Some(grid) = &medium.density {
        let place = format!("{place} (density)");
        let largest = check(&place, grid)?;
        let sigma = (0..3).fold(0.0_f32, |m, c| m.max(medium.sigma_a[c] + medium.sigma_s[c]));
        let extinction = largest.max(1.0) * sigma;
        if extinction.is_nan() || extinction > MAX_EXTINCTION {
            let expected = "a density that makes no extinction beyond 1e18 per metre";
            return out_of_range(&place, "values", largest, expected);
        }
        indices[0] = append(out, &place, grid)?;
    }
    if let Some(grid) = &medium.albedo {
        let place = format!("{place} (albedo_grid)");
        let largest = check(&place, grid)?;
        if largest > 1.0 {
            return out_of_range(&place, "values", largest, "albedos of at most 1");
        }
        indices[1] = append(out, &place, grid)?;
    }
    Ok(indices)
}

/// The largest value of a grid that is well formed.
fn check(place: &str, grid: &GridDesc) -> Result<f32, SceneError> {
    for n in grid.size {
        if n == 0 || n > MAX_SIZE {
            return out_of_range(place, "size", n as f32, "1 to 4096 cells along each axis");
        }
    }
    if grid.channels != 1 && grid.channels != 3 {
        return out_of_range(place, "channels", grid.channels as f32, "one channel or three");
    }
    // Each factor is checked: below 2^38.
    let expected = grid.size.iter().fold(u64::from(grid.channels), |n, k| n * u64::from(*k));
    if grid.values.len() as u64 != expected {
        return Err(SceneError::WrongLength {
            place: place.to_string(),
            field: "values",
            found: grid.values.len(),
            expected: usize::try_from(expected).unwrap_or(usize::MAX),
        });
    }
    not_negative(place, "values", &grid.values)?;
    finite(place, "to_world", grid.to_world.as_flattened())?;
    Ok(grid.values.iter().fold(0.0, |m, v| m.max(*v)))
}

fn append(out: &mut CompiledScene, place: &str, grid: &GridDesc) -> Result<u32, SceneError> {
    let to_cells = to_cells(place, grid)?;
    let first_value = out.grid_values.len();
    let first_majorant = first_value + grid.values.len();
    let [bx, by, bz] = blocks(grid.size);
    let end = first_majorant + bx * by * bz;
    if end > MAX_COUNT {
        return Err(SceneError::TooLarge { what: "values of grids", found: end });
    }
    out.grid_values.extend_from_slice(&grid.values);
    out.grid_values.extend(majorants(grid.size, grid.channels as usize, &grid.values));
    out.grids.push(GridRecord {
        to_cells,
        size: grid.size,
        channels: grid.channels,
        first_value: first_value as u32,
        first_majorant: first_majorant as u32,
        pad: [0; 2],
    });
    Ok(out.grids.len() as u32 - 1)
}

/// The inverse of `to_world`, rows scaled to cells, with the corner beside it; by cofactors in f64.
fn to_cells(place: &str, grid: &GridDesc) -> Result<[[f32; 4]; 3], SceneError> {
    let m = grid.to_world.map(|row| row.map(f64::from));
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let det = (0..3).map(|j| m[0][j] * minor(0, j)).sum::<f64>();
    let mut out = [[0.0_f32; 4]; 3];
    for (axis, row) in out.iter_mut().enumerate() {
        for (j, slot) in row.iter_mut().take(3).enumerate() {
            *slot = (minor(j, axis) / det * f64::from(grid.size[axis])) as f32;
        }
        row[3] = grid.to_world[axis][3];
    }
    let flat = |row: &[f32; 4]| row[..3].iter().all(|x| *x == 0.0);
    if det == 0.0 || out.as_flattened().iter().any(|x| !x.is_finite()) || out.iter().any(flat) {
        return out_of_range(place, "to_world", det as f32, "a transform of the unit cube that has a volume");
    }
    Ok(out)
}
