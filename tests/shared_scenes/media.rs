//! Scenes of Mitsuba with its own images: media, rough surfaces, caustics; by paths from one end and from both.

use super::*;
use etendue::core::transport::bidirectional::Heuristic;
use std::path::PathBuf;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    Path,
    Bdpt,
}

/// A scene file at a size (or its own) with so many samples, by a backend.
pub(crate) fn render_on(
    backend: &dyn Backend,
    path: &Path,
    method: Method,
    size: Option<[u32; 2]>,
    samples: u64,
    max_depth: Option<u32>,
) -> Outcome {
    let loaded = load_scene(path).unwrap_or_else(|e| panic!("{e}"));
    let (mut scene, _) = compile(&loaded.desc).unwrap();
    if let (Some(camera), Some([width, height])) = (&mut scene.camera, size) {
        *camera = camera.with_resolution(width, height);
    }
    let session = backend.open(Arc::new(scene)).unwrap();
    let max_depth = max_depth.or(loaded.max_depth).unwrap_or(u32::MAX);
    let settings = Settings { max_depth, ..settings(samples) };
    match method {
        Method::Path => driver::image(&*session, &settings, &Silent),
        Method::Bdpt => driver::bidirectional_image(&*session, &settings, Heuristic::Power, &Silent),
    }
    .unwrap()
}

/// The same on the CPU, as an image.
fn render(
    path: &Path,
    method: Method,
    size: Option<[u32; 2]>,
    samples: u64,
    max_depth: Option<u32>,
) -> RenderImage {
    let cpu = open_backend(BackendKind::Cpu, None).unwrap();
    let outcome = render_on(&*cpu, path, method, size, samples, max_depth);
    tell(&format!("{} {method:?}", path.file_stem().unwrap().to_string_lossy()), &outcome);
    assert_eq!((outcome.film.invalid(), outcome.film.saturated()), (0, 0));
    image_of(&outcome.film)
}

/// The references state a variance per sample of an unknown number: our own variance alone, the reference taken as exact; what its noise adds stands in the mean of z^2.
fn media(name: &str, reference: &str, samples: u64) {
    let Some(root) = shared_scenes() else { return };
    let root = root.join("mitsuba_media");
    let r = read_exr(&root.join(format!("refs/{reference}_ref_rgb.exr"))).unwrap();
    let exact = vec![[0.0; 3]; r.radiance.len()];
    for method in [Method::Path, Method::Bdpt] {
        let x = render(&root.join(format!("{name}.xml")), method, None, samples, None);
        let metrics = measure(&x, &r, None, None);
        // Pixels have few blocks each; means of tiles know their noise.
        check_tiles(&x, &r, &exact, 8);
        for (bias, [low, high]) in metrics.bias.iter().zip(metrics.bias_interval.unwrap()) {
            assert!(bias.abs() <= 0.003 + 0.5 * (high - low), "{name} {method:?}: {bias} in {low}..{high}");
        }
    }
}

#[test]
fn shared_media_hetero_sigmat() {
    media("test_hetero_sigmat_volpath", "test_hetero_sigmat", 128);
}

#[test]
fn shared_media_hetero_spectral() {
    media("test_hetero_spectral_sigmat_volpathmis", "test_hetero_spectral_sigmat", 128);
}

#[test]
fn shared_media_homo_area_light() {
    media("test_homo_area_light_volpath", "test_homo_area_light", 128);
}

#[test]
fn shared_media_homo_null_envmap() {
    media("test_homo_null_envmap_volpath", "test_homo_null_envmap", 128);
}

#[test]
fn shared_media_homo_obj_inside() {
    media("test_homo_obj_inside_medium_volpath", "test_homo_obj_inside_medium", 128);
}

#[test]
fn shared_media_surf_area_light() {
    media("test_surf_area_light_volpath", "test_surf_area_light", 128);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_media)' --run-ignored only"]
fn shared_full_media() {
    for (name, reference) in [
        ("test_hetero_sigmat_volpath", "test_hetero_sigmat"),
        ("test_hetero_spectral_sigmat_volpathmis", "test_hetero_spectral_sigmat"),
        ("test_homo_area_light_volpath", "test_homo_area_light"),
        ("test_homo_null_envmap_volpath", "test_homo_null_envmap"),
        ("test_homo_obj_inside_medium_volpath", "test_homo_obj_inside_medium"),
        ("test_surf_area_light_volpath", "test_surf_area_light"),
    ] {
        media(name, reference, 512);
    }
}

/// The means of cells of `factor` pixels a side: an image at a lower resolution.
fn halved(image: &RenderImage, factor: u32) -> RenderImage {
    let (width, height) = (image.width / factor, image.height / factor);
    let mut radiance = vec![[0.0_f32; 3]; (width * height) as usize];
    for y in 0..height * factor {
        for x in 0..width * factor {
            let from = image.radiance[(y * image.width + x) as usize];
            let to = &mut radiance[(y / factor * width + x / factor) as usize];
            for c in 0..3 {
                to[c] += from[c] / (factor * factor) as f32;
            }
        }
    }
    RenderImage { width, height, radiance, ..RenderImage::default() }
}

/// Images of Tungsten at a quarter of their size, which their tent filter hardly touches; `limits`: of the median and of the 5th and 95th percentile of blocks.
fn bitterli(name: &str, samples: u64, limits: [f64; 2], depth: Option<u32>, methods: &[Method]) {
    let Some(root) = shared_scenes() else { return };
    let root = root.join("bitterli").join(name);
    let whole = read_exr(&root.join("TungstenRender.exr")).unwrap();
    let r = halved(&whole, 4);
    for method in methods {
        let x = render(&root.join("scene.xml"), *method, Some([r.width, r.height]), samples, depth);
        let metrics = measure(&x, &r, None, None);
        let [low, median, high] = metrics.block_ratio;
        assert!((median - 1.0).abs() <= limits[0], "{name} {method:?}: {median}");
        assert!(low >= 1.0 - limits[1] && high <= 1.0 + limits[1], "{name} {method:?}: {low} {high}");
    }
}

#[test]
fn shared_bitterli_cornell_box() {
    bitterli("cornell-box", 32, [0.005, 0.02], None, &[Method::Path, Method::Bdpt]);
}

/// Light through glass onto walls: paths from the sensor alone do not find enough of it here.
#[test]
fn shared_bitterli_veach_bidir() {
    bitterli("veach-bidir", 32, [0.03, 0.5], Some(6), &[Method::Bdpt]);
}

/// Fog behind a null boundary by walks from both ends, at 1/`factor` of the reference's size; by paths alone it is beside the other closed boxes.
fn closed_fog(factor: u32, samples: u64) -> Option<Metrics> {
    let root = shared_scenes()?.join("closed_cornell");
    let r = halved(&read_exr(&root.join("fog_ref.exr")).unwrap(), factor);
    let keep = without_lamp(&r, 17.0);
    let x = render(&root.join("fog.toml"), Method::Bdpt, Some([r.width, r.height]), samples, None);
    let metrics = measure(&x, &r, None, Some(&keep));
    check_means(&metrics);
    Some(metrics)
}

#[test]
fn shared_closed_cornell_fog_bdpt() {
    closed_fog(2, 32);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_closed_cornell_fog_bdpt)' --run-ignored only"]
fn shared_full_closed_cornell_fog_bdpt() {
    let Some(metrics) = closed_fog(1, 256) else { return };
    assert!((metrics.block_ratio[1] - 1.0).abs() <= 0.002, "{:?}", metrics.block_ratio);
}

/// The ball of glass in gas as a scene file of this width, in a folder.
pub(crate) fn caustic_file(root: &Path, folder: &Path, width: u32) -> PathBuf {
    let json = root.join("bitterli/volumetric-caustic/scene_tungsten.json");
    let file = folder.join("volumetric-caustic.toml");
    let text = tungsten::as_toml(&std::fs::read_to_string(json).unwrap(), width, 19.5);
    std::fs::write(&file, text).unwrap();
    file
}

/// Light that a ball of glass throws through gas. Tungsten's 6 bounces, of which the open front takes one, are 5 edges here: with 4 or 6 blocks are 25 % darker or
/// 22 % brighter. The image is of the Mitsuba export's camera, not of the JSON's; its brightest points, lamp and caustic seen through the ball, are noise of the reference.
fn volumetric_caustic(factor: u32, samples: u64, limits: [f64; 2]) {
    let Some(root) = shared_scenes() else { return };
    let whole = read_exr(&root.join("bitterli/volumetric-caustic/TungstenRender.exr")).unwrap();
    let r = halved(&whole, factor);
    let folder = tempfile::tempdir().unwrap();
    let file = caustic_file(&root, folder.path(), r.width);
    let x = render(&file, Method::Bdpt, None, samples, Some(5));
    let metrics = measure(&x, &r, None, None);
    let [low, median, high] = metrics.block_ratio;
    assert!((median - 1.0).abs() <= limits[0], "{median}");
    assert!(low >= 1.0 - limits[1] && high <= 1.0 + limits[1], "{low} {high}");
}

#[test]
fn shared_bitterli_volumetric_caustic() {
    volumetric_caustic(8, 32, [0.01, 0.08]);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_bitterli_volumetric_caustic)' --run-ignored only"]
fn shared_full_bitterli_volumetric_caustic() {
    volumetric_caustic(4, 64, [0.005, 0.03]);
}
