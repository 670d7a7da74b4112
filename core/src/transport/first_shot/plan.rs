//! Which lights have pieces, and in which order pieces come.

use super::{FirstShotError, LitPiece, Subdivision};
use crate::direct::emission::{Bitmap, PieceAlbedo, Published, Pyramid, VertexAlbedo};
use crate::direct::subdivide::Workspace;
use crate::geometry::{HilbertGrid, Intersector};
use crate::light::emit;
use crate::math::Vec3;
use crate::scene::{CompiledScene, NO_INDEX, material_flags};
use crate::transport::volume::LightMedia;
use alloc::vec::Vec;

/// Most (triangle, light) pairs that are looked at; lights beyond are entries of their own. Where so many lights share the flux hardly any pair is worth
/// more than a glance, that is one piece: 60 bytes, and 4 of the index of pairs: 280 MB in all.
const PAIRS_MAX: u64 = 1 << 22;
/// Pairs of one task.
const TASK_PAIRS: usize = 512;
/// Texels that the source's rule scans, and those of a coarser level that ours does. What a photon carries does not depend on it: exact integrals, at 20 us
/// a piece, took ten times as long as all the rest of the precomputation of a textured scene.
const SCAN_TEXELS: f32 = 64.0;
const COARSE_TEXELS: f32 = 24.0;

/// Share of what its brightest texel would send that a piece counts for at least: a coarse level may be darker than a place, and no start shall carry more
/// than eight times its share.
const COARSE_LEAST: f32 = 0.125;

/// What a bitmap reflects within a piece.
pub(super) struct BitmapAlbedo {
    /// As light at each corner meets it.
    pub(super) corners: VertexAlbedo,
    /// At most.
    pub(super) most: Vec3,
    /// The piece counts for at least this share of what it would send with `most`.
    pub(super) least_share: f32,
}

/// How albedos of pieces are found.
enum Albedo<'a> {
    Plain,
    Published(Published<'a>),
    Coarse(Pyramid),
}

/// What is cut, and in which order: light after light, each over the triangles along a Hilbert curve, so that neighbouring starts are neighbours in space.
pub struct StartPlan<'a> {
    pub(super) scene: &'a CompiledScene,
    pub(super) subdivision: Subdivision,
    /// Lights that have pieces.
    pub(super) lights: Vec<u32>,
    /// Triangles in order, and the place of each in it.
    pub(super) order: Vec<u32>,
    pub(super) ranks: Vec<u32>,
    /// Mean flux of all lights without size \[W\].
    pub(super) flux: f32,
    /// The media that lights send into, where light is changed on its way or passes surfaces.
    pub(super) media: Option<&'a LightMedia>,
    albedos: Vec<Albedo<'a>>,
}

impl<'a> StartPlan<'a> {
    /// The plan of a scene; `media`: what its lights send into.
    ///
    /// # Errors
    /// [`FirstShotError::RoundShapes`].
    pub fn new(
        scene: &'a CompiledScene,
        media: &'a LightMedia,
        subdivision: Subdivision,
    ) -> Result<Self, FirstShotError> {
        if !scene.shapes.is_empty() {
            return Err(FirstShotError::RoundShapes { count: scene.shapes.len() });
        }
        let flux_of = |i: u32| emit::mean_flux(scene, i as usize);
        let mut lights: Vec<u32> = (0..scene.lights.len() as u32)
            .filter(|i| emit::is_point_like(&scene.lights[*i as usize]))
            .collect();
        let flux = lights.iter().map(|i| flux_of(*i)).sum();
        let triangles = scene.triangles.len();
        let most = (PAIRS_MAX / triangles.max(1) as u64) as usize;
        if lights.len() > most {
            // The brightest, and of equal ones the first.
            lights.sort_by(|a, b| flux_of(*b).total_cmp(&flux_of(*a)).then(a.cmp(b)));
            lights.truncate(most);
            lights.sort_unstable();
        }
        let grid = HilbertGrid::new(&scene.bounds);
        let mut keyed: Vec<(u32, u32)> = (0..triangles as u32)
            .map(|t| {
                let centroid =
                    scene.primitives().vertices(t).map_or(Vec3::ZERO, |[a, b, c]| (a + b + c) / 3.0);
                (grid.index(centroid), t)
            })
            .collect();
        keyed.sort_unstable();
        let order: Vec<u32> = keyed.into_iter().map(|k| k.1).collect();
        let mut ranks = alloc::vec![0; triangles];
        for (rank, t) in order.iter().enumerate() {
            ranks[*t as usize] = rank as u32;
        }
        let albedos = scene
            .textures
            .iter()
            .map(|t| match (Bitmap::try_new(t, &scene.texels, &scene.srgb_decode), subdivision) {
                (Err(_), _) => Albedo::Plain,
                (Ok(b), Subdivision::Published(..)) => Albedo::Published(Published::new(b, SCAN_TEXELS)),
                (Ok(b), _) => Albedo::Coarse(Pyramid::new(&b)),
            })
            .collect();
        let media = scene.needs.volume().then_some(media);
        Ok(Self { scene, subdivision, lights, order, ranks, flux, media, albedos })
    }

    /// Pairs of a light and a triangle that are to be looked at; see [`Self::pair`].
    pub fn pairs(&self) -> usize {
        self.lights.len() * self.order.len()
    }

    /// Tasks of which each cuts some pairs.
    pub fn tasks(&self) -> usize {
        self.pairs().div_ceil(TASK_PAIRS)
    }

    /// The lit pieces of a task, and the shadow rays that it took. Nothing depends on other tasks; the pieces of all, task after task, are those of [`super::FirstShot::new`].
    pub fn task<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        task: usize,
        workspace: &mut Workspace<f32>,
    ) -> (Vec<LitPiece>, u64) {
        let (mut pieces, mut rays) = (Vec::new(), 0);
        for pair in task * TASK_PAIRS..self.pairs().min((task + 1) * TASK_PAIRS) {
            rays += self.pieces(intersector, pair, workspace, |p| pieces.push(p));
        }
        (pieces, rays)
    }

    /// The light and the triangle of a pair.
    #[inline]
    pub fn numbers(&self, pair: usize) -> Option<(u32, u32)> {
        let count = self.order.len().max(1);
        Some((*self.lights.get(pair / count)?, *self.order.get(pair % count)?))
    }

    /// What the bitmap of a piece with these barycentrics on its triangle reflects; `None` without one.
    pub(super) fn bitmap_albedo(&self, triangle: u32, corners: [[f32; 3]; 3]) -> Option<BitmapAlbedo> {
        let material = self.scene.material_of(triangle);
        let texture = material.texture;
        // What a coat reflects its body's bitmap says nothing of.
        if texture == NO_INDEX || material.flags & material_flags::PLASTIC != 0 {
            return None;
        }
        let at = |i: u32| self.scene.texcoords.get(i as usize).copied().unwrap_or([0.0; 2]);
        let [a, b, c] = self.scene.triangles.get(triangle as usize)?.map(at);
        let uv = corners.map(|w| [0, 1].map(|k| w[0] * a[k] + w[1] * b[k] + w[2] * c[k]));
        match self.albedos.get(texture as usize)? {
            Albedo::Plain => None,
            Albedo::Published(rule) => {
                Some(BitmapAlbedo { corners: rule.vertex_albedo(uv), most: Vec3::ONE, least_share: 0.0 })
            }
            Albedo::Coarse(levels) => Some(BitmapAlbedo {
                corners: levels.coarse(uv, COARSE_TEXELS),
                most: levels.brightest(uv),
                least_share: COARSE_LEAST,
            }),
        }
    }
}
