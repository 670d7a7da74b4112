//! Kernels of `first_shot`, and of the photons that lights emit.

use super::{Reader, Shared, Writer};
use crate::direct::subdivide::Bary;
use crate::kernel::Kernel;
use crate::light::emit::{self, Emission};
use crate::sampling::linear_triangle;
use crate::transport::first_shot::{place, weight};

/// Corners of a piece; none where one lies outside the triangle.
fn corners(r: &mut Reader<'_>) -> Option<[Bary; 3]> {
    let [a, b, c] = [(); 3].map(|()| Bary::try_new(r.word(), r.word()));
    Some([a?, b?, c?])
}

fn write(w: &mut Writer<'_>, e: Emission) {
    w.vec3(e.ray.origin);
    w.vec3(e.ray.direction);
    w.vec3(e.flux);
}

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    let mut c = Reader(shared.constants);
    match kernel {
        Kernel::StartPlace => {
            let Some(corners) = corners(&mut r) else { return };
            let weights = r.vec3().to_array();
            w.floats(place::on_triangle(corners, linear_triangle::sample(weights, r.pair())));
        }
        Kernel::StartWithin => {
            if let Some(local) = corners(&mut r).and_then(|c| place::within(c, r.pair())) {
                w.word(1);
                w.floats(local);
            }
        }
        Kernel::StartDensity => {
            let Some(corners) = corners(&mut r) else { return };
            let (weights, area, pmf) = (r.vec3().to_array(), r.float(), r.float());
            if let Some(local) = place::within(corners, r.pair()) {
                w.float(place::density(pmf, weights, area, local));
            }
        }
        Kernel::StartFlux => w.vec3(weight::start_flux(r.vec3(), r.float(), r.float())),
        Kernel::LightShare => w.float(weight::light_share(r.vec3(), r.float(), r.float())),
        Kernel::LookFactor => w.float(weight::look_factor(r.float(), r.word() != 0)),
        Kernel::PieceFlux => {
            w.vec3(weight::piece_flux(r.vec3(), r.vec3().to_array(), r.float(), r.float()));
        }
        Kernel::EmitLight => {
            let light = c.record();
            write(w, emit::emit(&light, (c.vec3(), c.float()), four(&mut r)));
        }
        Kernel::EmitEnvironment => {
            write(w, emit::emit_environment(c.vec3(), (c.vec3(), c.float()), four(&mut r)));
        }
        _ => {}
    }
}

fn four(r: &mut Reader<'_>) -> [f32; 4] {
    [r.float(), r.float(), r.float(), r.float()]
}
