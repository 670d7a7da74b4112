//! What names of materials stand for.

/// Indices of refraction at about 589 nm (E. Hecht, Optics, 4th edition, 2002, and common tables), by the names
/// that scene files use.
const INDICES: &[(&str, f64)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// A metal: its name and its complex index of refraction, real and imaginary part for red, green and blue.
pub(super) type Metal = (&'static str, [f32; 3], [f32; 3]);

/// Metals as linear sRGB sees them: the measured spectra (SOPRA and Palik's handbook) projected on the CIE 1931
/// observer for a flat spectrum of 1, as Mitsuba 3.9.1 reports them in its RGB mode. Names of the same
/// measurement with `_palik` behind them are known too.
const METALS: &[Metal] = &[
    ("Ag", [0.155_276, 0.116_728, 0.138_388], [4.828_354, 3.122_222, 2.146_901]),
    ("Al", [1.657_501, 0.880_405, 0.521_244], [9.223_811, 6.269_502, 4.837_004]),
    ("Au", [0.143_036, 0.375_307, 1.442_045], [3.982_997, 2.385_556, 1.603_359]),
    ("Be", [4.185_012, 3.185_029, 2.784_061], [3.835_466, 3.010_122, 2.868_994]),
    ("Cr", [4.369_668, 2.916_505, 1.654_905], [5.206_547, 4.231_306, 3.754_699]),
    ("Cu", [0.201_005, 0.923_75, 1.102_215], [3.913_262, 2.453_045, 2.142_09]),
    ("Cu_palik", [0.213_229, 0.919_715, 1.102_411], [3.921_873, 2.457_332, 2.136_584]),
    ("Hg", [2.398_939, 1.440_028, 0.909_57], [6.327_587, 4.371_925, 3.421_764]),
    ("Ir", [3.086_3, 2.082_191, 1.617_914], [5.592_153, 4.067_088, 3.267_312]),
    ("K", [0.064_043, 0.046_41, 0.038_185], [2.104_2, 1.348_94, 0.913_126]),
    ("Li", [0.265_791, 0.195_618, 0.220_949], [3.540_155, 2.311_123, 1.668_607]),
    ("Mo", [4.483_974, 3.525_131, 2.776_31], [4.111_437, 3.420_827, 3.150_607]),
    ("Na_palik", [0.060_269, 0.056_141, 0.061_988], [3.179_273, 2.112_49, 1.579_041]),
    ("Nb", [3.420_074, 2.790_093, 2.395_629], [3.441_395, 2.737_666, 2.579_746]),
    ("Ni_palik", [2.367_305, 1.663_373, 1.467_078], [4.498_812, 3.050_153, 2.345_439]),
    ("Rh", [2.585_793, 1.860_216, 1.554_263], [6.782_26, 4.702_987, 3.976_073]),
    ("Ta", [2.062_721, 2.392_939, 2.627_929], [2.408_36, 1.741_486, 1.947_028]),
    ("TiN", [1.648_45, 1.150_516, 1.379_823], [3.368_328, 1.943_498, 1.102_068]),
    ("V_palik", [4.277_582, 3.512_949, 2.761_071], [3.491_301, 2.889_455, 3.111_522]),
    ("VN", [2.865_602, 2.119_189, 1.940_091], [3.032_243, 2.056_116, 1.616_306]),
    ("W", [4.370_817, 3.300_246, 2.998_407], [3.500_641, 2.604_874, 2.273_233]),
];

/// The index of refraction of a substance.
pub(super) fn index_of(name: &str) -> Option<f64> {
    let name = name.trim().to_ascii_lowercase();
    INDICES.iter().find(|(n, _)| *n == name).map(|(_, index)| *index)
}

/// All names of substances, for messages.
pub(super) fn substances() -> String {
    INDICES.iter().map(|(n, _)| *n).collect::<Vec<_>>().join(", ")
}

/// The metal of a name.
pub(super) fn metal(name: &str) -> Option<&'static Metal> {
    let plain = name.strip_suffix("_palik").unwrap_or(name);
    METALS.iter().find(|m| m.0 == name).or_else(|| METALS.iter().find(|m| m.0 == plain))
}

/// All names of metals, for messages.
pub(super) fn metals() -> String {
    METALS.iter().map(|m| m.0).collect::<Vec<_>>().join(", ")
}
