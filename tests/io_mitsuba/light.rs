//! The camera, media and lights.

use super::*;

#[test]
fn cameras_see_what_the_format_sees() {
    let camera = |inner: &str, film: &str| {
        let text =
            format!("<sensor type=\"perspective\">{inner}<film type=\"hdrfilm\">{film}</film></sensor>");
        desc(&text).camera.unwrap()
    };
    let size = "<integer name=\"width\" value=\"400\"/><integer name=\"height\" value=\"300\"/>";
    // What Mitsuba 3.9.1 says its horizontal field of view is.
    for (axis, expected) in
        [("x", 40.0), ("y", 51.774_01), ("smaller", 51.774_01), ("larger", 40.0), ("diagonal", 32.468_605)]
    {
        let fov = format!("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"{axis}\"/>");
        let x = camera(&fov, size).fov_x_deg;
        assert!((x - expected).abs() < 1e-4, "{axis}: {x}");
    }
    assert!((camera("", size).fov_x_deg - 38.184_84).abs() < 1e-4, "a lens of 50 mm");
    let c = camera("", "");
    assert_eq!(
        (c.resolution, c.position, c.look_at, c.up),
        ([768, 576], [0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    );
    let c = camera(
        "<transform name=\"to_world\"><lookat origin=\"1 2 -9\" target=\"1 2 3\" up=\"0 1 0\"/></transform>",
        size,
    );
    assert_eq!(
        (c.position, c.look_at, c.up, c.resolution),
        ([1.0, 2.0, -9.0], [1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [400, 300])
    );
    assert_eq!((c.lens_radius, c.medium.as_str()), (0.0, ""));
    let d = desc(
        "<medium type=\"homogeneous\" id=\"fog\"/><sensor type=\"thinlens\"><float name=\"fov\" value=\"30\"/>\
         <float name=\"aperture_radius\" value=\"0.1\"/><float name=\"focus_distance\" value=\"7\"/>\
         <ref id=\"fog\"/><sampler type=\"independent\"/></sensor>",
    );
    let c = d.camera.unwrap();
    assert_eq!((c.lens_radius, c.focus_distance, c.medium.as_str()), (0.1, 7.0, "fog"));
    let scene = parse(
        "<sensor type=\"perspective\"><film type=\"hdrfilm\"><rfilter type=\"box\"/></film></sensor>\n\
         <sensor type=\"perspective\"/>\n<integrator type=\"moment\"><integrator type=\"volpath\">\
         <integer name=\"max_depth\" value=\"12\"/><integer name=\"rr_depth\" value=\"5\"/></integrator></integrator>",
    )
    .unwrap();
    assert_eq!(scene.max_depth, Some(12));
    let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes[0].starts_with("s/scene.xml:2: 2 sensors"), "{notes:?}");
    assert!(notes[1].contains("--max-depth 12"), "{notes:?}");
}

#[test]
fn media_are_by_extinction_and_albedo() {
    let medium = |inner: &str| {
        let d = desc(&format!(
            "<shape type=\"cube\"><medium name=\"interior\" {inner}</medium><bsdf type=\"null\"/></shape>"
        ));
        assert_eq!(d.meshes[0].interior, d.media[0].name);
        d.media[0].clone()
    };
    let m = medium("type=\"homogeneous\">");
    assert_eq!((m.sigma_s, m.sigma_a, m.g), ([0.75; 3], [0.25; 3], 0.0));
    let m = medium(
        "type=\"homogeneous\"><float name=\"scale\" value=\"2\"/><rgb name=\"sigma_t\" value=\"1 2 4\"/>\
         <rgb name=\"albedo\" value=\"0.5\"/><phase type=\"hg\"><float name=\"g\" value=\"-0.25\"/></phase>",
    );
    assert_eq!((m.sigma_s, m.sigma_a, m.g), ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0], -0.25));
    let grid = |name: &str, file: &str, more: &str| {
        format!(
            "<volume name=\"{name}\" type=\"gridvolume\"><string name=\"filename\" value=\"{file}\"/>{more}</volume>"
        )
    };
    let m = medium(&format!(
        "type=\"heterogeneous\"><float name=\"scale\" value=\"8\"/>{}",
        grid("sigma_t", "smoke.vol", "")
    ));
    let density = m.density.unwrap();
    assert_eq!((m.sigma_s, m.sigma_a), ([6.0; 3], [2.0; 3]));
    assert_eq!((density.size, density.channels, density.values), ([2, 1, 1], 1, vec![0.25, 0.75]));
    assert_eq!(density.to_world, [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
    // The bounds of the file, then to_world.
    let placed = "<boolean name=\"use_grid_bbox\" value=\"true\"/><transform name=\"to_world\"><scale value=\"2\"/></transform>";
    let m = medium(&format!(
        "type=\"heterogeneous\">{}{}",
        grid("sigma_t", "smoke.vol", placed),
        grid("albedo", "tint.vol", "")
    ));
    assert_eq!(
        m.density.unwrap().to_world,
        [[8.0, 0.0, 0.0, -2.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]]
    );
    assert_eq!(m.albedo.unwrap().channels, 3);
    assert_eq!((m.sigma_a, m.sigma_s), ([1.0; 3], [0.0; 3]));
    // Written out twice, it is one.
    let fog = |side: &str| {
        format!("<shape type=\"rectangle\"><medium name=\"{side}\" type=\"homogeneous\"/></shape>")
    };
    let d = desc(&format!("{}{}", fog("interior"), fog("exterior")));
    assert_eq!((d.media.len(), &d.shapes[0].interior), (1, &d.shapes[1].exterior));
    for (inner, words) in [
        ("type=\"homogeneous\"><phase type=\"rayleigh\"/>".to_owned(), "isotropic, hg"),
        (format!("type=\"homogeneous\">{}", grid("sigma_t", "smoke.vol", "")), "the same everywhere"),
        (format!("type=\"heterogeneous\">{}", grid("sigma_t", "short.vol", "")), "s/short.vol: is damaged"),
        (format!("type=\"heterogeneous\">{}", grid("sigma_t", "quad.obj", "")), "VOL"),
        (format!("type=\"heterogeneous\">{}", grid("emission", "smoke.vol", "")), "emission"),
        ("type=\"homogeneous\"><rgb name=\"sigma_s\" value=\"1\"/>".to_owned(), "sigma_t"),
    ] {
        let text =
            refusal(&format!("<shape type=\"cube\"><medium name=\"interior\" {inner}</medium></shape>"));
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn lights_are_where_and_what_the_file_says() {
    let light = |inner: &str| desc(&format!("<emitter {inner}</emitter>")).lights[0].clone();
    let look =
        "<transform name=\"to_world\"><lookat origin=\"1 2 3\" target=\"1 2 9\" up=\"0 1 0\"/></transform>";
    let point =
        "type=\"point\"><point name=\"position\" value=\"1 2 3\"/><rgb name=\"intensity\" value=\"4\"/>";
    assert_eq!(light(point), LightDesc::Point { position: [1.0, 2.0, 3.0], intensity: [4.0; 3] });
    let LightDesc::Spot { position, direction, cone_deg, falloff_deg, intensity } =
        light(&format!("type=\"spot\">{look}"))
    else {
        panic!()
    };
    assert_eq!((position, direction, intensity), ([1.0, 2.0, 3.0], [0.0, 0.0, 1.0], [1.0; 3]));
    assert_eq!((cone_deg, falloff_deg), (20.0, 15.0));
    let noted = parse("<emitter type=\"spot\"/>").unwrap().notes;
    assert!(noted[0].message.contains("smooth step"), "{noted:?}");
    let sun = "type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/><rgb name=\"irradiance\" value=\"3\"/>";
    assert_eq!(light(sun), LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [3.0; 3] });
    let LightDesc::Environment(sky) = light("type=\"constant\">") else { panic!() };
    assert_eq!((sky.radiance, sky.image), ([1.0; 3], None));
    let picture = |transform: &str| {
        let text = format!(
            "type=\"envmap\"><string name=\"filename\" value=\"sky.exr\"/><float name=\"scale\" value=\"2\"/>{transform}"
        );
        let LightDesc::Environment(sky) = light(&text) else { panic!() };
        assert_eq!(sky.radiance, [2.0; 3]);
        sky.image.unwrap()
    };
    // Where each column looks: the middle of the picture is at -z of its axes, and a quarter to the right is +x.
    let world =
        |to_world: [[f32; 3]; 3], d: [f32; 3]| to_world.map(|r| r[0] * d[0] + r[1] * d[1] + r[2] * d[2]);
    let plain = picture("");
    assert_eq!((plain.width, plain.height, plain.texels[1]), (2, 3, [1.0, 1.0, 0.5]));
    // Mitsuba 3.9.1: without a transform the middle column is at +z and three quarters along is -x.
    assert_eq!(world(plain.to_world, [0.0, 0.0, -1.0]), [0.0, 0.0, 1.0]);
    assert_eq!(world(plain.to_world, [1.0, 0.0, 0.0]), [-1.0, 0.0, 0.0]);
    // Turned by 90 degrees about y, the middle column is at +x.
    let turned = picture("<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform>");
    assert_eq!(world(turned.to_world, [0.0, 0.0, -1.0]), [1.0, 0.0, 0.0]);
    // Mirrored: columns change places, and the rest is a rotation; three quarters along the old picture is now +x.
    let mirrored = picture("<transform name=\"to_world\"><scale x=\"-1\"/></transform>");
    assert_eq!(mirrored.texels[0], plain.texels[1]);
    assert_eq!(world(mirrored.to_world, [0.0, 0.0, -1.0]), [0.0, 0.0, 1.0]);
    assert_eq!(world(mirrored.to_world, [-1.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
    // A light on a shape; one surface with and without light is two materials.
    let d = desc(
        "<bsdf type=\"diffuse\" id=\"white\"/><emitter type=\"area\" id=\"lamp\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter>\
         <shape type=\"sphere\"><ref id=\"white\"/><ref id=\"lamp\"/></shape><shape type=\"disk\"><ref id=\"white\"/></shape>\
         <shape type=\"disk\"><emitter type=\"area\"/></shape>",
    );
    assert_eq!(d.lights.len(), 0);
    let seen: Vec<(&str, [f32; 3], [f32; 3])> =
        d.materials.iter().map(|m| (m.name.as_str(), m.emission, color(&m.kind))).collect();
    assert_eq!(
        seen,
        [
            ("white (light)", [1.0, 2.0, 3.0], [0.5; 3]),
            ("white", [0.0; 3], [0.5; 3]),
            ("black (light)", [1.0; 3], [0.0; 3])
        ]
    );
}
