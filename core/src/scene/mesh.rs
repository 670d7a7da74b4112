//! Meshes before they are part of a scene: their arrays checked, repeats found, and their transforms.

use super::check::{finite, out_of_range};
use super::desc::MeshDesc;
use super::error::SceneError;
use crate::math::{self, Vec3};
use alloc::string::ToString;
use alloc::vec::Vec;

/// Checks the arrays of a mesh against each other.
pub(super) fn check_mesh(place: &str, mesh: &MeshDesc, materials: usize) -> Result<(), SceneError> {
    let wrong = |field, found, expected| {
        Err(SceneError::WrongLength { place: place.to_string(), field, found, expected })
    };
    let vertices = mesh.positions.len();
    if !mesh.normals.is_empty() && mesh.normals.len() != vertices {
        return wrong("normals", mesh.normals.len(), vertices);
    }
    if !mesh.texcoords.is_empty() && mesh.texcoords.len() != vertices {
        return wrong("texcoords", mesh.texcoords.len(), vertices);
    }
    if !mesh.face_materials.is_empty() && mesh.face_materials.len() != mesh.triangles.len() {
        return wrong("face_materials", mesh.face_materials.len(), mesh.triangles.len());
    }
    for p in &mesh.positions {
        finite(place, "a vertex", p)?;
    }
    for n in &mesh.normals {
        finite(place, "a normal", n)?;
    }
    for t in &mesh.texcoords {
        finite(place, "a texture coordinate", t)?;
    }
    let index_error = |kind, triangle, index, length| {
        Err(SceneError::IndexOutOfRange { place: place.to_string(), kind, triangle, index, length })
    };
    for (i, t) in mesh.triangles.iter().enumerate() {
        if let Some(&v) = t.iter().find(|v| **v as usize >= vertices) {
            return index_error("vertex", i, v, vertices);
        }
        match mesh.face_materials.get(i) {
            Some(&m) if m as usize >= materials => return index_error("material", i, m, materials),
            _ => {}
        }
    }
    Ok(())
}

/// Which triangles repeat an earlier one of the mesh: the same corners in the same turning sense, the same material.
/// Coincident copies with one material add nothing visible but would emit twice.
pub(super) fn repeated_triangles(mesh: &MeshDesc) -> Vec<bool> {
    let key = |i: usize| {
        let corners = mesh.triangles[i].map(|v| mesh.positions[v as usize].map(f32::to_bits));
        let first = (0..3).min_by_key(|k| corners[*k]).unwrap_or(0);
        let material = mesh.face_materials.get(i).copied().unwrap_or(0);
        ([corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]], material)
    };
    let hash = |i: usize| {
        let (corners, material) = key(i);
        corners.iter().flatten().chain([&material]).fold(0xcbf2_9ce4_8422_2325_u64, |h, w| {
            (h ^ u64::from(*w)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23)
        })
    };
    let mut order: Vec<(u64, u32)> = (0..mesh.triangles.len()).map(|i| (hash(i), i as u32)).collect();
    order.sort_unstable();
    let mut repeated = alloc::vec![false; mesh.triangles.len()];
    for group in order.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() > 1) {
        for (k, later) in group.iter().enumerate().skip(1) {
            repeated[later.1 as usize] =
                group[..k].iter().any(|e| key(e.1 as usize) == key(later.1 as usize));
        }
    }
    repeated
}

/// An affine transform of a mesh, evaluated in f64 and rounded once.
pub(super) struct MeshTransform {
    rows: [[f64; 4]; 3],
    identity: bool,
    pub(super) mirrors: bool,
}

impl MeshTransform {
    pub(super) fn new(place: &str, transform: Option<[[f32; 4]; 3]>) -> Result<Self, SceneError> {
        let Some(m) = transform else {
            let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
            return Ok(Self { rows, identity: true, mirrors: false });
        };
        for row in &m {
            finite(place, "matrix", row)?;
        }
        let rows = m.map(|r| r.map(f64::from));
        let c = cofactors(&rows);
        let det = rows[0][0] * c[0][0] + rows[0][1] * c[0][1] + rows[0][2] * c[0][2];
        if det == 0.0 {
            return out_of_range(place, "matrix", 0.0, "a transform with a non-zero determinant");
        }
        Ok(Self { rows, identity: false, mirrors: det < 0.0 })
    }

    pub(super) fn point(&self, p: [f32; 3]) -> [f32; 3] {
        if self.identity {
            return p;
        }
        let p = p.map(f64::from);
        self.rows.map(|r| (r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3]) as f32)
    }

    /// Unit normal under the inverse transpose; zero for a zero normal.
    pub(super) fn normal(&self, n: [f32; 3]) -> Vec3 {
        if self.identity {
            return math::normalize_or(Vec3::from_array(n), Vec3::ZERO);
        }
        let n = n.map(f64::from);
        let sign = if self.mirrors { -1.0 } else { 1.0 };
        let v = cofactors(&self.rows).map(|c| sign * (c[0] * n[0] + c[1] * n[1] + c[2] * n[2]));
        let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if largest == 0.0 {
            return Vec3::ZERO;
        }
        math::normalize_or(Vec3::from_array(v.map(|x| (x / largest) as f32)), Vec3::ZERO)
    }
}

/// Cofactors of the linear part: the inverse transpose times the determinant.
fn cofactors(r: &[[f64; 4]; 3]) -> [[f64; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        r[a][c] * r[b][d] - r[a][d] * r[b][c]
    };
    [0, 1, 2].map(|i| [minor(i, 0), minor(i, 1), minor(i, 2)])
}
