//! Photons on their way through media and through surfaces that light passes.
//!
//! A flight ends in a medium with a density in proportion to its extinction, weighted for all channels ([`crate::medium::Medium::fly`]); there it is scattered by the phase function, with
//! the scattering share of what it carries. Null boundaries are passed; panes, and dielectrics without a finish, reflect a photon or let it through. Flux is not squeezed by an index as radiance is. What has
//! scattered, reflected or refracted a photon counts as a hit, at which nothing is registered; what it passes straight on does not, so that a light without size is known in closed form beyond it.

use super::{Photon, PhotonFlight, PhotonTracer, SURVIVAL_MAX};
use crate::bsdf::Interface;
use crate::geometry::{Hit, Intersector, Ray};
use crate::light::emit;
use crate::math::{self, Vec3};
use crate::medium::{Inside, Medium, phase};
use crate::sampling::{numbers::Numbers, warp};
use crate::scene::{NO_INDEX, material_flags};
use crate::transport::back::choose_colour;
use crate::transport::volume::{CROSSINGS_MAX, boundaries::resolve};
use crate::transport::{Surface, surface_at};

/// The first of the groups of numbers for what happens between hits, two an event.
const EVENT_GROUP: u32 = 1 << 20;
/// The direction of a photon that starts in a medium.
const GLOW_GROUP: u32 = EVENT_GROUP - 1;

/// What a photon knows of its way: nothing, or what it flies through.
pub trait Way: Copy + Default + Send + Sync + 'static {
    /// Light is changed on its way, or passes surfaces.
    const VOLUME: bool;
    /// In these media, for a photon of number `id`.
    fn new(inside: Inside, id: u32) -> Self;
    /// It, if there is anything to know.
    fn through(&mut self) -> Option<&mut Through>;
}

impl Way for () {
    const VOLUME: bool = false;

    fn new(_: Inside, _: u32) -> Self {}

    fn through(&mut self) -> Option<&mut Through> {
        None
    }
}

/// What a photon flies through.
#[derive(Clone, Copy, Debug, Default)]
pub struct Through {
    /// The media in which its ray starts.
    pub inside: Inside,
    /// Where it has landed: those beyond the surface.
    pub(super) beyond: Inside,
    /// What lies between the surface that its ray left and where it starts \[m\].
    lead: f32,
    /// Names its numbers.
    id: u32,
    event: u32,
    /// The chance to have come straight from its light, while [`Photon::light`] names one.
    pub(in crate::transport) chance: f32,
    /// The channel of a photon that was refracted by its colour.
    channel: Option<u8>,
}

impl Way for Through {
    const VOLUME: bool = true;

    fn new(inside: Inside, id: u32) -> Self {
        Self { inside, id, chance: 1.0, ..Self::default() }
    }

    fn through(&mut self) -> Option<&mut Through> {
        Some(self)
    }
}

impl Through {
    /// The numbers of what happens next, eight of them.
    fn numbers(&mut self, random: &Numbers) -> ([f32; 4], [f32; 4]) {
        let mine = random.with_index(self.id);
        let group = EVENT_GROUP + 2 * self.event;
        self.event += 1;
        (mine.group4(group), mine.group4(group + 1))
    }
}

/// What a flight came to.
enum End {
    Landed(Hit),
    Goes,
    Over,
}

/// Sends a photon on with this share of the flux that it had, if it survives the roulette.
fn survives<W>(photon: &mut Photon<W>, before: Vec3, survive: f32) -> bool {
    let (had, has) = (math::mean(before), math::mean(photon.flux));
    let chance = (has / had.max(f32::MIN_POSITIVE)).min(SURVIVAL_MAX);
    if survive < chance {
        photon.flux /= chance;
    }
    survive < chance
}

impl<W: Way> PhotonFlight<'_, W> {
    /// A photon that has just left what emits it; see [`Self::begin`].
    #[inline(never)]
    pub(super) fn begin_through<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        mut photon: Photon,
        (index, id): (u32, u32),
        random: &Numbers,
    ) -> Photon<W> {
        let inside = self.lights.of(self.scene, intersector, index as usize, photon.ray.origin);
        if let Some(glow) = emit::glow(self.scene, index as usize) {
            // Only where the medium counts does it emit.
            let medium = self.scene.media.get(usize::from(glow.medium) - 1);
            let counts = match (medium, inside.current(self.scene)) {
                (Some(medium), Some(found)) => core::ptr::eq(medium, found),
                _ => false,
            };
            if !counts {
                photon.flux = Vec3::ZERO;
            }
            let [u, v, ..] = random.with_index(id).group4(GLOW_GROUP);
            photon.ray.direction = warp::sample_sphere([u, v]);
        }
        photon.along(W::new(inside, id))
    }

    /// Where a photon lands.
    #[inline(never)]
    pub(super) fn fly_through<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        photon: &mut Photon<W>,
        random: &Numbers,
        rays: &mut u64,
    ) -> Option<Hit> {
        let mut crossed = 0;
        if photon.flux == Vec3::ZERO {
            return None;
        }
        loop {
            *rays += 1;
            let hit = intersector.closest_hit(&photon.ray);
            let before = photon.hits;
            match self.arrive(photon, hit, random) {
                End::Landed(hit) => return Some(hit),
                End::Over => return None,
                End::Goes => crossed = if photon.hits > before { 0 } else { crossed + 1 },
            }
            if crossed > CROSSINGS_MAX {
                return None;
            }
        }
    }

    /// A photon has flown up to a surface, or has met nothing.
    fn arrive(&self, photon: &mut Photon<W>, hit: Option<Hit>, random: &Numbers) -> End {
        let Photon { ray, flux: before, .. } = *photon;
        let Some(way) = photon.way.through() else { return End::Over };
        let ([u, v, x, y], [choice, colour, survive, _]) = way.numbers(random);
        let inside = way.inside;
        if let Some(medium) = inside.current(self.scene).map(|m| Medium::new(self.scene, m)) {
            let lead = way.lead;
            let limit = hit.map_or(f32::INFINITY, |h| lead + h.t);
            let flown = medium.fly(&ray, lead, limit, before, [u, v]);
            way.chance *= math::mean(flown.left);
            photon.flux *= flown.weight;
            if flown.collided {
                let position = ray.origin + ray.direction * (flown.length - lead);
                way.lead = 0.0;
                photon.flux *= medium.sigma_s_at(position);
                let direction = phase::sample(medium.g, -ray.direction, [x, y]);
                photon.ray = Ray { origin: position, direction, t_max: f32::MAX };
                photon.caustic = false;
                return self.on(photon, before, survive);
            }
        }
        let Some(hit) = hit else { return End::Over };
        let (hit, beyond) = resolve(self.scene, &ray, hit, inside);
        let Some(surface) = surface_at::<true, true, true>(self.scene, &ray, &hit) else {
            return End::Over;
        };
        if self.scene.material_of(hit.primitive).flags & material_flags::NULL != 0 {
            return pass(photon, &surface, beyond);
        }
        let Some(way) = photon.way.through() else { return End::Over };
        if surface.interface == Interface::Opaque {
            way.beyond = beyond;
            return End::Landed(hit);
        }
        let mut channel = usize::from(way.channel.unwrap_or(0));
        if surface.interface.disperses() {
            channel = choose_colour(&mut way.channel, &mut photon.flux, colour);
        }
        let Some(passage) = surface.passage::<true>(channel, choice) else { return End::Over };
        let (there, here) = (passage.wi.dot(surface.geometric), surface.wo.dot(surface.geometric));
        if passage.through
            && let Some((_, chance)) = surface.interface.straight()
        {
            way.chance *= chance;
            photon.flux *= passage.weight;
            return pass(photon, &surface, beyond);
        }
        let before = photon.flux;
        if passage.through {
            way.inside = beyond;
        } else {
            photon.flux *= passage.weight;
        }
        let origin = surface.leave(passage.wi);
        way.lead = surface.lead(origin, passage.wi);
        let turned = surface.wo.dot(surface.shading) * there / (here * passage.wi.dot(surface.shading));
        photon.flux *= math::abs(turned).min(16.0);
        photon.ray = Ray { origin, direction: passage.wi, t_max: f32::MAX };
        self.on(photon, before, survive)
    }

    /// A photon that was sent on goes on, if it may.
    fn on(&self, photon: &mut Photon<W>, before: Vec3, survive: f32) -> End {
        photon.hits += 1;
        photon.light = NO_INDEX;
        if photon.hits < self.max_hits && survives(photon, before, survive) { End::Goes } else { End::Over }
    }
}

impl<W: Way, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    PhotonTracer<'_, W, LOBES, TEXTURES, SHADING>
{
    /// A direction in which flux leaves the surface on which a photon has landed, what it is multiplied by, and whether a mirror sends it there; see [`Self::leave`].
    #[inline(never)]
    pub(super) fn leave_through(
        &self,
        photon: &mut Photon<W>,
        surface: &Surface,
        u: [f32; 2],
        lobe: f32,
    ) -> Option<(Vec3, Vec3, bool)> {
        let way = photon.way.through()?;
        let mut lobes = surface.lobes;
        let mut lobe = lobe;
        if lobes.disperses() {
            // The colour is a third of the number, and what is left of that as good as new.
            let channel = choose_colour(&mut way.channel, &mut photon.flux, lobe);
            lobe = 3.0 * lobe - (3.0 * lobe) as u32 as f32;
            lobes = lobes.of_channel(channel);
        }
        let (n, g, wo) = (surface.shading, surface.geometric, surface.wo);
        let s = lobes.sample(n, wo, u, lobe)?;
        let (there, here) = (s.wi.dot(g), wo.dot(g));
        // Below both normals, or above both.
        if (there > 0.0) != (s.wi.dot(n) > 0.0) || there <= 0.0 && !lobes.transmits() {
            return None;
        }
        if there < 0.0 {
            way.inside = way.beyond;
        }
        way.lead = surface.lead(surface.leave(s.wi), s.wi);
        let mut weight = s.weight * lobes.index_ratio_squared(n, wo, s.wi);
        if SHADING {
            let down = here * s.wi.dot(n);
            weight *= math::abs(wo.dot(n) * there / down).min(16.0);
        }
        Some((s.wi, weight, s.pdf == 0.0))
    }
}

/// Straight on, beyond a boundary.
fn pass<W: Way>(photon: &mut Photon<W>, surface: &Surface, beyond: Inside) -> End {
    let Some(way) = photon.way.through() else { return End::Over };
    way.inside = beyond;
    photon.ray.origin = surface.leave(photon.ray.direction);
    way.lead = surface.lead(photon.ray.origin, photon.ray.direction);
    if photon.flux == Vec3::ZERO { End::Over } else { End::Goes }
}
