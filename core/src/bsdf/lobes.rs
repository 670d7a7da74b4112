//! The sum of lobes at one surface point.

use super::boundary::Boundary;
use super::plastic::Coat;
use super::rough::Metal;
use super::{diffuse, film, phong};
use crate::math::{self, Vec3};

/// What a surface is beside albedo / pi and a Phong lobe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Finish {
    /// Nothing.
    #[default]
    Plain,
    /// A rough metal; nothing else is reflected.
    Metal(Metal),
    /// A rough boundary between dielectrics; nothing else is reflected.
    Boundary(Boundary),
    /// Plastic: `albedo` is that of the body with all that happens under the coat (see [`plastic`](super::plastic)).
    Plastic(Coat),
    /// A film that scatters to both sides: `albedo` is reflected.
    Film {
        /// Transmitted albedo.
        transmit: Vec3,
    },
}

/// Everything that scatters light at a surface point: albedo / pi, a Phong lobe, a perfect mirror, or one of the other [`Finish`]es.
///
/// The mirror is alone: a material either is one or has the others. `n` is the normal for which the lobes are stored. Of lobes that transmit `wo` and `wi` may be on either side of it; all others are 0
/// unless both are above (of plain ones `wo` is not looked at). `wo` is towards the sensor: where light passes to a medium of another index, f is that of radiance, which is divided by the square of the index ratio. What a path
/// from a light carries is f with `wo` and `wi` exchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobes {
    /// Diffuse albedo per channel; of a mirror, its reflectance.
    pub albedo: Vec3,
    /// Specular coefficient of the Phong lobe per channel.
    pub specular: Vec3,
    /// Exponent of the Phong lobe.
    pub exponent: f32,
    /// A perfect mirror.
    pub mirror: bool,
    /// What else it is.
    pub finish: Finish,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit direction.
    pub wi: Vec3,
    /// f |cos| / pdf per channel: what the throughput is multiplied by. Of a direction without density, its reflectance over the chance of its lobe.
    pub weight: Vec3,
    /// Density per solid angle of all lobes together; 0 marks a direction without density (a mirror, a smooth coat).
    pub pdf: f32,
}

impl Lobes {
    /// A diffuse surface.
    #[inline(always)]
    pub fn diffuse(albedo: Vec3) -> Self {
        Self { albedo, specular: Vec3::ZERO, exponent: 0.0, mirror: false, finish: Finish::Plain }
    }

    /// One that is finished so.
    pub fn finished(albedo: Vec3, finish: Finish) -> Self {
        Self { finish, ..Self::diffuse(albedo) }
    }

    /// Light sampling can contribute: some lobe has a density.
    #[inline(always)]
    pub fn has_density(&self) -> bool {
        !self.mirror
    }

    /// Some sampled directions have no density.
    #[inline(always)]
    pub fn has_delta(&self) -> bool {
        self.mirror || matches!(&self.finish, Finish::Plastic(coat) if coat.is_smooth())
    }

    /// Light can leave on the other side of the surface.
    #[inline(always)]
    pub fn transmits(&self) -> bool {
        matches!(self.finish, Finish::Boundary(_) | Finish::Film { .. })
    }

    /// Refracts channels differently: a path must be [`Self::of_channel`] before anything is asked.
    #[inline(always)]
    pub fn disperses(&self) -> bool {
        matches!(&self.finish, Finish::Boundary(b) if b.ratio.x != b.ratio.y || b.ratio.x != b.ratio.z)
    }

    /// The lobes as light of one channel (0 to 2) sees them; f is right for it alone.
    #[inline]
    #[must_use]
    pub fn of_channel(mut self, channel: usize) -> Self {
        if let Finish::Boundary(b) = &mut self.finish {
            b.ratio = Vec3::splat(b.ratio[channel % 3]);
        }
        self
    }

    /// What radiance is divided by from `wi` to `wo`: the squared ratio of the indices where light passes to another medium, else 1. The rest of f / pdf is what is kept of the light.
    #[inline]
    pub fn index_ratio_squared(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        match &self.finish {
            Finish::Boundary(b) if wo.dot(n) * wi.dot(n) < 0.0 => {
                let ratio = if wo.dot(n) > 0.0 { b.ratio.x } else { 1.0 / b.ratio.x };
                ratio * ratio
            }
            _ => 1.0,
        }
    }

    /// Nothing but albedo / pi, a Phong lobe or a mirror.
    #[inline(always)]
    pub fn is_plain(&self) -> bool {
        matches!(self.finish, Finish::Plain)
    }

    /// Albedo of what is reflected diffusely to `wo` in diffuse light; 0 for what transmits.
    #[inline]
    pub fn diffuse_albedo(&self, n: Vec3, wo: Vec3) -> Vec3 {
        match &self.finish {
            Finish::Plain if !self.mirror => self.albedo,
            Finish::Plastic(coat) => coat.diffuse_albedo(self.albedo, wo.dot(n)),
            _ => Vec3::ZERO,
        }
    }

    /// Probability of choosing the diffuse lobe of plain lobes: its share of the mean reflectance.
    #[inline]
    pub(crate) fn diffuse_share(&self) -> f32 {
        let (d, s) = (math::mean(self.albedo), math::mean(self.specular));
        if d + s > 0.0 { d / (d + s) } else { 1.0 }
    }

    /// f(wo, wi) \[1/sr\] per channel, mirrors left out (they have no value at any direction).
    #[inline(always)]
    pub fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        if self.mirror {
            return Vec3::ZERO;
        }
        if !self.is_plain() {
            return self.eval_finished(n, wo, wi);
        }
        let f = diffuse::eval(self.albedo, n, wi);
        if self.specular == Vec3::ZERO {
            return f;
        }
        f + phong::eval(self.specular, self.exponent, n, wo, wi)
    }

    #[inline(never)]
    fn eval_finished(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        match &self.finish {
            Finish::Plain => Vec3::ZERO,
            Finish::Metal(metal) => metal.eval(n, wo, wi),
            Finish::Boundary(boundary) => Vec3::splat(boundary.values(n, wo, wi).0),
            Finish::Plastic(coat) => coat.values(self.albedo, n, wo, wi).0,
            Finish::Film { transmit } => film::values(self.albedo, *transmit, n, wo, wi).0,
        }
    }

    /// Density per solid angle with which [`Self::sample`] draws `wi`; mirrors have none.
    #[inline(always)]
    pub fn pdf_solid_angle(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        if self.mirror {
            return 0.0;
        }
        if !self.is_plain() {
            return self.pdf_finished(n, wo, wi);
        }
        if self.specular == Vec3::ZERO {
            return diffuse::pdf_solid_angle(n, wi);
        }
        let share = self.diffuse_share();
        share * diffuse::pdf_solid_angle(n, wi)
            + (1.0 - share) * phong::pdf_solid_angle(self.exponent, n, wo, wi)
    }

    #[inline(never)]
    fn pdf_finished(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        match &self.finish {
            Finish::Plain => 0.0,
            Finish::Metal(metal) => metal.rough.reflect(n, wo, wi).1,
            Finish::Boundary(boundary) => boundary.values(n, wo, wi).1,
            Finish::Plastic(coat) => coat.values(self.albedo, n, wo, wi).1,
            Finish::Film { transmit } => film::values(self.albedo, *transmit, n, wo, wi).1,
        }
    }

    /// A direction in proportion to the lobes. `u` chooses the direction, `lobe` the lobe, all in [0, 1).
    /// `None` where the light is absorbed: a black surface or a direction on a side to which nothing goes.
    #[inline(always)]
    pub fn sample(&self, n: Vec3, wo: Vec3, u: [f32; 2], lobe: f32) -> Option<BsdfSample> {
        if self.mirror {
            let wi = phong::mirror_direction(n, wo);
            return (wi.dot(n) > 0.0).then_some(BsdfSample { wi, weight: self.albedo, pdf: 0.0 });
        }
        if !self.is_plain() {
            return self.sample_finished(n, wo, u, lobe);
        }
        if self.specular == Vec3::ZERO {
            let wi = diffuse::sample(n, u);
            let pdf = diffuse::pdf_solid_angle(n, wi);
            return (pdf > 0.0).then_some(BsdfSample { wi, weight: self.albedo, pdf });
        }
        let wi = if lobe < self.diffuse_share() {
            diffuse::sample(n, u)
        } else {
            phong::sample(self.exponent, n, wo, u)
        };
        let cos = wi.dot(n);
        let pdf = self.pdf_solid_angle(n, wo, wi);
        if cos > 0.0 && pdf > 0.0 {
            let weight = self.eval(n, wo, wi) * (cos / pdf);
            return Some(BsdfSample { wi, weight, pdf });
        }
        None
    }

    #[inline(never)]
    fn sample_finished(&self, n: Vec3, wo: Vec3, u: [f32; 2], lobe: f32) -> Option<BsdfSample> {
        match &self.finish {
            Finish::Plain => None,
            Finish::Metal(metal) => metal.sample(n, wo, u),
            Finish::Boundary(boundary) => boundary.sample(n, wo, u, lobe),
            Finish::Plastic(coat) => coat.sample(self.albedo, n, wo, u, lobe),
            Finish::Film { transmit } => film::sample(self.albedo, *transmit, n, wo, u, lobe),
        }
    }
}
