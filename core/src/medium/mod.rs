//! Participating media: how far light flies, how it is scattered, and which medium a point lies in.
//!
//! Extinction sigma_t = sigma_a + sigma_s \[1/m\] per channel, the same everywhere or scaled by a density from place to place ([`grid`]). A flight is left by T, exp of minus the integral of
//! sigma_t along it; at its end light is scattered by sigma_s p, p the phase function ([`phase`]). Distances are drawn by one of the channels, and weighted so that all channels share them
//! ([`flight`]). [`Medium`] is the one door for whoever flies: it knows which of the two a medium is. Which medium a point lies in is what the boundaries crossed on the way say ([`Inside`]).

pub mod flight;
pub mod grid;
mod inside;
pub mod phase;

pub use inside::{INSIDE_MAX, Inside};

use crate::geometry::Ray;
use crate::math::{self, Vec3};
use crate::scene::{CompiledScene, MediumRecord, NO_INDEX};
use flight::Flight;
use grid::{Grid, regular};

/// What a medium is to a ray.
///
/// Rays have unit directions; lengths are metres from `lead` before the ray's origin on (what lies between the surface that the ray left and where it starts).
#[derive(Clone, Copy, Debug)]
pub struct Medium<'a> {
    /// Extinction \[1/m\] per channel, where the density is 1.
    pub sigma_t: Vec3,
    /// Scattering \[1/m\] per channel, where the density is 1 and no grid of albedos says otherwise.
    pub sigma_s: Vec3,
    /// Radiance emitted per metre \[W m^-3 sr^-1\] per channel, whatever the density.
    pub emission: Vec3,
    /// Henyey-Greenstein mean cosine.
    pub g: f32,
    scene: &'a CompiledScene,
    density: u32,
    albedo: u32,
}

impl<'a> Medium<'a> {
    /// From the compiled scene.
    #[inline(always)]
    pub fn new(scene: &'a CompiledScene, record: &MediumRecord) -> Self {
        let sigma_s = Vec3::from_array(record.sigma_s);
        Self {
            sigma_t: Vec3::from_array(record.sigma_a) + sigma_s,
            sigma_s,
            emission: Vec3::from_array(record.emission),
            g: record.g,
            scene,
            density: record.density_grid,
            albedo: record.albedo_grid,
        }
    }

    /// The same everywhere.
    #[inline(always)]
    pub fn is_homogeneous(&self) -> bool {
        self.density == NO_INDEX && self.albedo == NO_INDEX
    }

    /// The grid that scales extinction.
    #[inline(always)]
    pub fn density(&self) -> Option<Grid<'a>> {
        if self.density == NO_INDEX { None } else { Grid::new(self.scene, self.density) }
    }

    /// Draws a flight of at most `limit` \[m\] (infinite where there is no surface) for a path that carries `carried`. u in [0, 1): the channel, the length.
    ///
    /// With p_c the chance of channel c ([`flight::channels`]) and T_c its transmittance, the density of a collision at t is the sum of p_c sigma_t,c(t) T_c(t), the chance to get through that of
    /// p_c T_c; the weight is T over it.
    #[inline(always)]
    pub fn fly(&self, ray: &Ray, lead: f32, limit: f32, carried: Vec3, u: [f32; 2]) -> Flight {
        match self.density() {
            None => flight::sample(self.sigma_t, carried, limit, u),
            Some(grid) => self.fly_through(&grid, ray, lead, limit, carried, u),
        }
    }

    #[inline(never)]
    fn fly_through(
        &self,
        grid: &Grid<'_>,
        ray: &Ray,
        lead: f32,
        limit: f32,
        carried: Vec3,
        u: [f32; 2],
    ) -> Flight {
        let p = flight::channels(carried);
        let channel = flight::pick(p, u[0]);
        let sigma = self.sigma_t[channel];
        let wanted = if sigma > 0.0 { -math::ln(1.0 - u[1]) / sigma } else { f32::INFINITY };
        let line = grid.line(ray.origin - ray.direction * lead, ray.direction);
        let reached = regular::fly(grid, &line, limit, wanted, channel);
        let left = flight::transmittance_of(self.sigma_t, reached.optical);
        let (length, density) = match reached.length {
            // The extinction where the flight is said to end, as scattering sees it.
            Some(t) => (t, p.dot(self.sigma_t_at(ray.origin + ray.direction * (t - lead)) * left)),
            None => (limit, p.dot(left)),
        };
        let weight = if density > 0.0 { left / density } else { Vec3::ZERO };
        Flight { length, collided: reached.length.is_some(), weight, left }
    }

    /// What is left of light after a length \[m\] along a ray, per channel.
    #[inline(always)]
    pub fn transmittance(&self, ray: &Ray, lead: f32, length: f32) -> Vec3 {
        match self.density() {
            None => flight::transmittance(self.sigma_t, length),
            Some(grid) => self.transmittance_through(&grid, ray, lead, length),
        }
    }

    #[inline(never)]
    fn transmittance_through(&self, grid: &Grid<'_>, ray: &Ray, lead: f32, length: f32) -> Vec3 {
        let line = grid.line(ray.origin - ray.direction * lead, ray.direction);
        flight::transmittance_of(self.sigma_t, regular::optical_length(grid, &line, length, self.sigma_t))
    }

    /// Where on the way from 0 to `limit` \[m\] there may be any extinction.
    #[inline(always)]
    pub(crate) fn extent(&self, ray: &Ray, lead: f32, limit: f32) -> Option<[f32; 2]> {
        match self.density() {
            None => Some([0.0, limit]),
            Some(grid) => {
                let line = grid.line(ray.origin - ray.direction * lead, ray.direction);
                regular::extent(&grid, &line, limit)
            }
        }
    }

    /// Radiance \[W m^-2 sr^-1\] that the medium sends back along a length \[m\] of a ray: the integral of emission times T. On a way without end, where nothing is absorbed, it has no value and
    /// is 0.
    #[inline(always)]
    pub fn emitted(&self, ray: &Ray, lead: f32, length: f32) -> Vec3 {
        match self.density() {
            None => flight::emitted(self.emission, self.sigma_t, length),
            Some(_) if self.emission == Vec3::ZERO => Vec3::ZERO,
            Some(grid) => {
                let line = grid.line(ray.origin - ray.direction * lead, ray.direction);
                regular::emitted(&grid, &line, length, self.sigma_t, self.emission)
            }
        }
    }

    /// Extinction \[1/m\] at a point, per channel.
    #[inline(always)]
    pub fn sigma_t_at(&self, position: Vec3) -> Vec3 {
        match self.density() {
            None => self.sigma_t,
            Some(grid) => self.sigma_t * grid.at(position),
        }
    }

    /// Scattering \[1/m\] at a point, per channel.
    #[inline(always)]
    pub fn sigma_s_at(&self, position: Vec3) -> Vec3 {
        if self.is_homogeneous() { self.sigma_s } else { self.scattering(position) }
    }

    #[inline(never)]
    fn scattering(&self, position: Vec3) -> Vec3 {
        match Grid::new(self.scene, self.albedo) {
            Some(albedo) => self.sigma_t_at(position) * albedo.at(position),
            None => self.sigma_s * self.density().map_or(Vec3::ONE, |d| d.at(position)),
        }
    }
}
