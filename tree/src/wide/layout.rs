//! Nodes and leaf blocks as they lie in memory, for the CPU's lanes and for a GPU's loads alike.

use etendue_core::geometry::Aabb;
use etendue_core::math::Vec3;

/// Children of a node.
pub const WIDTH: usize = 8;
/// Triangles of a block.
pub const LANES: usize = 8;
/// The child word, or triangle number, of an unused slot: a reader that cannot rely on infinities skips by it.
pub const NOTHING: u32 = u32::MAX;

/// Marks a leaf in a child word.
pub const LEAF: u32 = 1 << 31;
/// Where the kind of a leaf begins: 0 and 1 are that many blocks less one, [`SHAPE`] is one round shape.
pub const KIND_SHIFT: u32 = 28;
/// Kind of a leaf that is a round shape; its place is the shape's number among the shapes.
pub const SHAPE: u32 = 6;
/// The place within blocks, nodes or shapes: the low 28 bits.
pub const PLACE: u32 = (1 << KIND_SHIFT) - 1;

/// Eight children: their boxes by rows, then their words. 256 bytes.
///
/// Rows: lo.x, hi.x, lo.y, hi.y, lo.z, hi.z. A child word is the number of a node; or [`LEAF`], the kind and the place of a
/// leaf; or [`NOTHING`], with an empty box (lo = +infinity, hi = -infinity). Used slots come first, leaves before nodes. Nodes come
/// before their children. The boxes are larger than what they hold by 4 to 5 u of the largest coordinate of the tree, u = 2^-24,
/// so that a fused box test (`b r - o r`, r = 1/d) misses nothing for origins of up to twice that coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// Planes of the boxes, metres.
    pub rows: [[f32; WIDTH]; 6],
    /// What each child is.
    pub child: [u32; WIDTH],
    /// Unused, zero.
    pub pad: [u32; WIDTH],
}

const _: () = assert!(size_of::<Node>() == 256 && align_of::<Node>() == 64);

impl Node {
    /// A node without children.
    pub const EMPTY: Self = {
        const LO: [f32; WIDTH] = [f32::INFINITY; WIDTH];
        const HI: [f32; WIDTH] = [f32::NEG_INFINITY; WIDTH];
        Self { rows: [LO, HI, LO, HI, LO, HI], child: [NOTHING; WIDTH], pad: [0; WIDTH] }
    };

    /// Sets the box of a child, larger by `margin` on each side.
    pub fn set_box(&mut self, slot: usize, b: &Aabb, margin: f32) {
        let (lo, hi) = (b.lo - margin, b.hi + margin);
        let planes = [lo.x, hi.x, lo.y, hi.y, lo.z, hi.z];
        for (row, plane) in self.rows.iter_mut().zip(planes) {
            if let Some(x) = row.get_mut(slot) {
                *x = plane;
            }
        }
    }

    /// The box of a child.
    pub fn child_box(&self, slot: usize) -> Aabb {
        let [lx, hx, ly, hy, lz, hz] = self.rows.map(|row| row[slot]);
        Aabb { lo: Vec3::new(lx, ly, lz), hi: Vec3::new(hx, hy, hz) }
    }
}

/// Eight triangles: coordinates by rows, then their numbers. 320 bytes.
///
/// Rows: x, y, z of vertex 0, then of vertices 1 and 2. An unused lane holds NaN, which no comparison accepts, and the number
/// [`NOTHING`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Block {
    /// Coordinates, metres.
    pub rows: [[f32; LANES]; 9],
    /// Numbers of the triangles in the scene.
    pub id: [u32; LANES],
}

const _: () = assert!(size_of::<Block>() == 320);

impl Block {
    /// A block without triangles.
    pub const EMPTY: Self = Self { rows: [[f32::NAN; LANES]; 9], id: [NOTHING; LANES] };

    /// Puts a triangle into a lane.
    pub fn set(&mut self, lane: usize, id: u32, vertices: [Vec3; 3]) {
        for (rows, v) in self.rows.chunks_exact_mut(3).zip(vertices) {
            for (row, x) in rows.iter_mut().zip(v.to_array()) {
                row[lane] = x;
            }
        }
        self.id[lane] = id;
    }
}
