//! Shaders with a plausible mistake each, and what of the suite notices: a kernel's truth or a scene. A mistake that does not compile is
//! noticed by the compiler, which is no test of the suite.

mod adapter;

use etendue_conformance::analytic::{self, Estimator};
use etendue_conformance::kernels::{QUICK_COUNT, measure};
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::{Level, golden};
use etendue_core::backend::{Backend, PathJob};
use etendue_core::kernel::Kernel;
use etendue_wgpu::{Mutation, Options};

/// What notices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum By {
    Kernel(Kernel),
    /// A scene with an exact answer.
    Case(&'static str),
    /// A scene with an image of the reference's.
    Golden(&'static str),
    /// The same from both ends, by its bits.
    BothEnds(&'static str),
}

impl By {
    /// Whether the suite is content with this backend; an error of the backend is a failure of the test. `slow`: goldens as the suite compares
    /// them, by statistics; otherwise a few samples and their bits.
    fn passes(self, backend: &dyn Backend, slow: bool) -> bool {
        match self {
            Self::BothEnds(name) => {
                let scene = golden::scenes().into_iter().find(|s| s.name == name).unwrap();
                let compiled = analytic::compiled(&scene.scene).unwrap();
                let job = PathJob { seed: 7, block_length: 2, blocks: 0..2, max_depth: 6 };
                let film = |backend| {
                    analytic::render(backend, Estimator::Bidirectional, &compiled, None, &job).unwrap()
                };
                film(backend) == film(&ReferenceBackend)
            }
            Self::Golden(name) => {
                let scene = golden::scenes().into_iter().find(|s| s.name == name).unwrap();
                if slow {
                    let found = golden::check(backend, Estimator::Path, &scene, Level::Quick).unwrap();
                    return found.iter().all(|f| f.1);
                }
                let compiled = analytic::compiled(&scene.scene).unwrap();
                let job = PathJob { seed: 7, block_length: 8, blocks: 0..2, max_depth: u32::MAX };
                let film =
                    |backend| analytic::render(backend, Estimator::Path, &compiled, None, &job).unwrap();
                film(backend) == film(&ReferenceBackend)
            }
            Self::Kernel(kernel) => measure(backend, kernel, QUICK_COUNT).unwrap().passes(),
            Self::Case(name) => {
                let case = analytic::cases().into_iter().find(|c| c.name == name).unwrap();
                let found = analytic::check(backend, Estimator::Path, &case, Level::Quick).unwrap();
                found.iter().all(|f| f.1)
            }
        }
    }
}

/// The mistake, its file, the text that is right, the text that is not, and what notices.
type Mutant = (&'static str, &'static str, &'static str, &'static str, By);

const MUTANTS: &[Mutant] = &[
    (
        "the next group of Sobol' points",
        "sampling::sobol",
        "sobol_derive(sampler.key, group << 3u)",
        "sobol_derive(sampler.key, (group + 1u) << 3u)",
        By::Kernel(Kernel::SobolBits4),
    ),
    (
        "the next entry at the boundary",
        "sampling::discrete",
        "if discrete_count(low + half) <= x",
        "if discrete_count(low + half) < x",
        By::Kernel(Kernel::CdfPick),
    ),
    (
        "a wrong sign in a basis",
        "math::vector",
        "let b = n.x * n.y * a;",
        "let b = -n.x * n.y * a;",
        By::Kernel(Kernel::OrthonormalBasis),
    ),
    (
        "a rest added for subtracted",
        "math::exp_ln",
        "math_kept(upper - lower)",
        "math_kept(upper + lower)",
        By::Kernel(Kernel::Exp),
    ),
    (
        "a light's pick left out of its density",
        "light",
        "let pdf = pmf * d2 / (area * cos);",
        "let pdf = d2 / (area * cos);",
        By::Kernel(Kernel::SampleLight),
    ),
    (
        "the cosine of a light's other side",
        "light",
        "let cos = -math_dot(wi, normal);\n    if cos <= 0.0f",
        "let cos = math_dot(wi, normal);\n    if cos <= 0.0f",
        By::Kernel(Kernel::SampleLight),
    ),
    (
        "the balance heuristic on one side",
        "transport::mis",
        "return r2 / (1.0f + r2);",
        "return r / (1.0f + r);",
        By::Kernel(Kernel::PowerHeuristic),
    ),
    (
        "rows of texels upside down",
        "scene::bitmap",
        "bitmap_repeat(-uv.y, height)",
        "bitmap_repeat(uv.y, height)",
        By::Kernel(Kernel::SampleBitmap),
    ),
    (
        "hits on edges missed",
        "geometry::triangle",
        "let negative = (e0 < 0.0f) |",
        "let negative = (e0 <= 0.0f) |",
        By::Kernel(Kernel::Triangle),
    ),
    (
        "boxes that are entered too late",
        "geometry::ray",
        "const NEAR: f32 = 1.0f - 3.0f",
        "const NEAR: f32 = 1.0f + 3.0f",
        By::Kernel(Kernel::Slab),
    ),
    (
        "forward for backward",
        "medium::phase",
        "var turned = wi + wo;",
        "var turned = wi - wo;",
        By::Kernel(Kernel::EvalPhase),
    ),
    (
        "a square forgotten in the density of facets",
        "bsdf::facets",
        "return INV_PI / (alpha2 * k * k);",
        "return INV_PI / (alpha2 * k);",
        By::Kernel(Kernel::FacetsDensity),
    ),
    (
        "the far plane of a node for the near one",
        "tree::walk",
        "let nx = (select(hx, lx, up.x)",
        "let nx = (select(lx, hx, up.x)",
        By::Golden("stage"),
    ),
    (
        "a search for any hit that ends with the first leaf",
        "tree::walk",
        "if any_hit && best.primitive != TREE_NOTHING { return best; }",
        "if any_hit { return best; }",
        By::Golden("stage"),
    ),
    (
        "the higher number among equally far hits",
        "tree::walk",
        "a.primitive < b.primitive",
        "a.primitive > b.primitive",
        By::Case("coincident_surfaces"),
    ),
    (
        "a queue that loses what does not fill a workgroup",
        "wavefront::turn",
        "(queue[1u - old] + 63u) / 64u",
        "queue[1u - old] / 64u",
        By::Golden("room"),
    ),
    (
        "roulette that does not make up for its losses",
        "transport::back",
        "survive < q, after / q",
        "survive < q, after",
        By::Case("furnace_cube"),
    ),
    (
        "a shadow ray that does not end at its light",
        "geometry::surface",
        "Ray(start, end - start, SEGMENT_END)",
        "Ray(start, end - start, MAX_FLOAT)",
        By::Case("square_light"),
    ),
    (
        "one edge of a path too many",
        "transport::path",
        "if (*state).depth < max_depth",
        "if (*state).depth <= max_depth",
        By::Case("furnace_after_1_bounces"),
    ),
    (
        "lights that shine to both sides",
        "transport::back",
        "surface.light < scene_at.light_count && surface.from_front",
        "surface.light < scene_at.light_count",
        By::Case("disk_light"),
    ),
    (
        "the cosine of the lit surface forgotten",
        "transport::path",
        "* math_max_number(cos, 0.0f)",
        "* 1.0f",
        By::Case("point_over_plane"),
    ),
    (
        "barycentrics that change places",
        "transport::surface",
        "b0 * a + hit.b1 * b + hit.b2 * c",
        "b0 * a + hit.b2 * b + hit.b1 * c",
        By::Golden("terrace"),
    ),
    (
        "a medium that is left for entered",
        "medium::inside",
        "select(before, behind, to_back)",
        "select(behind, before, to_back)",
        By::Case("media/glow"),
    ),
    (
        "panes that hide nothing of a light",
        "transport::volume",
        "if straight.found { (*state).carried *= straight.transmit; }",
        "",
        By::Case("media/plate_1.5_60_lit"),
    ),
    (
        "connections that end at the first boundary",
        "transport::volume",
        "(*state).crossed += 1u;\n    return true;",
        "(*state).crossed += 1u;\n    return false;",
        By::Case("media/single_1_reflected"),
    ),
    (
        "values of grids from the start of the texels",
        "medium::grid",
        "let at = grid.first_value + 3u * index;",
        "let at = 3u * index + 1u;",
        By::Case("media/grid_ramp"),
    ),
    (
        "strategies before the last two forgotten",
        "transport::bidirectional::weight",
        "if left.opens { sum = weight_of(chain.open) + before; }",
        "if left.opens { sum = weight_of(chain.open); }",
        By::BothEnds("room"),
    ),
    (
        "splats cut off, not rounded",
        "transport::bidirectional::splats",
        "select(0.5f, -0.5f, units < 0.0f)",
        "0.0f",
        By::BothEnds("room"),
    ),
    (
        "importance turned by normals as radiance is",
        "transport::bidirectional::vertex",
        "math_abs(select(cos, cos * there / here, from_light))",
        "math_abs(cos)",
        By::BothEnds("stage"),
    ),
];

fn notice(slow: bool, which: impl Fn(By) -> bool) {
    let found = if slow { adapter::backend() } else { adapter::exact_with(Options::default()) };
    let Some(sound) = found else { return };
    let mut known: Vec<By> = Vec::new();
    let mut missed = Vec::new();
    for (name, module, from, to, by) in MUTANTS.iter().filter(|m| which(m.4)) {
        if !known.contains(by) {
            let start = std::time::Instant::now();
            assert!(by.passes(&sound, slow), "{by:?} fails without a mistake");
            println!("       {by:?} passes, {:.2?}", start.elapsed());
            known.push(*by);
        }
        let mutations = vec![Mutation { module, from, to }];
        let Some(mutant) = adapter::backend_with(Options { mutations, ..Options::default() }) else { return };
        let start = std::time::Instant::now();
        let passes = by.passes(&mutant, slow);
        println!("{} {name}: {by:?}, {:.2?}", if passes { "MISSED" } else { "ok    " }, start.elapsed());
        if passes {
            missed.push(*name);
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
fn kernels_notice_mistakes() {
    notice(true, |by| matches!(by, By::Kernel(_)));
}

#[test]
fn scenes_notice_mistakes() {
    notice(false, |by| !matches!(by, By::Kernel(_)));
}

#[test]
#[ignore = "a minute: cargo nextest run -p etendue-wgpu --run-ignored only goldens_notice"]
fn goldens_notice_mistakes() {
    notice(true, |by| matches!(by, By::Golden(_)));
}
