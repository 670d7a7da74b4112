//! Which way to take for a piece.

use super::frame::Frame;
use super::{Bitmap, Pyramid, RowSums, Texels, VertexAlbedo, sample_points, scan, scan_texels};
use crate::math::Vec3;

/// A way to the albedo of pieces over one bitmap.
pub trait PieceAlbedo {
    /// The albedo of the piece with texture coordinates `uv` at its vertices; for any coordinates, in bounded time.
    fn vertex_albedo(&self, uv: [[f32; 2]; 3]) -> VertexAlbedo;
}

/// The rule of the source: a scan of the texels where few cover the piece, else the brightest texel of the bitmap.
#[derive(Clone, Debug)]
pub struct Published<'a> {
    bitmap: Bitmap<'a>,
    brightest: Vec3,
    max_texels: f32,
}

impl<'a> Published<'a> {
    /// The rule with a scan up to `max_texels` texels (the source does not say how many).
    pub fn new(bitmap: Bitmap<'a>, max_texels: f32) -> Self {
        let [width, height] = bitmap.size();
        let mut brightest = Vec3::ZERO;
        for y in 0..height {
            for x in 0..width {
                brightest = brightest.max(Vec3::from_array(bitmap.texel(x, y)));
            }
        }
        Self { bitmap, brightest, max_texels }
    }
}

impl PieceAlbedo for Published<'_> {
    fn vertex_albedo(&self, uv: [[f32; 2]; 3]) -> VertexAlbedo {
        scan_texels(&self.bitmap, uv, self.max_texels)
            .unwrap_or_else(|| VertexAlbedo::uniform(self.brightest))
    }
}

/// The exact integral under the renderer's filter, over cells or along edges, whichever is cheaper. Both are exact, so
/// the choice trades time alone; pieces whose edges meet more than `max_cells` cells are sampled.
#[derive(Clone, Debug)]
pub struct Exact<'a> {
    bitmap: Bitmap<'a>,
    rows: RowSums,
    pyramid: Pyramid,
    max_cells: f32,
}

/// A cell on an edge costs as much as so many cells of the scan.
const EDGE_COST: f32 = 1.2;
/// Cells that edges may meet before a piece is sampled instead.
const MAX_CELLS: f32 = 262_144.0;
/// Divisions of a piece that is sampled: 4096 points.
const DIVISIONS: u32 = 64;

impl<'a> Exact<'a> {
    /// The rule with its tables, 11 bytes per texel beside the bitmap.
    pub fn new(bitmap: Bitmap<'a>) -> Self {
        Self { rows: RowSums::new(&bitmap), pyramid: Pyramid::new(&bitmap), bitmap, max_cells: MAX_CELLS }
    }

    /// The same with another limit on the cells that edges may meet.
    #[must_use]
    pub fn with_max_cells(self, max_cells: f32) -> Self {
        Self { max_cells, ..self }
    }

    /// The bound for [`importance`](super::importance); see [`Pyramid::brightest`].
    pub fn brightest(&self, uv: [[f32; 2]; 3]) -> Vec3 {
        self.pyramid.brightest(uv)
    }
}

impl PieceAlbedo for Exact<'_> {
    fn vertex_albedo(&self, uv: [[f32; 2]; 3]) -> VertexAlbedo {
        // The integral of albedos is no more than the largest of them; rounding along edges may make it so where that is 0.
        let bound = self.brightest(uv);
        VertexAlbedo { at: self.unbounded(uv).at.map(|a| a.min(bound)) }
    }
}

impl Exact<'_> {
    fn unbounded(&self, uv: [[f32; 2]; 3]) -> VertexAlbedo {
        let size = self.bitmap.size();
        let sampled = || sample_points(&self.bitmap, uv, DIVISIONS);
        let Some(frame) = Frame::new(size, uv, 0.5) else { return sampled() };
        if frame.cells() > EDGE_COST * frame.edge_cells()
            && let Some(albedo) = self.rows.vertex_albedo(&self.bitmap, uv, self.max_cells)
        {
            return albedo;
        }
        scan(&self.bitmap, uv, self.max_cells).unwrap_or_else(sampled)
    }
}
