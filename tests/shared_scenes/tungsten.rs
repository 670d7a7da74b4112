//! A scene of Tungsten, as far as `volumetric-caustic` needs its format: quads and spheres, Lambert's surfaces, glass, null boundaries, homogeneous media and power.

use serde_json::Value;
use std::fmt::Write;

/// One number for all, or three.
fn three(value: &Value) -> [f64; 3] {
    match value.as_array() {
        Some(list) => [0, 1, 2].map(|i| list[i].as_f64().unwrap()),
        None => [value.as_f64().unwrap(); 3],
    }
}

/// Columns of the rotation by degrees about z, then x, then y.
fn rotation(degrees: [f64; 3]) -> [[f64; 3]; 3] {
    let [(sx, cx), (sy, cy), (sz, cz)] = degrees.map(|d| d.to_radians().sin_cos());
    [
        [cy * cz - sy * sx * sz, cx * sz, sy * cz + cy * sx * sz],
        [-cy * sz - sy * sx * cz, cx * cz, -sy * sz + cy * sx * cz],
        [-sy * cx, -sx, cy * cx],
    ]
}

/// The scene as TOML, for a square image of this width and field of view.
pub(super) fn as_toml(json: &str, width: u32, fov_x_deg: f64) -> String {
    let scene: Value = serde_json::from_str(json).unwrap();
    let list = |key: &str| scene[key].as_array().unwrap();
    let place = &scene["camera"]["transform"];
    let [position, look_at, up] = ["position", "look_at", "up"].map(|k| three(&place[k]));
    let mut text = format!(
        "[camera]\nposition = {position:?}\nlook_at = {look_at:?}\nup = {up:?}\nfov_x_deg = {fov_x_deg:?}\nresolution = [{width}, {width}]\n"
    );
    for medium in list("media") {
        let [sigma_a, sigma_s] = ["sigma_a", "sigma_s"].map(|k| three(&medium[k]));
        let name = &medium["name"];
        writeln!(text, "[[medium]]\nname = {name}\nsigma_a = {sigma_a:?}\nsigma_s = {sigma_s:?}").unwrap();
    }
    for shape in list("primitives") {
        let place = &shape["transform"];
        let [position, degrees] = ["position", "rotation"].map(|k| place.get(k).map_or([0.0; 3], three));
        let scale = place.get("scale").map_or([1.0; 3], three);
        let surface = list("bsdfs").iter().find(|b| b["name"] == shape["bsdf"]).unwrap();
        let kind = match surface["type"].as_str().unwrap() {
            "lambert" => format!("\"diffuse\"\nalbedo = {:?}", three(&surface["albedo"])),
            "dielectric" => format!("\"dielectric\"\nior = {}", surface["ior"]),
            "forward" => "\"null\"".into(),
            // Of lights: they reflect nothing.
            "null" => "\"diffuse\"\nalbedo = [0, 0, 0]".into(),
            other => panic!("{other}"),
        };
        // A quad spans the unit square in x and z, its front at +y.
        let [x, _, z] = rotation(degrees);
        let [u, v] = [(z, scale[2]), (x, scale[0])].map(|(axis, s)| axis.map(|a| 0.5 * s * a));
        let name = &shape["name"];
        writeln!(text, "[[material]]\nname = {name}\nkind = {kind}").unwrap();
        if let Some(power) = shape.get("power") {
            let area = scale[0] * scale[2];
            let radiance = three(power).map(|p| p / (std::f64::consts::PI * area));
            writeln!(text, "emission = {radiance:?}").unwrap();
        }
        writeln!(text, "[[shape]]\nmaterial = {name}\ncenter = {position:?}").unwrap();
        match shape["type"].as_str().unwrap() {
            "quad" => writeln!(text, "kind = \"rectangle\"\nu = {u:?}\nv = {v:?}"),
            "sphere" => writeln!(text, "kind = \"sphere\"\nradius = {:?}", scale[0]),
            other => panic!("{other}"),
        }
        .unwrap();
        for (key, field) in [("int_medium", "interior"), ("ext_medium", "exterior")] {
            if let Some(medium) = shape.get(key) {
                writeln!(text, "{field} = {medium}").unwrap();
            }
        }
    }
    text
}
