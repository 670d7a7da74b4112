//! EXR, PNG, points and atomic output.
#![cfg(feature = "io")]

use std::path::Path;

use etendue::io::{
    Probe, RenderImage, parse_exr, parse_points, parse_texture, read_exr, read_mask, read_png, read_points,
    write_exr, write_png, write_points,
};
use exr::prelude as x;
use exr::prelude::WritableImage as _;

fn image() -> RenderImage {
    let value = |i: u32| [i as f32 * 0.1, -1.0 / (i + 1) as f32, 1e-30 * i as f32];
    RenderImage {
        width: 7,
        height: 40,
        radiance: (0..280).map(value).collect(),
        variance: Some((0..280).map(|i| value(i + 9)).collect()),
        sample_count: Some((0..280).map(|i| (i * i) as f32).collect()),
        metadata: "{\"seed\": 1, \"scene\": \"Zürich\"}".into(),
    }
}

#[test]
fn exr_round_trips_bit_for_bit_and_its_bytes_are_reproducible() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    let full = image();
    let mut plain = RenderImage { variance: None, sample_count: None, metadata: String::new(), ..image() };
    plain.radiance[3] = [f32::INFINITY, f32::MAX, f32::MIN_POSITIVE];
    for image in [full, plain] {
        write_exr(&a, &image).unwrap();
        let back = read_exr(&a).unwrap();
        assert_eq!(back, image);
        // Another thread, another path, another time.
        let (second, path) = (image.clone(), b.clone());
        std::thread::spawn(move || write_exr(&path, &second).unwrap()).join().unwrap();
        assert_eq!(std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
    }
}

#[test]
fn exr_settings_are_one_text_attribute() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &image()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes.windows(15).filter(|w| w == b"etendue\0string\0").count(), 1);
    let meta = exr::meta::MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers.len(), 1);
    assert_eq!(meta.headers[0].compression, x::Compression::ZIP16);
    let names: Vec<String> = meta.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "samples", "variance.B", "variance.G", "variance.R"]);
}

#[test]
fn images_of_the_wrong_length_are_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    assert!(write_exr(&path, &RenderImage { width: 8, ..image() }).is_err());
    assert!(write_exr(&path, &RenderImage::default()).is_err());
    assert!(write_exr(&path, &RenderImage { variance: Some(vec![]), ..image() }).is_err());
    assert!(write_png(&path, 2, 2, &[[0; 3]; 3]).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
}

/// Bytes of an EXR with the given channels, 2 x 1 pixels each.
fn foreign(layer: Option<&str>, channels: Vec<(&str, x::FlatSamples)>) -> Vec<u8> {
    let list = channels.into_iter().map(|(name, s)| x::AnyChannel::new(name, s)).collect();
    let attributes = x::LayerAttributes { layer_name: layer.map(x::Text::from), ..Default::default() };
    let layer = x::Layer::new((2, 1), attributes, x::Encoding::SMALL_LOSSLESS, x::AnyChannels::sort(list));
    let mut out = std::io::Cursor::new(Vec::new());
    x::Image::from_layer(layer).write().non_parallel().to_buffered(&mut out).unwrap();
    out.into_inner()
}

#[test]
fn foreign_exr_files_are_understood() {
    let half = |a: f32, b: f32| x::FlatSamples::F16(vec![x::f16::from_f32(a), x::f16::from_f32(b)]);
    let float = |a: f32, b: f32| x::FlatSamples::F32(vec![a, b]);
    let read = |bytes: &[u8]| parse_exr(bytes, Path::new("f.exr"));
    let rgba =
        vec![("R", half(1.0, 2.0)), ("G", half(3.0, 4.0)), ("B", half(5.0, 6.0)), ("A", half(0.0, 1.0))];
    assert_eq!(read(&foreign(None, rgba)).unwrap().radiance, [[1.0, 3.0, 5.0], [2.0, 4.0, 6.0]]);
    let grey = vec![("Y", x::FlatSamples::U32(vec![7, 8]))];
    assert_eq!(read(&foreign(None, grey)).unwrap().radiance, [[7.0; 3], [8.0; 3]]);
    let layered = vec![
        ("depth.Z", float(0.0, 0.0)),
        ("light.B", float(5.0, 6.0)),
        ("light.G", float(3.0, 4.0)),
        ("light.R", float(1.0, 2.0)),
    ];
    let image = read(&foreign(Some("main"), layered)).unwrap();
    assert_eq!(image.radiance, [[1.0, 3.0, 5.0], [2.0, 4.0, 6.0]]);
    assert_eq!((image.width, image.height, image.metadata.as_str()), (2, 1, ""));
    let err = read(&foreign(None, vec![("Z", float(0.0, 0.0))])).unwrap_err().to_string();
    assert!(err.contains("channels Z") && err.contains("R, G and B"), "{err}");
    assert!(read(b"no image").unwrap_err().to_string().contains("EXR"));
}

#[test]
fn damaged_exr_files_are_refused_without_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &image()).unwrap();
    let good = std::fs::read(&path).unwrap();
    for length in (0..good.len()).step_by(41) {
        assert!(parse_exr(&good[..length], &path).is_err(), "cut to {length}");
    }
    // A data window of 60000 x 60000 pixels.
    let at = good.windows(11).position(|w| w == b"dataWindow\0").unwrap() + 11 + 6 + 4 + 8;
    let mut huge = good;
    huge[at..at + 4].copy_from_slice(&59_999i32.to_le_bytes());
    huge[at + 4..at + 8].copy_from_slice(&59_999i32.to_le_bytes());
    let err = parse_exr(&huge, &path).unwrap_err().to_string();
    assert!(err.contains("at most"), "{err}");
}

#[test]
fn png_round_trips_and_masks_are_black_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let pixels = [[0, 0, 0], [0, 0, 1], [255, 128, 7], [9, 9, 9], [0, 0, 0], [1, 2, 3]];
    write_png(&path, 3, 2, &pixels).unwrap();
    let first = std::fs::read(&path).unwrap();
    write_png(&path, 3, 2, &pixels).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
    assert_eq!(read_png(&path).unwrap(), (3, 2, pixels.to_vec()));
    let mask = read_mask(&path).unwrap();
    assert_eq!((mask.width, mask.height), (3, 2));
    assert_eq!(mask.keep, [false, true, true, true, false, true]);
}

#[test]
fn bitmaps_of_other_depths_are_converted_and_huge_ones_refused() {
    use image::ImageEncoder as _;
    let encode = |bytes: &[u8], color| {
        let mut out = Vec::new();
        image::codecs::png::PngEncoder::new(&mut out).write_image(bytes, 2, 1, color).unwrap();
        parse_texture(&out, "t", Path::new("t.png")).unwrap().texels
    };
    assert_eq!(encode(&[0, 200], image::ExtendedColorType::L8), [[0; 3], [200; 3]]);
    let deep: Vec<u8> =
        [65_535u16, 0, 257 * 100, 0, 65_535, 257 * 7].iter().flat_map(|v| v.to_ne_bytes()).collect();
    assert_eq!(encode(&deep, image::ExtendedColorType::Rgb16), [[255, 0, 100], [0, 255, 7]]);

    // A header that claims 16000 x 16000 texels; its checksum is over the claim.
    let mut claim = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR".to_vec();
    claim.extend(16_000u32.to_be_bytes());
    claim.extend(16_000u32.to_be_bytes());
    claim.extend([8, 2, 0, 0, 0]);
    let crc = crc32(&claim[12..]);
    claim.extend(crc.to_be_bytes());
    claim.extend(b"\0\0\0\0IDAT");
    claim.extend(crc32(b"IDAT").to_be_bytes());
    let err = parse_texture(&claim, "t", Path::new("t.png")).unwrap_err().to_string();
    assert!(err.contains("256000000 texels"), "{err}");
    assert!(
        parse_texture(b"GIF89a", "t", Path::new("t.gif")).unwrap_err().to_string().contains("PNG or JPEG")
    );
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, b: &u8| {
        (0..8).fold(crc ^ u32::from(*b), |c, _| (c >> 1) ^ if c & 1 == 1 { 0xedb8_8320 } else { 0 })
    };
    !bytes.iter().fold(!0, step)
}

#[test]
fn points_round_trip_and_other_fields_are_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.json");
    let text = br#"{"source": "x", "probes": [
        {"position": [1, 2, 3.5], "normal": [0, 1, 0], "E": [0.1, 0.2, 0.3], "stderr": [0, 0, 0], "note": null},
        {"normal": [0, 0, -2], "position": [1e-3, 0, 0]}]}"#;
    let probes = parse_points(text, &path).unwrap();
    assert_eq!(probes[0].irradiance, Some([0.1, 0.2, 0.3]));
    assert_eq!(probes[1], Probe { position: [1e-3, 0.0, 0.0], normal: [0.0, 0.0, -2.0], ..Probe::default() });
    write_points(&path, &probes).unwrap();
    assert_eq!(read_points(&path).unwrap(), probes);
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert!(json["probes"][0]["E"].is_array() && json["probes"][1].get("E").is_none());

    let bad = [Probe { normal: [0.0, 0.0, 1.0], irradiance: Some([f32::NAN; 3]), ..Probe::default() }];
    assert!(write_points(&path, &bad).unwrap_err().to_string().contains("probe 1"));
    assert_eq!(read_points(&path).unwrap(), probes, "the good file is still there");
}

#[test]
fn bad_points_are_refused_with_their_line() {
    for (text, line, word) in [
        ("{\"probes\": [\n{\"position\": [1, 2], \"normal\": [0, 1, 0]}]}", Some(2), "JSON"),
        ("{\"probes\": [\n{\"position\": [1, 2, 3]}]}", Some(2), "normal"),
        ("{}", Some(1), "probes"),
        ("[", Some(1), "JSON"),
        ("{\"probes\": [{\"position\": [1, 2, 3], \"normal\": [0, 0, 0]}]}", None, "probe 1"),
        ("{\"probes\": [{\"position\": [1e300, 2, 3], \"normal\": [0, 0, 1]}]}", None, "probe 1"),
    ] {
        let err = parse_points(text.as_bytes(), Path::new("p.json")).unwrap_err();
        assert_eq!(err.line, line, "{err}");
        assert!(err.to_string().contains(word), "{err}");
    }
    assert!(
        parse_points("[".repeat(100_000).as_bytes(), Path::new("p.json")).is_err(),
        "nesting has a limit"
    );
}

#[test]
fn output_replaces_whole_files_or_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no/such/a.png");
    let err = write_png(&missing, 1, 1, &[[0; 3]]).unwrap_err().to_string();
    assert!(err.contains("does not exist"), "{err}");
    assert!(write_png(folder.path(), 1, 1, &[[0; 3]]).is_err(), "a folder is no file");
    let path = folder.path().join("a.png");
    std::fs::write(&path, "old").unwrap();
    write_png(&path, 1, 1, &[[0; 3]]).unwrap();
    assert_eq!(read_png(&path).unwrap().0, 1);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = std::fs::metadata(&path).unwrap().permissions().mode();
        let plain = folder.path().join("plain");
        std::fs::write(&plain, "").unwrap();
        assert_eq!(mode, std::fs::metadata(&plain).unwrap().permissions().mode(), "as for any new file");
    }
}
