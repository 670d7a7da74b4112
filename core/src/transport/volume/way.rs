//! Straight ways through media and through boundaries that light passes.

use super::CROSSINGS_MAX;
use super::boundaries::resolve;
use crate::geometry::{Hit, Ray};
use crate::math::{self, Vec3};
use crate::medium::{Inside, Medium};
use crate::scene::{CompiledScene, material_flags};
use crate::transport::back::NO_RAY;
use crate::transport::surface_at;

/// Length of way through the step that a ray takes off a surface with this unit normal \[m\]: a medium is there too. At grazing directions, below a cosine of a tenth, it is less than that.
#[inline(always)]
pub(in crate::transport) fn lead((position, normal): (Vec3, Vec3), origin: Vec3, direction: Vec3) -> f32 {
    let step = math::sqrt((origin - position).length_squared());
    step / math::max(math::abs(direction.dot(normal)), 0.1)
}

/// A straight way to a place, from where it has been followed to.
#[derive(Clone, Copy, Debug)]
pub(in crate::transport) struct Way {
    /// Its direction is a unit vector.
    pub ray: Ray,
    /// What lies between the surface that the ray leaves and where it starts, and from that surface to the place \[m\].
    pub lead: f32,
    pub left: f32,
    /// The media that it starts in.
    pub inside: Inside,
    /// Boundaries crossed so far.
    pub crossed: u32,
}

/// How far a way was followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::transport) enum Followed {
    /// To its end.
    Whole,
    /// To something that is in the way.
    Blocked,
    /// Beyond a boundary: the rest is to be followed.
    Part,
}

impl Way {
    /// None.
    pub(in crate::transport) const NOTHING: Self =
        Self { ray: NO_RAY, lead: 0.0, left: 0.0, inside: Inside::NOTHING, crossed: 0 };

    /// Goes on from where its ray has met a surface, or nothing. `dims` hears of what is left of the light per channel by each medium and pane, and of the chance that a walk
    /// which draws its flights and what panes do would have come through, the mean over the channels.
    #[inline(always)]
    pub(in crate::transport) fn follow<const LOBES: bool, const TEXTURES: bool, const SHADING: bool>(
        &mut self,
        scene: &CompiledScene,
        hit: Option<Hit>,
        mut dims: impl FnMut(Vec3, f32),
    ) -> Followed {
        let Self { ray, lead: before, left, inside, crossed } = *self;
        let length = hit.map_or(left, |h| before + h.t);
        if let Some(medium) = inside.current(scene).map(|m| Medium::new(scene, m)) {
            let through = medium.transmittance(&ray, before, length);
            dims(through, math::mean(through));
        }
        let Some(hit) = hit else { return Followed::Whole };
        let passes = |hit: &Hit| scene.material_of(hit.primitive).flags & material_flags::PASSES != 0;
        if !passes(&hit) || crossed >= CROSSINGS_MAX {
            return Followed::Blocked;
        }
        let (hit, beyond) = resolve(scene, &ray, hit, inside);
        if !passes(&hit) {
            return Followed::Blocked;
        }
        let Some(surface) = surface_at::<LOBES, TEXTURES, SHADING>(scene, &ray, &hit) else {
            return Followed::Blocked;
        };
        if let Some((transmit, chance)) = surface.interface.straight() {
            dims(transmit, chance);
        }
        let origin = surface.leave(ray.direction);
        // It ends where it ended before.
        let t_max = if ray.t_max < f32::MAX {
            ray.t_max - (origin - ray.origin).dot(ray.direction)
        } else {
            ray.t_max
        };
        *self = Self {
            ray: Ray { origin, t_max, ..ray },
            lead: surface.lead(origin, ray.direction),
            left: math::max(left - length, 0.0),
            inside: beyond,
            crossed: crossed + 1,
        };
        Followed::Part
    }
}
