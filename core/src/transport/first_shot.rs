//! First shot: photons that start on surfaces which lights without size light, instead of at those lights.
//!
//! Direct irradiance is known in closed form, so the first flight and the first absorption need not be gambled: each triangle is cut into pieces
//! over which a light's irradiance is nearly linear ([`crate::direct::subdivide`]), and a photon starts on a (piece, light) pair in proportion to the flux that the
//! pair sends on, at a place drawn from the linear density ([`crate::sampling::linear_triangle`]). Lights with size and the environment are entries by
//! themselves and emit as ever.
//!
//! Weights are those of the source (E. Kopylov, "First Shot"): all starts on a pair carry the same irradiance flux. That is biased where irradiance is not
//! linear over a piece (edges of shadows, mostly); the finer the pieces, the less.
//!
//! With random numbers the gain in photons is 1 / s, s the share of emitted flux that survives its first hit ([`FirstShot::survival`]).

use super::photon::{PICK_GROUP, Photon, PhotonTracer, START_GROUP};
use crate::direct::emission::{EmissionTable, Entry, emission};
use crate::direct::irradiance::from_light;
use crate::direct::subdivide::{Bary, Limits, Published, Robust, Workspace};
use crate::geometry::{Hit, Intersector, Ray, hit_point_with, triangle_area};
use crate::light::emit;
use crate::math::{self, Vec3};
use crate::sampling::discrete::IntegerCdf;
use crate::sampling::linear_triangle;
use crate::sampling::sobol::BlockSampler;
use crate::scene::{CompiledScene, material_flags};
use alloc::vec::Vec;
use core::fmt;

/// By how much samples at the edge of a triangle are drawn towards its centroid, as a share: in the corner of a room they would lie in the next wall.
const PULL: f32 = 0.01;

/// How triangles are cut into pieces, per light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Subdivision {
    /// One piece a triangle.
    None,
    /// The source's rule.
    Published(Published, Limits),
    /// The mended rule.
    Robust(Robust, Limits),
}

impl Subdivision {
    /// The source's rule to 5 %, at most 256 pieces of a triangle.
    pub fn published() -> Self {
        Self::Published(
            Published { relative: 0.05, absolute: 0.0 },
            Limits { budget: 256, ..Limits::default() },
        )
    }

    /// The mended rule to 5 %, at most 256 pieces of a triangle, each of which is looked into at least once.
    pub fn robust() -> Self {
        let limits = Limits { budget: 256, least_depth: 1, ..Limits::default() };
        Self::Robust(Robust { relative: 0.05, ..Robust::default() }, limits)
    }
}

/// A piece of a triangle as one light lights it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitPiece {
    triangle: u32,
    light: u32,
    corners: [Bary; 3],
    /// Mean irradiance of the channels at the corners.
    weights: [f32; 3],
    /// Flux that arrives \[W\], and that leaves at most (the material's colour without its bitmap).
    arriving: [f32; 3],
    emission: [f32; 3],
}

/// Why there is no first shot for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstShotError {
    /// Spheres and disks have no pieces.
    RoundShapes {
        /// How many there are.
        count: usize,
    },
    /// Nothing in the scene emits, or nothing that is lit reflects.
    Dark,
    /// More pieces than an index can name, or a flux that is not finite.
    Table,
}

impl fmt::Display for FirstShotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RoundShapes { count } => {
                write!(
                    f,
                    "photons start on triangles only, and the scene has {count} round shapes: start at the lights"
                )
            }
            Self::Dark => write!(
                f,
                "nothing in the scene emits, or nothing that is lit reflects: no photon has where to start"
            ),
            Self::Table => write!(f, "too many lit pieces, or a flux that is not finite"),
        }
    }
}

impl core::error::Error for FirstShotError {}

/// What a material reflects at most, per channel.
fn reflectance(scene: &CompiledScene, triangle: u32) -> Vec3 {
    let material = scene.material_of(triangle);
    let albedo = Vec3::from_array(material.albedo);
    if material.flags & material_flags::MIRROR != 0 {
        return albedo;
    }
    albedo + Vec3::from_array(material.specular)
}

/// Cuts one triangle for each light without size and hands out its lit pieces; the shadow rays it took.
pub fn lit_pieces<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    triangle: u32,
    subdivision: &Subdivision,
    workspace: &mut Workspace<f32>,
    mut emit_piece: impl FnMut(LitPiece),
) -> u64 {
    let Some(v) = scene.primitives().vertices(triangle) else { return 0 };
    let area = triangle_area(v);
    let ka = reflectance(scene, triangle);
    if area <= 0.0 || ka == Vec3::ZERO {
        return 0;
    }
    let surface = scene.surfaces[triangle as usize];
    let n = Vec3::from_array(surface.normal);
    let mut rays = 0;
    for (index, light) in scene.lights.iter().enumerate().filter(|(_, l)| emit::is_point_like(l)) {
        let brightest = Vec3::from_array(light.radiance);
        // All of a light's irradiance has its colour: one number is enough.
        let scale = math::mean(brightest);
        let colour = brightest / scale;
        let mut sample = |b: [f32; 3]| {
            let [_, b1, b2] = b.map(|x| x * (1.0 - PULL) + PULL / 3.0);
            let point = hit_point_with(v, b1, b2, surface.sliver);
            let Some((e, ray)) = from_light(light, &point, n) else { return 0.0 };
            rays += 1;
            if intersector.occluded(&ray) { 0.0 } else { math::mean(e) }
        };
        let mut keep = |corners: [Bary; 3], irradiance: [f32; 3], fraction: f32| {
            let e = irradiance.map(|x| colour * x);
            let arriving = emission(Vec3::ONE, area * fraction, e);
            if arriving == Vec3::ZERO {
                return;
            }
            emit_piece(LitPiece {
                triangle,
                light: index as u32,
                corners,
                weights: irradiance,
                arriving: arriving.to_array(),
                emission: (arriving * ka).to_array(),
            });
        };
        match subdivision {
            Subdivision::None => keep(Bary::CORNERS, Bary::CORNERS.map(|c| sample(c.to_f32())), 1.0),
            Subdivision::Published(criterion, limits) => {
                workspace
                    .subdivide(v, criterion, limits, sample, |p| keep(p.corners, p.irradiance, p.fraction));
            }
            Subdivision::Robust(criterion, limits) => {
                workspace
                    .subdivide(v, criterion, limits, sample, |p| keep(p.corners, p.irradiance, p.fraction));
            }
        }
    }
    rays
}

/// The density from which first-shot photons start.
#[derive(Clone, Debug)]
pub struct FirstShot {
    pieces: Vec<LitPiece>,
    table: EmissionTable,
    density: IntegerCdf,
    sphere: (Vec3, f32),
    /// Flux of the lights without size \[W\].
    emitted: [f64; 3],
}

impl FirstShot {
    /// The density over pieces in the order given (that of triangles, for photons of neighbouring numbers to fly alike), and over the other lights.
    ///
    /// # Errors
    /// [`FirstShotError`].
    pub fn new(scene: &CompiledScene, pieces: Vec<LitPiece>) -> Result<Self, FirstShotError> {
        if !scene.shapes.is_empty() {
            return Err(FirstShotError::RoundShapes { count: scene.shapes.len() });
        }
        let sphere = scene.bounding_sphere();
        let mut table = EmissionTable::new();
        for (index, piece) in pieces.iter().enumerate() {
            let e = Vec3::from_array(piece.emission);
            table.push_pair(index as u32, piece.light, e, e).map_err(|_| FirstShotError::Table)?;
        }
        let mut emitted = [0.0; 3];
        for (index, light) in scene.lights.iter().enumerate() {
            let flux = emit::flux(light, sphere.1);
            if emit::is_point_like(light) {
                for (sum, x) in emitted.iter_mut().zip(flux.to_array()) {
                    *sum += f64::from(x);
                }
            } else {
                table.push_light(index as u32, flux).map_err(|_| FirstShotError::Table)?;
            }
        }
        let environment = Vec3::from_array(scene.environment);
        if environment != Vec3::ZERO {
            let flux = emit::environment_flux(environment, sphere.1);
            table.push_light(scene.lights.len() as u32, flux).map_err(|_| FirstShotError::Table)?;
        }
        let density = table.density().map_err(|_| FirstShotError::Dark)?;
        Ok(Self { pieces, table, density, sphere, emitted })
    }

    /// Flux that all starts carry between them \[W\] per channel.
    pub fn total(&self) -> [f64; 3] {
        self.table.sum().flux_f64()
    }

    /// Number of (piece, light) pairs.
    pub fn pairs(&self) -> usize {
        self.pieces.len()
    }

    /// Flux that leaves the lit pieces \[W\] per channel, bitmaps not counted.
    pub fn reflected(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for piece in &self.pieces {
            for (s, x) in sum.iter_mut().zip(piece.emission) {
                *s += f64::from(x);
            }
        }
        sum
    }

    /// s: the share of the flux of lights without size, mean of the channels, that survives its first hit. 0 without such lights.
    pub fn survival(&self) -> f64 {
        let (out, all): (f64, f64) = (self.reflected().iter().sum(), self.emitted.iter().sum());
        if all > 0.0 { out / all } else { 0.0 }
    }

    /// A photon from the density; `None` where the surface at the place drawn lets nothing through.
    #[inline]
    pub fn start<const L: bool, const T: bool, const S: bool>(
        &self,
        scene: &CompiledScene,
        tracer: &PhotonTracer<'_, L, T, S>,
        sampler: BlockSampler,
    ) -> Option<Photon> {
        let pick = self.density.pick(sampler.bits2(PICK_GROUP)[0]);
        let u = sampler.group4(START_GROUP);
        match self.table.entries().get(pick.index as usize)? {
            Entry::Light { light } => {
                let emission = match scene.lights.get(*light as usize) {
                    Some(light) => emit::emit(light, self.sphere, u),
                    None => emit::emit_environment(Vec3::from_array(scene.environment), self.sphere, u),
                };
                Some(Photon::new(sampler, emission.ray, emission.flux / pick.pmf))
            }
            Entry::Pair { piece, light } => {
                let piece = self.pieces.get(*piece as usize)?;
                let light = scene.lights.get(*light as usize)?;
                let on_piece = linear_triangle::sample(piece.weights, [u[0], u[1]]);
                let mut b = [0.0; 3];
                for (share, corner) in on_piece.into_iter().zip(piece.corners) {
                    for (b, c) in b.iter_mut().zip(corner.to_f32()) {
                        *b += share * c;
                    }
                }
                let v = scene.primitives().vertices(piece.triangle)?;
                let point = v[0] * b[0] + v[1] * b[1] + v[2] * b[2];
                // The density is linear, and so a little more than nothing beyond a spot's cone or in a shadow's edge: what starts there counts.
                let ray = Ray { origin: point, direction: -emit::toward(light, point), t_max: f32::MAX };
                let hit = Hit { t: 0.0, primitive: piece.triangle, b1: b[1], b2: b[2] };
                tracer.start_on_surface(&hit, &ray, Vec3::from_array(piece.arriving) / pick.pmf, sampler)
            }
        }
    }
}
