//! The density from which photons start, and what they carry.

use super::pieces::{LitPiece, colour};
use super::place::{SLACK, density, on_triangle, within};
use super::weight::{light_density, light_share, look_factor, piece_flux, start_flux};
use super::{FirstShotError, StartPlan, Weights};
use crate::direct::emission::EmissionTable;
use crate::direct::irradiance::from_light;
use crate::geometry::{Hit, Ray, hit_point_with, offset_origin, segment};
use crate::light::emit;
use crate::math::{self, Vec3};
use crate::sampling::discrete::IntegerCdf;
use crate::sampling::linear_triangle;
use crate::scene::{CompiledScene, NO_INDEX};
use crate::transport::photon::{Photon, Way};
use crate::transport::volume::Straight;
use alloc::vec::Vec;

/// Least share of the photons of lights with pieces that come from the lights where light can be scattered or refracted before it lands: such light starts on no piece. With weights as published all others of them are
/// left out.
const ASTRAY: f32 = 0.5;

/// How a photon begins.
#[derive(Clone, Copy, Debug)]
pub enum Start {
    /// From this entry of what emits: it is on its way.
    Flies(Photon, u32),
    /// On a surface: it has arrived, straight from a light.
    Lands {
        /// The photon; its ray leads from the light's direction.
        photon: Photon,
        /// Where.
        hit: Hit,
        /// If there is one, [`Photon::flux`] must be multiplied by [`Look::factor`] of whether this ray is blocked, or by [`Look::through`] of what the way leaves of the light.
        look: Option<Look>,
    },
}

/// A shadow ray of a start, traced for one start in so many.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// From the place to the light.
    pub ray: Ray,
    /// The light.
    pub light: u32,
    /// Unit normal of the place.
    pub normal: Vec3,
    /// Chance with which it is traced.
    chance: f32,
    /// Densities per area of starts on the pieces, and of photons straight from the light if nothing were in their way. Of pieces that are not weighted exactly, both 0.
    densities: [f32; 2],
    /// The light's colour.
    colour: Vec3,
}

impl Look {
    /// What the start's flux is multiplied by; see [`look_factor`].
    #[inline]
    pub fn factor(&self, blocked: bool) -> f32 {
        look_factor(self.chance, blocked)
    }

    /// What the flux of a start is multiplied by where this is left of the light: photons from the light come through with some chance only, and its start takes what they leave. With weights as published it
    /// gives the colour alone: what is left of the channels' mean is in the densities.
    #[inline]
    pub fn through(&self, straight: &Straight) -> Vec3 {
        let [here, there] = self.densities;
        if here + there > 0.0 {
            return straight.left * ((here + there) / (here + there * straight.chance));
        }
        let mean = math::mean(self.colour * straight.left);
        if mean > 0.0 { straight.left / mean } else { Vec3::ONE }
    }
}

/// A light, or the environment, as an entry of the density after the pieces.
#[derive(Clone, Copy, Debug)]
struct LightEntry {
    light: u32,
    /// Starts here are combined with those on the light's pieces.
    shared: bool,
}

/// The density as a device samples it, beside its pieces.
#[derive(Clone, Debug)]
pub struct FirstShotParts<'a> {
    /// Counts of pieces and of the entries after them.
    pub cumulative: &'a [u32],
    /// The number of what emits, and whether starts there are combined with those on its pieces.
    pub entries: Vec<(u32, bool)>,
    /// Per light with pieces and triangle in order: where its pieces begin; one more at the end.
    pub ranges: &'a [u32],
    /// The place of each triangle in the order.
    pub ranks: &'a [u32],
    /// Of each light its place among those with pieces, [`NO_INDEX`] without any.
    pub slots: &'a [u32],
    /// Of each light the chance per watt \[1/W\] with which a start is from it and combined with its pieces.
    pub per_watt: &'a [f32],
    /// Whether starts are weighted exactly.
    pub exact: bool,
}

/// The density from which first-shot photons start.
#[derive(Clone, Debug)]
pub struct FirstShot {
    pieces: Vec<LitPiece>,
    entries: Vec<LightEntry>,
    density: IntegerCdf,
    /// Per light and triangle in order: where its pieces begin; one more at the end.
    ranges: Vec<u32>,
    ranks: Vec<u32>,
    /// Per light: its place among those with pieces, and the chance per watt with which a start is from it and combined with its pieces.
    slots: Vec<u32>,
    per_watt: Vec<f32>,
    exact: bool,
    sphere: (Vec3, f32),
    emitted: f64,
    reflected: f64,
}

impl FirstShot {
    /// The density over pieces, which must come in the order of the plan's pairs, and over the other lights.
    ///
    /// # Errors
    /// [`FirstShotError`].
    pub fn new(
        plan: &StartPlan<'_>,
        pieces: Vec<LitPiece>,
        weights: Weights,
    ) -> Result<Self, FirstShotError> {
        let scene = plan.scene;
        let sphere = scene.bounding_sphere();
        let mut slots = alloc::vec![NO_INDEX; scene.lights.len()];
        for (slot, light) in plan.lights.iter().enumerate() {
            slots[*light as usize] = slot as u32;
        }
        if u32::try_from(pieces.len()).is_err() {
            return Err(FirstShotError::Table);
        }
        let triangles = plan.order.len();
        let mut ranges = alloc::vec![0_u32; plan.pairs() + 1];
        for p in &pieces {
            let pair =
                slots[p.light as usize] as usize * triangles + plan.ranks[p.triangle as usize] as usize;
            ranges[pair + 1] += 1;
        }
        for i in 1..ranges.len() {
            ranges[i] += ranges[i - 1];
        }
        let share = match weights {
            Weights::Density if scene.needs.volume() => ASTRAY,
            Weights::Density => 0.0,
            Weights::Exact { share } if scene.needs.volume() && share > 0.0 && share < ASTRAY => ASTRAY,
            Weights::Exact { share } if share > 0.0 && share < 1.0 => share,
            Weights::Exact { .. } => return Err(FirstShotError::Share),
        };
        let flux = |light: usize| emit::mean_flux(scene, light);
        let mut table = EmissionTable::new();
        for (index, piece) in pieces.iter().enumerate() {
            // Importances are not 0, so that entry and piece have one number.
            let sent = Vec3::splat(piece.importance);
            table.push_pair(index as u32, piece.light, sent, sent).map_err(|_| FirstShotError::Table)?;
        }
        let reflected = table.sum().importance();
        let paired: f32 = plan.lights.iter().map(|l| flux(*l as usize)).sum();
        // Where no piece was found to be lit, all start at the lights.
        let sent = if reflected > 0.0 { share / (1.0 - share) * reflected } else { share * paired };
        let mut entries = Vec::new();
        let mut emitted = 0.0;
        for light in 0..emit::entries(scene) {
            let watts = flux(light);
            if scene.lights.get(light).is_some_and(emit::is_point_like) {
                emitted += f64::from(watts);
            }
            let shared = slots.get(light).is_some_and(|slot| *slot != NO_INDEX);
            let weight = Vec3::splat(if shared { sent * (watts / paired) } else { watts });
            if table.push_light(light as u32, weight).map_err(|_| FirstShotError::Table)? {
                entries.push(LightEntry { light: light as u32, shared });
            }
        }
        let density = table.density().map_err(|_| FirstShotError::Dark)?;
        let mut per_watt = alloc::vec![0.0; scene.lights.len()];
        for (i, entry) in entries.iter().enumerate().filter(|(_, e)| e.shared) {
            let pmf = density.pmf((pieces.len() + i) as u32);
            per_watt[entry.light as usize] = pmf / flux(entry.light as usize);
        }
        let (ranks, exact) = (plan.ranks.clone(), weights != Weights::Density);
        Ok(Self {
            pieces,
            entries,
            density,
            ranges,
            ranks,
            slots,
            per_watt,
            exact,
            sphere,
            emitted,
            reflected: f64::from(reflected),
        })
    }

    /// Number of (piece, light) pairs.
    pub fn pairs(&self) -> usize {
        self.pieces.len()
    }

    /// The pieces, light after light.
    pub fn pieces(&self) -> &[LitPiece] {
        &self.pieces
    }

    /// What a device needs of it.
    pub fn parts(&self) -> FirstShotParts<'_> {
        FirstShotParts {
            cumulative: self.density.cumulative(),
            entries: self.entries.iter().map(|e| (e.light, e.shared)).collect(),
            ranges: &self.ranges,
            ranks: &self.ranks,
            slots: &self.slots,
            per_watt: &self.per_watt,
            exact: self.exact,
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.pieces.len() * (size_of::<LitPiece>() + 4)
            + 4 * (self.ranges.len() + self.ranks.len() + self.slots.len() + self.per_watt.len())
    }

    /// Flux that leaves the lit pieces \[W\], mean of the channels.
    pub fn reflected(&self) -> f64 {
        self.reflected
    }

    /// s: the share of the flux of lights without size, mean of the channels, that survives its first hit. 0 without such lights.
    pub fn survival(&self) -> f64 {
        if self.emitted > 0.0 { self.reflected / self.emitted } else { 0.0 }
    }

    /// A start: `pick` chooses the entry; `u` the place (0 and 1) and whether a shadow ray is asked for (3), or the light's photon (all four).
    #[inline]
    pub fn start(&self, scene: &CompiledScene, pick: u32, u: [f32; 4]) -> Option<Start> {
        let pick = self.density.pick(pick);
        let Some(piece) = self.pieces.get(pick.index as usize) else {
            let entry = self.entries.get(pick.index as usize - self.pieces.len())?;
            return Some(Start::Flies(self.fly(scene, entry, pick.pmf, u), entry.light));
        };
        let light = scene.lights.get(piece.light as usize)?;
        let on_piece = linear_triangle::sample(piece.weights, [u[0], u[1]]);
        let b = on_triangle(piece.corners, on_piece);
        let v = scene.primitives().vertices(piece.triangle)?;
        let surface = scene.surfaces.get(piece.triangle as usize)?;
        let point = hit_point_with(v, b[1], b[2], surface.sliver);
        let ray =
            Ray { origin: point.position, direction: -emit::toward(light, point.position), t_max: f32::MAX };
        let hit = Hit { t: 0.0, primitive: piece.triangle, b1: b[1], b2: b[2] };
        let (normal, volume) = (Vec3::from_array(surface.normal), scene.needs.volume());
        // To where the light is, should it send nothing here.
        let back = segment(offset_origin(&point, normal, -ray.direction), Vec3::from_array(light.point));
        let mut look = Look {
            ray: back,
            light: piece.light,
            normal,
            chance: piece.looks,
            densities: [0.0; 2],
            colour: colour(light),
        };
        let (flux, looks) = if self.exact {
            let (e, shadow) = from_light(light, &point, normal)?;
            let density = density(pick.pmf, piece.weights, piece.area, on_piece);
            let per_watt = self.per_watt[piece.light as usize];
            look.ray = shadow;
            look.densities = [density, light_density(e, per_watt)];
            (start_flux(e, density, per_watt), u[3] < piece.looks)
        } else {
            // The density is linear, and so a little more than nothing beyond a spot's cone or in a shadow's edge: what starts there counts.
            if volume && let Some((_, shadow)) = from_light(light, &point, normal) {
                look.ray = shadow;
            }
            (piece_flux(look.colour, piece.weights, piece.area, pick.pmf), volume)
        };
        let look = looks.then_some(look);
        let photon =
            Photon { registers_first: false, caustic: true, survives_first: true, ..Photon::new(ray, flux) };
        Some(Start::Lands { photon, hit, look })
    }

    fn fly(&self, scene: &CompiledScene, entry: &LightEntry, pmf: f32, u: [f32; 4]) -> Photon {
        let (e, point_like) = emit::emit_entry(scene, entry.light as usize, self.sphere, u);
        let photon = Photon::new(e.ray, e.flux / pmf);
        if entry.shared {
            return Photon {
                light: entry.light,
                registers_first: false,
                caustic: true,
                survives_first: true,
                ..photon
            };
        }
        Photon { registers_first: !point_like, caustic: point_like, ..photon }
    }

    /// Weighs a photon that has come straight from a light with pieces against a start where it has landed (the balance heuristic). Weights as published know one way alone to start there.
    #[inline]
    pub fn weigh<W: Way>(&self, scene: &CompiledScene, photon: &mut Photon<W>, hit: &Hit) {
        let index = core::mem::replace(&mut photon.light, NO_INDEX);
        if !self.exact {
            photon.flux = Vec3::ZERO;
            return;
        }
        let (Some(light), Some(surface)) =
            (scene.lights.get(index as usize), scene.surfaces.get(hit.primitive as usize))
        else {
            return;
        };
        let Some(v) = scene.primitives().vertices(hit.primitive) else { return };
        let point = hit_point_with(v, hit.b1, hit.b2, surface.sliver);
        let Some((e, _)) = from_light(light, &point, Vec3::from_array(surface.normal)) else { return };
        let e = photon.way.through().map_or(e, |way| e * way.chance);
        photon.flux *= light_share(e, self.density_at(index, hit), self.per_watt[index as usize]);
    }

    /// Density per area \[1/m^2\] of starts on the pieces of one light at a point of a triangle.
    pub fn density_at(&self, light: u32, hit: &Hit) -> f32 {
        let (Some(slot), Some(rank)) =
            (self.slots.get(light as usize), self.ranks.get(hit.primitive as usize))
        else {
            return 0.0;
        };
        if *slot == NO_INDEX {
            return 0.0;
        }
        let pair = *slot as usize * self.ranks.len() + *rank as usize;
        let (Some(from), Some(to)) = (self.ranges.get(pair), self.ranges.get(pair + 1)) else { return 0.0 };
        // Of two pieces that meet at the point either would do; of pieces with gaps of rounding between them, the nearest.
        let mut best: Option<(f32, u32, [f32; 3])> = None;
        for index in *from..*to {
            let Some(bary) = within(self.pieces[index as usize].corners, [hit.b1, hit.b2]) else { continue };
            let least = math::min(bary[0], math::min(bary[1], bary[2]));
            if best.is_none_or(|b| least > b.0) {
                best = Some((least, index, bary));
            }
            if least >= 0.0 {
                break;
            }
        }
        // Some parts of a triangle have no piece: those that are dark.
        let Some((_, index, bary)) = best.filter(|b| b.0 >= -SLACK) else { return 0.0 };
        let piece = &self.pieces[index as usize];
        density(self.density.pmf(index), piece.weights, piece.area, bary)
    }
}
