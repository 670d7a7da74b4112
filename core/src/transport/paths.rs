//! What all tracers of paths from the sensor have in common: how one runs, and how blocks of them are added up.

use super::back::BlockSum;
use super::{Answer, Query, ask};
use crate::geometry::{Intersector, SurfacePoint};
use crate::math::Vec3;
use crate::medium::Inside;
use crate::sampling::sobol::BlockSampler;

/// Where the paths of a probe start.
#[derive(Clone, Copy, Debug)]
pub struct ProbeStart {
    /// The point, with the extent of the surface that it lies on.
    pub point: SurfacePoint,
    /// Unit normal.
    pub normal: Vec3,
    /// The media in front of it.
    pub inside: Inside,
}

/// A tracer of paths, written as a small state machine between rays.
pub trait Paths {
    /// One path between two rays.
    type State;

    /// Width of the camera's image in pixels; 0 without a camera.
    fn width(&self) -> u32;

    /// Starts a camera path through pixel (x, y). Without a camera the path is done at once.
    fn start_camera(&self, x: u32, y: u32, sampler: BlockSampler) -> (Self::State, Query);

    /// Starts a path that measures the irradiance \[W/m^2\] at a probe: the reflected radiance of a white Lambert surface there, times pi.
    fn start_probe(&self, start: &ProbeStart, sampler: BlockSampler) -> (Self::State, Query);

    /// Takes the answer to the last query and says what is asked next.
    fn advance(&self, state: &mut Self::State, answer: Answer) -> Query;

    /// What the sample measures so far.
    fn measured(state: &Self::State) -> Vec3;

    /// Runs one path to its end; returns what it measures and the number of rays it took.
    #[inline(always)]
    fn run<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        (mut state, mut query): (Self::State, Query),
    ) -> (Vec3, u32) {
        let mut rays = 0;
        while let Some(answer) = ask(intersector, &query) {
            rays += 1;
            query = self.advance(&mut state, answer);
        }
        (Self::measured(&state), rays)
    }

    /// Mean of one block of camera paths through a pixel, summed in the order of the samples; and the rays it took.
    #[inline(always)]
    fn pixel_block<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        [x, y]: [u32; 2],
        seed: u64,
        block: u32,
        block_length: u32,
    ) -> ([f64; 3], u64) {
        let stream = y.wrapping_mul(self.width()).wrapping_add(x);
        let mut sum = BlockSum::default();
        for i in 0..block_length {
            let start = self.start_camera(x, y, BlockSampler::new(seed, stream, block, i));
            sum.add(self.run(intersector, start));
        }
        sum.mean(block_length)
    }

    /// Mean of one block of paths from a probe of this number; and the rays it took.
    #[inline(always)]
    fn probe_block<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        (index, start): (u32, &ProbeStart),
        seed: u64,
        block: u32,
        block_length: u32,
    ) -> ([f64; 3], u64) {
        let mut sum = BlockSum::default();
        for i in 0..block_length {
            let path = self.start_probe(start, BlockSampler::new(seed, index, block, i));
            sum.add(self.run(intersector, path));
        }
        sum.mean(block_length)
    }
}

/// Runs `$body` with `$tracer` bound to the tracer of paths that carries what a scene needs, with just the code that `$code` names; `$camera`: the media that the camera stands in.
#[macro_export]
macro_rules! with_tracer {
    ($code:expr, ($scene:expr, $max_depth:expr, $camera:expr), |$tracer:ident| $body:expr) => {{
        use $crate::transport::{path::PathTracer, volume::VolumeTracer};
        let code: $crate::transport::TransportCode = $code;
        if $scene.needs.volume() {
            // Two instances: all that scenes with media need beside diffuse surfaces of one colour is in one.
            if code.lobes || code.textures || code.shading_normals {
                let $tracer = VolumeTracer::<true, true, true>::new($scene, $max_depth, $camera);
                $body
            } else {
                let $tracer = VolumeTracer::<false, false, false>::new($scene, $max_depth, $camera);
                $body
            }
        } else {
            $crate::with_transport_code!($code, |$tracer = PathTracer($scene, $max_depth)| $body)
        }
    }};
}
