//! Surfaces, and what is refused.

use super::*;

#[test]
fn surfaces_have_the_defaults_of_the_format() {
    let (kind, two_sided) = material("");
    assert_eq!((color(&kind), two_sided), ([0.5; 3], false));
    let (kind, two_sided) = material("<bsdf type=\"diffuse\"/>");
    assert_eq!((color(&kind), two_sided), ([0.5; 3], false));
    let glass = 1.5046f64 / 1.000277;
    let (kind, two_sided) = material("<bsdf type=\"dielectric\"/>");
    assert_eq!(kind, MaterialKind::Dielectric { ior: [glass as f32; 3], schlick: false });
    assert!(two_sided);
    let (kind, _) = material("<bsdf type=\"thindielectric\"/>");
    assert_eq!(kind, MaterialKind::ThinDielectric { ior: [glass as f32; 3], schlick: false });
    let (kind, _) = material("<bsdf type=\"roughdielectric\"/>");
    let roughness = Roughness::Beckmann(0.1);
    assert_eq!(kind, MaterialKind::RoughDielectric { ior: [glass as f32; 3], schlick: false, roughness });
    let (kind, two_sided) = material("<bsdf type=\"conductor\"/>");
    assert_eq!((color(&kind), two_sided), ([1.0; 3], false));
    let (kind, two_sided) = material("<bsdf type=\"plastic\"/>");
    let MaterialKind::Plastic { ior, roughness: None, nonlinear: false, .. } = kind else { panic!() };
    assert!((ior - 1.49 / 1.000277).abs() < 1e-6 && !two_sided);
    let (kind, _) =
        material("<bsdf type=\"roughplastic\"><boolean name=\"nonlinear\" value=\"true\"/></bsdf>");
    let MaterialKind::Plastic { roughness: r, nonlinear: true, .. } = kind else { panic!() };
    assert_eq!(r, Some(Roughness::Beckmann(0.1)));
    assert_eq!(material("<bsdf type=\"null\"/>").0, MaterialKind::Null);
}

#[test]
fn surfaces_say_what_they_are() {
    let (kind, two_sided) = material(
        "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.1 0.2, 0.3\"/></bsdf></bsdf>",
    );
    assert_eq!((color(&kind), two_sided), ([0.1, 0.2, 0.3], true));
    for grey in ["rgb", "spectrum", "float"] {
        let (kind, _) =
            material(&format!("<bsdf type=\"diffuse\"><{grey} name=\"reflectance\" value=\"0.25\"/></bsdf>"));
        assert_eq!(color(&kind), [0.25; 3], "{grey}");
    }
    let (kind, _) = material(
        "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Water\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>",
    );
    assert_eq!(kind, MaterialKind::Dielectric { ior: [1.333; 3], schlick: false });
    let (kind, _) = material(
        "<bsdf type=\"roughconductor\"><rgb name=\"eta\" value=\"1 2 3\"/><rgb name=\"k\" value=\"4\"/>\
         <string name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" value=\"0.3\"/></bsdf>",
    );
    let roughness = Roughness::Ggx(0.3);
    assert_eq!(kind, MaterialKind::RoughConductor { eta: [1.0, 2.0, 3.0], k: [4.0; 3], roughness });
    let (kind, _) = material("<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>");
    let MaterialKind::Conductor { eta, k } = kind else { panic!() };
    assert!(eta[0] < eta[2] && k[0] > k[2], "gold reflects red");
    let (kind, _) = material(
        "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/><rgb name=\"specular_reflectance\" value=\"0.9\"/></bsdf>",
    );
    assert_eq!(kind, MaterialKind::Mirror { albedo: etendue_core::scene::Reflectance::flat([0.9; 3]) });
    // A rough metal that reflects everything.
    let (kind, _) = material("<bsdf type=\"roughconductor\"/>");
    let MaterialKind::RoughConductor { eta, k, .. } = kind else { panic!() };
    for degrees in 0..90 {
        let reflectance = conductor(f64::from(eta[0]), f64::from(k[0]), f64::from(degrees).to_radians());
        assert!(reflectance > 1.0 - 1e-6, "{degrees}: {reflectance}");
    }
}

/// Reflectance of unpolarised light by a metal (Born and Wolf, section 14.2), in complex arithmetic.
fn conductor(eta: f64, k: f64, angle: f64) -> f64 {
    let (s2, c) = (angle.sin().powi(2), angle.cos());
    let (re, im) = (eta * eta - k * k - s2, 2.0 * eta * k);
    let modulus = re.hypot(im);
    let (p, q) = (((modulus + re) / 2.0).max(0.0).sqrt(), ((modulus - re) / 2.0).max(0.0).sqrt());
    let rs = ((p - c).powi(2) + q * q) / ((p + c).powi(2) + q * q);
    let t = angle.sin() * angle.tan();
    let rp = rs * ((p - t).powi(2) + q * q) / ((p + t).powi(2) + q * q);
    0.5 * (rs + rp)
}

#[test]
fn what_cannot_be_rendered_the_same_is_refused() {
    for (inner, words) in [
        ("<shape type=\"serialized\"/>", "obj, ply, rectangle"),
        ("<shape type=\"rectangle\"><bsdf type=\"bumpmap\"/></shape>", "diffuse, dielectric"),
        ("<shape type=\"rectangle\"><bsdf type=\"mask\"/></shape>", "is not supported"),
        (
            "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><float name=\"shine\" value=\"1\"/></bsdf></shape>",
            "shine: found <float>, expected what this version reads of it: reflectance",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"dielectric\"><rgb name=\"specular_transmittance\" value=\"0.5\"/></bsdf></shape>",
            "expected 1",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, 700:0.2\"/></bsdf></shape>",
            "three colours",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"conductor\"><string name=\"material\" value=\"mithril\"/></bsdf></shape>",
            "eta and k",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"roughplastic\"><float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.2\"/></bsdf></shape>",
            "both directions",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"dielectric\"/></bsdf></shape>",
            "an opaque one",
        ),
        (
            "<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf><shape type=\"rectangle\"><ref id=\"a\"/></shape>",
            "go round",
        ),
        (
            "<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>",
            "ellipsoid",
        ),
        ("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"true\"/></shape>", "front is inside"),
        ("<shape type=\"disk\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>", "ellipse"),
        (
            "<shape type=\"rectangle\"><transform name=\"to_world\"><scale z=\"0\"/></transform></shape>",
            "flattens",
        ),
        ("<shape type=\"rectangle\"><ref id=\"none\"/></shape>", "expected an id"),
        ("<shape type=\"rectangle\"><emitter type=\"point\"/></shape>", "area"),
        ("<shape type=\"obj\"/>", "no filename"),
        (
            "<shape type=\"obj\"><string name=\"filename\" value=\"no.obj\"/></shape>",
            "a file beside s/scene.xml",
        ),
        ("<emitter type=\"sunsky\"/>", "point, spot"),
        ("<emitter type=\"envmap\"><string name=\"filename\" value=\"wood.png\"/></emitter>", "EXR"),
        (
            "<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>",
            "lights that are seen",
        ),
        (
            "<sensor type=\"perspective\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></sensor>",
            "mirrored",
        ),
        (
            "<sensor type=\"perspective\"><transform name=\"to_world\"><scale value=\"2\"/></transform></sensor>",
            "scales",
        ),
        (
            "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"crop_width\" value=\"3\"/></film></sensor>",
            "cropped",
        ),
        ("<sensor type=\"orthographic\"/>", "perspective, thinlens"),
        ("<wonder/>", "<wonder>"),
    ] {
        let text = refusal(inner);
        assert!(text.starts_with("s/scene.xml:1: ") && text.contains(words), "{inner}\n{text}");
    }
}
