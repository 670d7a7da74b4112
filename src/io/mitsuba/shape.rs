//! Shapes: meshes from files, rectangles, cubes, spheres and disks.

use std::collections::HashMap;

use etendue_core::scene::{MeshDesc, ShapeDesc, ShapeKind};

use super::Builder;
use super::surface::UvMap;
use super::transform::{Transform, cross, dot, length, unit};
use super::values::Object;
use crate::io::error::{LoadError, quoted};
use crate::io::mesh::{MeshOptions, MtlMode};

const KINDS: &str = "obj, ply, rectangle, cube, sphere, disk";

/// What a shape is made of, whatever its geometry.
struct Skin {
    material: String,
    /// Where its texture lies; absent where there is none.
    uv: Option<UvMap>,
    interior: String,
    exterior: String,
    to_world: Transform,
    flip: bool,
}

impl Builder<'_, '_> {
    /// Reads a `shape` into the scene.
    pub(super) fn shape(&mut self, o: &Object<'_>) -> Result<(), LoadError> {
        if !KINDS.split(", ").any(|k| k == o.kind()) {
            return Err(o.unknown_kind(KINDS));
        }
        let skin = self.skin(o)?;
        match o.kind() {
            kind @ ("obj" | "ply") => self.file_mesh(o, &skin, kind == "obj")?,
            "rectangle" => self.rectangle(o, &skin)?,
            "cube" => self.cube(o, &skin)?,
            "sphere" => self.sphere(o, &skin)?,
            _ => self.disk(o, &skin)?,
        }
        // How finely others cut it into triangles, and what guides their gradients.
        o.ignore(&["silhouette_sampling_weight"]);
        if o.old() {
            o.ignore(&["subdiv"]);
        }
        o.finish()
    }

    fn skin(&mut self, o: &Object<'_>) -> Result<Skin, LoadError> {
        let mut sides = [String::new(), String::new()];
        for medium in o.objects("medium")? {
            let side = match medium.role {
                "interior" => &mut sides[0],
                "exterior" => &mut sides[1],
                other => {
                    let found = format!("a medium named {}", quoted(other));
                    return Err(o.error(found, "media named interior and exterior"));
                }
            };
            if !side.is_empty() {
                return Err(o.error(format!("a second {} medium", medium.role), "one"));
            }
            *side = self.medium(&medium)?;
        }
        let [interior, exterior] = sides;
        let emission = match o.at_most_one("emitter")? {
            Some(emitter) => Some(self.area_light(&emitter)?),
            None => None,
        };
        let bsdf = o.at_most_one("bsdf")?;
        let boundary = o.old() && !(interior.is_empty() && exterior.is_empty());
        let (material, uv) = self.material(bsdf.as_ref(), emission, boundary)?;
        let to_world = o.transform("to_world")?;
        let flip = o.flag("flip_normals")?.unwrap_or(false);
        Ok(Skin { material, uv, interior, exterior, to_world, flip })
    }

    fn push_mesh(&mut self, mesh: MeshDesc, skin: &Skin) {
        self.loader.desc.meshes.push(MeshDesc {
            material: skin.material.clone(),
            interior: skin.interior.clone(),
            exterior: skin.exterior.clone(),
            textures: true,
            ..mesh
        });
    }

    fn push_shape(&mut self, kind: ShapeKind, skin: &Skin) {
        self.loader.desc.shapes.push(ShapeDesc {
            kind,
            material: skin.material.clone(),
            interior: skin.interior.clone(),
            exterior: skin.exterior.clone(),
        });
    }

    fn file_mesh(&mut self, o: &Object<'_>, skin: &Skin, obj: bool) -> Result<(), LoadError> {
        let (name, element) = o.filename()?;
        let face_normals = o.flag("face_normals")?.unwrap_or(false);
        let flip_v = o.flag("flip_tex_coords")?.unwrap_or(obj);
        let Some(path) = self.find(o, element, name) else {
            let expected = format!("a file beside {}", self.scene.display());
            return Err(o.error_at(element, quoted(name), expected));
        };
        let options = MeshOptions { mtl: MtlMode::Diffuse, textures: true, materials: false };
        let mut mesh = self.loader.mesh(&path, options)?;
        let rows = skin.to_world.affine(o)?;
        let mirrors = skin.to_world.determinant() < 0.0;
        if face_normals {
            mesh.normals.clear();
        }
        // Normals from the file keep their side of the surface, and it is they that say where the front is;
        // without them it is the order of corners, which a mirror turns round.
        if mirrors && mesh.normals.is_empty() {
            reverse(&mut mesh);
        }
        if skin.flip {
            reverse(&mut mesh);
            for n in &mut mesh.normals {
                *n = n.map(|x| -x);
            }
        }
        if skin.to_world != Transform::IDENTITY {
            mesh.transform = Some(rows);
        }
        if mesh.normals.is_empty() && !face_normals {
            smooth(&mut mesh, &skin.to_world, mirrors);
        }
        mesh.shading_normals = !mesh.normals.is_empty();
        match &skin.uv {
            Some(uv) if mesh.texcoords.is_empty() => {
                let message = format!("{} has no texture coordinates: (0, 0) is used", quoted(name));
                self.loader.note(o.file(), Some(element.line), message);
                let at = [uv[0][2] as f32, uv[1][2] as f32];
                mesh.texcoords = vec![at; mesh.positions.len()];
            }
            Some(uv) => {
                for t in &mut mesh.texcoords {
                    let v = f64::from(t[1]);
                    *t = mapped(uv, f64::from(t[0]), if flip_v { 1.0 - v } else { v });
                }
            }
            None => mesh.texcoords.clear(),
        }
        self.push_mesh(mesh, skin);
        Ok(())
    }

    fn rectangle(&mut self, o: &Object<'_>, skin: &Skin) -> Result<(), LoadError> {
        skin.to_world.affine(o)?;
        let turned = (skin.to_world.determinant() < 0.0) != skin.flip;
        let Some(uv) = skin.uv else {
            let f32s = |v: [f64; 3]| v.map(|x| x as f32);
            let v = skin.to_world.column(1);
            self.push_shape(
                ShapeKind::Rectangle {
                    center: f32s(skin.to_world.column(3)),
                    u: f32s(skin.to_world.column(0)),
                    v: f32s(if turned { v.map(|x| -x) } else { v }),
                },
                skin,
            );
            return Ok(());
        };
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mut mesh = MeshDesc {
            name: o.id().unwrap_or("rectangle").to_owned(),
            positions: corners.map(|[x, y]| skin.to_world.point([x, y, 0.0]).map(|x| x as f32)).to_vec(),
            texcoords: corners.map(|[x, y]| mapped(&uv, 0.5 + 0.5 * x, 0.5 + 0.5 * y)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshDesc::default()
        };
        if turned {
            reverse(&mut mesh);
        }
        self.push_mesh(mesh, skin);
        Ok(())
    }

    fn cube(&mut self, o: &Object<'_>, skin: &Skin) -> Result<(), LoadError> {
        let face_normals = o.flag("face_normals")?.unwrap_or(false);
        skin.to_world.affine(o)?;
        // For each face its normal and, from the corner (0, 0), the directions of u and v.
        let faces: [[[f64; 3]; 3]; 6] = [
            [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
            [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
            [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
        ];
        let mut mesh = MeshDesc { name: o.id().unwrap_or("cube").to_owned(), ..MeshDesc::default() };
        for [n, u, v] in faces {
            let first = mesh.positions.len() as u32;
            // Round the face counter-clockwise, as seen from outside.
            let outside = dot(cross(u, v), n) > 0.0;
            let around =
                if outside { [(0, 0), (1, 0), (1, 1), (0, 1)] } else { [(0, 0), (0, 1), (1, 1), (1, 0)] };
            for (s, t) in around.map(|(s, t)| (f64::from(s), f64::from(t))) {
                let p = [0, 1, 2].map(|k| n[k] + (2.0 * s - 1.0) * u[k] + (2.0 * t - 1.0) * v[k]);
                mesh.positions.push(skin.to_world.point(p).map(|x| x as f32));
                if let Some(uv) = &skin.uv {
                    mesh.texcoords.push(mapped(uv, s, t));
                }
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        let mirrors = skin.to_world.determinant() < 0.0;
        // The outside stays outside, unless the order of corners alone says where it is.
        if (mirrors && !face_normals) != skin.flip {
            reverse(&mut mesh);
        }
        self.push_mesh(mesh, skin);
        Ok(())
    }

    fn sphere(&mut self, o: &Object<'_>, skin: &Skin) -> Result<(), LoadError> {
        let center = o.vector("center")?.unwrap_or([0.0; 3]);
        let radius = o.float("radius")?.unwrap_or(1.0);
        if skin.uv.is_some() {
            return Err(o.unsupported("a texture on a sphere"));
        }
        let Some(scale) = skin.to_world.even_scale() else {
            let expected = "a to_world that turns, moves and scales evenly (it must stay a sphere)";
            return Err(o.error("a to_world that makes it an ellipsoid", expected));
        };
        if (skin.to_world.determinant() < 0.0) != skin.flip {
            return Err(o.unsupported("a sphere whose front is inside"));
        }
        let center = skin.to_world.point(center).map(|x| x as f32);
        self.push_shape(ShapeKind::Sphere { center, radius: (radius * scale) as f32 }, skin);
        Ok(())
    }

    fn disk(&mut self, o: &Object<'_>, skin: &Skin) -> Result<(), LoadError> {
        if skin.uv.is_some() {
            return Err(o.unsupported("a texture on a disk"));
        }
        skin.to_world.affine(o)?;
        let (a, b) = (skin.to_world.column(0), skin.to_world.column(1));
        // The third axis does not matter to a flat shape: take one that makes the transform even.
        let n = unit(cross(a, b)).unwrap_or([0.0; 3]);
        let radius = length(a);
        let flat = Transform::columns([a, b, n.map(|x| x * radius), skin.to_world.column(3)]);
        if flat.even_scale().is_none() {
            let expected = "a to_world that scales evenly within its plane (it must stay a disk)";
            return Err(o.error("a to_world that makes it an ellipse", expected));
        }
        let turned = (skin.to_world.determinant() < 0.0) != skin.flip;
        let normal = n.map(|x| if turned { -x } else { x } as f32);
        let center = skin.to_world.column(3).map(|x| x as f32);
        self.push_shape(ShapeKind::Disk { center, normal, radius: radius as f32 }, skin);
        Ok(())
    }
}

fn mapped(uv: &UvMap, u: f64, v: f64) -> [f32; 2] {
    uv.map(|row| (row[0] * u + row[1] * v + row[2]) as f32)
}

fn reverse(mesh: &mut MeshDesc) {
    for t in &mut mesh.triangles {
        t.swap(1, 2);
    }
}

/// Gives a mesh without normals smooth ones, as scenes of this format expect: the normals of the triangles round
/// a vertex, weighted by their angles there (Thürmer and Wüthrich, Computing vertex normals from polygonal
/// facets, 1998), in the world. A mesh whose triangles are all as flat as that stays without.
fn smooth(mesh: &mut MeshDesc, to_world: &Transform, mirrors: bool) {
    let world = |i: u32| mesh.positions.get(i as usize).map(|p| to_world.point(p.map(f64::from)));
    // Where corners run in the file, the front is on their left; a mirror that compile() undoes turns that.
    let side = if mirrors { -1.0 } else { 1.0 };
    let mut sums = vec![[0.0f64; 3]; mesh.positions.len()];
    let mut flat = Vec::with_capacity(mesh.triangles.len());
    for t in &mesh.triangles {
        let (Some(a), Some(b), Some(c)) = (world(t[0]), world(t[1]), world(t[2])) else { continue };
        let edge = |from: [f64; 3], to: [f64; 3]| unit([0, 1, 2].map(|k| to[k] - from[k]));
        let (Some(ab), Some(bc), Some(ca)) = (edge(a, b), edge(b, c), edge(c, a)) else { continue };
        let Some(n) = unit(cross(ab, bc)).map(|n| n.map(|x| side * x)) else { continue };
        flat.push((*t, n));
        for (corner, e1, e2) in [(t[0], ab, ca), (t[1], bc, ab), (t[2], ca, bc)] {
            // e1 leaves the corner and e2 arrives there.
            let angle = etendue_core::math::atan2(length(cross(e2, e1)) as f32, -dot(e1, e2) as f32);
            for (sum, x) in sums[corner as usize].iter_mut().zip(n) {
                *sum += f64::from(angle) * x;
            }
        }
    }
    let normals: Vec<[f64; 3]> = sums.iter().map(|s| unit(*s).unwrap_or([0.0; 3])).collect();
    let bent = flat.iter().any(|(t, n)| t.iter().any(|i| dot(normals[*i as usize], *n) < 1.0 - 1e-9));
    if !bent {
        return;
    }
    // Back through the transform: normals go by its inverse transposed, whose inverse is the transpose.
    let columns = [0, 1, 2].map(|j| to_world.column(j));
    mesh.normals = normals
        .iter()
        .map(|n| unit(columns.map(|c| dot(c, *n))).unwrap_or([0.0; 3]).map(|x| x as f32))
        .collect();
}

/// What tells materials apart: the surface (or which default) and the bits of its emission.
pub(super) type MaterialKey = (usize, [u32; 3]);

/// Names of materials that were made already.
pub(super) type MaterialNames = HashMap<MaterialKey, (String, Option<UvMap>)>;
