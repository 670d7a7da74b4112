//! What is written comes back; what was changed is refused.
#![allow(clippy::disallowed_methods, reason = "tests")]

use super::container::{assemble, tag};
use super::*;
use crate::driver::radiosity::CodecError;
use etendue_core::illumination::ElementSettings;
use etendue_core::radiosity::polynomial::Portable;
use etendue_core::radiosity::relight::Relighter;
use etendue_core::radiosity::tiles::{Kind, Rates, encode};

/// A made-up operator of n patches.
fn operator(n: usize, rates: Rates, coarse: Option<Rates>) -> OperatorFile {
    let noise = |i: usize, j: usize| ((i * 31 + j * 17) % 16) as f32 / 16.0;
    let patches: Vec<Patch> = (0..n)
        .map(|i| Patch {
            area: 0.5 + noise(i, 0),
            position: [i as f32, noise(i, 1), -0.0],
            normal: if i % 3 == 0 { [0.0; 3] } else { [0.0, -1.0, 0.0] },
            albedo: [noise(i, 2), 1.0, 0.0],
            emission: [0.0, noise(i, 3), 3.0],
        })
        .collect();
    let s = |i: usize, j: usize| if i == j { 0.0 } else { noise(i.max(j), i.min(j)) / n as f32 };
    let tiles = encode(n, rates, s).unwrap();
    let areas = patches.iter().map(|p| p.area).collect();
    let albedo = vec![[0.5, 0.25, 0.0]; n];
    let factors = (0..n).map(|i| 0.75 + 0.5 * noise(i, 4)).collect();
    let mut relighter = Relighter::new(tiles, areas, factors, &albedo).unwrap();
    if let Some(rates) = coarse {
        relighter = relighter.with_coarse(&Portable, rates).unwrap();
    }
    OperatorFile {
        info: OperatorInfo {
            program: "0.0.0".into(),
            transport_hash: std::array::from_fn(|i| 7 * i as u8),
            patches_asked: n as u32,
            rays_per_patch: 64,
            rays: 1 << 60,
            seed: u64::MAX,
            bounces: None,
            passes: 3,
            codec: "tiles".into(),
            max_error: Some(0.1 + 0.2),
            error: CodecError { rms: 1.0 / 3.0, worst: 1e-300, energy: 0.0 },
            elements: ElementSettings { basis: Basis::Constant, sides: Sides::Apart, largest: 0.1 },
        },
        of: (0..2 * n + 3).map(|i| if i >= 2 * n { NO_PATCH } else { (i % n.max(1)) as u32 }).collect(),
        escaped: (0..n).map(|i| noise(i, 5)).collect(),
        seen: vec![1.0; n],
        patches,
        transport: Transport::Tiles(Box::new(relighter)),
    }
}

/// The operator of the golden and of the fuzzer.
fn tiny() -> OperatorFile {
    operator(9, Rates::Cheapest { lambda: 1e-5 }, Some(Rates::Uniform(Kind::Bits8)))
}

fn encoded(operator: &OperatorFile) -> Vec<u8> {
    encode_operator(operator, Path::new("a.etd")).unwrap()
}

fn parse(bytes: &[u8]) -> Result<OperatorFile, String> {
    parse_operator(bytes, Path::new("a.etd")).map_err(|e| e.to_string())
}

/// Sections of a file, to be changed and put together with good checksums.
fn sections(bytes: &[u8]) -> Vec<Section<'static>> {
    let count = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (0..count)
        .map(|i| {
            let entry = &bytes[64 + 64 * i..][..64];
            let word = |at: usize| u64::from_le_bytes(entry[at..at + 8].try_into().unwrap()) as usize;
            Section {
                tag: entry[..8].try_into().unwrap(),
                required: entry[24] == 1,
                bytes: bytes[word(8)..][..word(16)].to_vec().into(),
            }
        })
        .collect()
}

/// What the reader says when a section holds something else.
fn with(name: &str, change: impl FnOnce(&mut Vec<u8>)) -> Result<OperatorFile, String> {
    let mut sections = sections(&encoded(&tiny()));
    let section = sections.iter_mut().find(|s| s.tag == tag(name)).unwrap();
    change(section.bytes.to_mut());
    parse(&assemble(&sections))
}

#[test]
fn what_is_written_comes_back() {
    for n in [0, 1, 7, 8, 9, 64, 70] {
        for rates in Kind::ALL.map(Rates::Uniform).into_iter().chain([Rates::Cheapest { lambda: 1e-6 }]) {
            for coarse in
                [None, Some(Rates::Uniform(Kind::Bits8)), Some(Rates::Cheapest { lambda: 1e-9 / 3.0 })]
            {
                if n == 0 && coarse.is_some() {
                    continue;
                }
                let mut made = operator(n, rates, coarse);
                made.info.bounces = (n == 8).then_some(3);
                made.info.max_error = (n != 9).then_some(0.01);
                let bytes = encoded(&made);
                assert_eq!(parse(&bytes).unwrap(), made, "{n} {rates:?} {coarse:?}");
                assert_eq!(encoded(&parse(&bytes).unwrap()), bytes);
            }
        }
    }
}

#[test]
fn files_of_the_disk_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.etd");
    write_operator(&path, &tiny()).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), encoded(&tiny()));
    assert_eq!(read_operator(&path).unwrap(), tiny());
    assert!(read_operator(folder.path()).is_err());
}

/// The format itself: when this fails, raise the version. `ETENDUE_BLESS=1` writes the file anew.
#[test]
fn the_bytes_are_those_of_version_1() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/operator_file/tiny.etd");
    let bytes = encoded(&tiny());
    if std::env::var_os("ETENDUE_BLESS").is_some() {
        std::fs::write(&path, &bytes).unwrap();
    }
    let head = "6574656e64756500\
        01000000\
        11000000";
    let found: String = bytes[..16].iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(found, head);
    assert_eq!(u64::from_le_bytes(bytes[16..24].try_into().unwrap()), bytes.len() as u64);
    let names: Vec<String> = sections(&bytes).iter().map(|s| container::name(&s.tag)).collect();
    assert_eq!(
        names.join(" "),
        "info patches elements escaped seen albedo factors weights spread kinds tiles kinds0 tiles0 kinds1 tiles1 kinds2 tiles2"
    );
    for i in 0..names.len() {
        assert_eq!(bytes[64 + 64 * i + 8] % 64, 0, "sections begin at multiples of 64");
    }
    let json = sections(&bytes)[0].bytes.to_vec();
    assert_eq!(
        String::from_utf8(json).unwrap(),
        "{\"info\":{\"program\":\"0.0.0\",\"transport_hash\":\
         \"00070e151c232a31383f464d545b626970777e858c939aa1a8afb6bdc4cbd2d9\",\"patches_asked\":9,\
         \"rays_per_patch\":64,\"rays\":1152921504606846976,\"seed\":18446744073709551615,\"passes\":3,\"codec\":\"tiles\",\
         \"max_error\":0.30000000000000004,\"error\":{\"rms\":0.3333333333333333,\"worst\":1e-300,\"energy\":0.0},\
         \"elements\":{\"basis\":\"constant\",\"sides\":\"apart\",\"largest\":0.1}},\
         \"transport\":{\"tiles\":{\"coarse\":{\"uniform\":{\"kind\":7}},\"damping\":1.0}}}"
    );
    assert!(bytes == std::fs::read(&path).unwrap(), "{} differs", path.display());
}

#[test]
fn every_changed_byte_is_refused() {
    let bytes = encoded(&tiny());
    for at in 0..bytes.len() {
        for flip in [1, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= flip;
            let said = parse(&changed).expect_err(&format!("byte {at} changed by {flip:#x} was accepted"));
            assert!(at < 16 || said.contains("is damaged"), "byte {at}: {said}");
        }
    }
}

#[test]
fn every_other_length_is_refused() {
    let bytes = encoded(&tiny());
    for end in 0..bytes.len() {
        let said = parse(&bytes[..end]).expect_err(&format!("{end} bytes were accepted"));
        assert!(end < 8 || said.contains("is damaged"), "{end} bytes: {said}");
    }
    for more in [&[0_u8][..], &[0; 64], b"etendue\0"] {
        assert!(parse(&[&bytes[..], more].concat()).unwrap_err().contains("its header says"));
    }
}

#[test]
fn other_and_newer_files_are_told_apart() {
    assert!(parse(b"").unwrap_err().contains("expected an operator file"));
    assert!(
        parse(b"ply\nformat ascii").unwrap_err().contains("found a file that begins with \"ply\\nform\"")
    );
    let mut bytes = encoded(&tiny());
    bytes[8] = 2;
    assert_eq!(
        parse(&bytes).unwrap_err(),
        "a.etd: was written by a newer version: file version 2, this program reads 1"
    );
    // Whatever follows.
    assert!(parse(&bytes[..12]).unwrap_err().contains("newer"));
    bytes[8] = 0;
    assert!(parse(&bytes).unwrap_err().contains("version is 0"));
}

#[test]
fn unknown_sections_are_skipped_when_they_may_be() {
    let mut list = sections(&encoded(&tiny()));
    list.insert(3, Section { tag: tag("notes"), required: false, bytes: b"anything"[..].into() });
    assert_eq!(parse(&assemble(&list)).unwrap(), tiny());
    list[3].required = true;
    assert_eq!(
        parse(&assemble(&list)).unwrap_err(),
        "a.etd: section \"notes\" is not supported by this version"
    );
    list[3] = list[4].clone();
    assert!(parse(&assemble(&list)).unwrap_err().contains("is there twice"));
    for missing in 0..14 {
        let mut list = sections(&encoded(&tiny()));
        let gone = container::name(&list.remove(missing).tag);
        let said = parse(&assemble(&list)).unwrap_err();
        assert!(said.contains(&format!("{gone}: found no such section")), "{said}");
    }
}

#[test]
fn wrong_numbers_are_refused_with_a_reason() {
    let put =
        |at: usize, x: f32| move |b: &mut Vec<u8>| b[4 * at..4 * at + 4].copy_from_slice(&x.to_le_bytes());
    for (name, at, x, reason) in [
        ("patches", 13, 0.0, "patches: found area [0.0] of patch 1, expected a positive number"),
        ("patches", 0, f32::INFINITY, "area [inf] of patch 0"),
        ("patches", 2, f32::NAN, "position"),
        ("patches", 17, 2.0, "normal"),
        ("patches", 17, f32::NAN, "normal"),
        ("patches", 7, 1.5, "albedo"),
        ("patches", 9, f32::NAN, "albedo"),
        ("patches", 10, -1.0, "emission"),
        ("escaped", 2, 1.5, "escaped: found 1.5 at patch 2"),
        ("escaped", 2, f32::NAN, "escaped"),
        ("albedo", 0, -0.5, "albedo of patch 0 is -0.5"),
        ("factors", 3, 0.0, "factor of patch 3 is 0"),
        ("factors", 3, f32::NAN, "factor"),
    ] {
        let said = with(name, put(at, x)).unwrap_err();
        assert!(said.contains(reason), "{said}");
    }
    for (name, word, reason) in [
        ("elements", 9, "elements: found patch 9 of element 0, expected less than 9"),
        ("elements", u32::MAX - 1, "patch 4294967294"),
    ] {
        let said = with(name, |b| b[..4].copy_from_slice(&word.to_le_bytes())).unwrap_err();
        assert!(said.contains(reason), "{said}");
    }
    let said = with("elements", |b| b.fill(0)).unwrap_err();
    assert!(said.contains("elements: found none of patch 1"), "{said}");
    let said = with("kinds", |b| b[0] |= 15).unwrap_err();
    assert!(said.contains("no known kind"), "{said}");
    let said = with("tiles", |b| b[..2].fill(0xff)).unwrap_err();
    assert!(said.contains("not finite"), "{said}");
    for name in ["patches", "elements", "escaped", "seen", "albedo", "factors"] {
        for cut in 1..=4 {
            let said = with(name, |b| b.truncate(b.len() - cut));
            assert!(said.is_err() || name == "elements", "{name} without {cut} bytes");
        }
        with(name, |b| b.extend([0; 3])).expect_err("more bytes");
    }
    for name in ["kinds", "tiles", "kinds0", "tiles0", "kinds2", "tiles2"] {
        with(name, |b| b.truncate(b.len() - 1)).expect_err("fewer bytes");
        with(name, |b| b.push(0)).expect_err("more bytes");
    }
}

#[test]
fn wrong_settings_are_refused() {
    for (from, to, reason) in [
        ("\"apart\"", "\"together\"", "sides Together, expected constant elements, sides apart"),
        ("\"constant\"", "\"linear\"", "elements Linear"),
        ("\"constant\"", "\"cubic\"", "unknown variant `cubic`"),
        ("0.1}", "-0.1}", "elements of -0.1 m"),
        ("0.1}", "1e999}", "is not a readable JSON file"),
        ("0.1}", "null}", "is not a readable JSON file"),
        ("1e-300", "-1.0", "worst -1"),
        ("\"0007", "\"07", "64 hexadecimal digits"),
        ("\"kind\":7", "\"kind\":10", "kind 10 of tiles"),
        ("{\"uniform\":{\"kind\":7}}", "{\"cheapest\":{\"lambda\":-1}}", "lambda -1"),
        ("\"tiles\":{\"coarse\"", "\"rods\":{\"coarse\"", "unknown variant `rods`"),
        ("\"seed\":18446744073709551615,", "", "missing field `seed`"),
    ] {
        let said = with("info", |b| {
            let text = String::from_utf8(b.clone()).unwrap();
            assert!(text.contains(from), "{from}");
            *b = text.replace(from, to).into_bytes();
        })
        .unwrap_err();
        assert!(said.contains(reason) && said.contains("info"), "{said}");
    }
    // What later versions may add.
    let more = with("info", |b| {
        *b = String::from_utf8(b.clone()).unwrap().replace("\"seed\"", "\"host\":[1],\"seed\"").into_bytes();
    });
    assert_eq!(more.unwrap(), tiny());
    // Without a second level its sections are none that are known.
    let none =
        with("info", |b| *b = String::from_utf8(b.clone()).unwrap().replace("coarse", "fine").into_bytes());
    assert!(none.unwrap_err().contains("section \"spread\" is not supported"));
}

#[test]
fn parts_that_do_not_fit_are_not_written() {
    let refuse = |change: fn(&mut OperatorFile), reason: &str| {
        let mut made = tiny();
        change(&mut made);
        let said = encode_operator(&made, Path::new("a.etd")).unwrap_err().to_string();
        assert!(said.contains(reason), "{said}");
    };
    refuse(|o| o.patches[2].area *= 2.0, "transport between other areas");
    refuse(|o| o.patches.truncate(8), "patch 8 of element");
    refuse(|o| o.escaped.push(0.0), "10 numbers, expected 9");
    refuse(|o| o.info.error.rms = f64::NAN, "rms NaN");
    refuse(|o| o.info.max_error = Some(f64::INFINITY), "max_error inf");
    refuse(|o| o.info.elements.largest = f32::INFINITY, "elements of inf m");
}
