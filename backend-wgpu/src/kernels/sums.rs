//! Sums of flux in fixed point against core, over all floats and units.

use super::{root_of, run};
use crate::Options;
use crate::gpu::Source;
use crate::shaders::Link;
use etendue_core::illumination::FluxUnit;
use etendue_core::sampling::counter::Counter;

const COUNT: u32 = 1 << 16;

const TWIN: &str = "
fn twin() {
    let flux = float();
    let units = illumination_units(flux, i32(word()));
    put_word(units.x);
    put_word(units.y);
}
";

#[test]
fn shares_of_flux_have_the_bits_of_core() {
    let numbers = Counter::new(3);
    let (mut items, mut expected) = (Vec::new(), Vec::new());
    for i in 0..COUNT {
        let [bits, total, photons] = [0, 1, 2].map(|k| numbers.bits(9, i, k));
        // From the least unit that a scene can have to the largest.
        let total = f64::from(f32::from_bits(total & 0x7fff_ffff));
        let unit = FluxUnit::new(total, 1 << (photons % 24));
        let power = unit.power().unwrap();
        // All floats; numbers near the unit; whole and half units.
        let flux = match i % 4 {
            0 => f32::from_bits(bits),
            1 => f32::from_bits((bits & 0x807f_ffff) | ((127 - power).clamp(0, 255) as u32) << 23),
            2 => {
                ((bits >> 8) as f32 * 0.5 - 4e6) * f32::from_bits(((127 - power).clamp(1, 254) as u32) << 23)
            }
            _ => {
                let exponent = 127 - power + (bits >> 26) as i32;
                f32::from_bits((bits & 0x8000_0007) | (exponent.clamp(0, 255) as u32) << 23)
            }
        };
        items.extend([flux.to_bits(), power.cast_unsigned()]);
        let units = unit.units(flux).cast_unsigned();
        expected.extend([units as u32, (units >> 32) as u32]);
    }
    let gpu = pollster::block_on(Source::request(None, Options::default())).unwrap().gpu();
    let root = root_of("illumination", "twin", [2, 2]) + TWIN;
    let link = Link { root: &root, features: &[], mutations: &[] };
    let mut found = vec![0; expected.len()];
    run(&gpu, "units of flux", link, [2, 2], &[], &items, &mut found).unwrap();
    let pairs = found.chunks(2).zip(expected.chunks(2)).zip(items.chunks(2));
    let (mut wrong, mut first) = (0, None);
    for ((found, expected), item) in pairs {
        if found != expected {
            wrong += 1;
            first.get_or_insert((f32::from_bits(item[0]), item[1].cast_signed(), found, expected));
        }
    }
    assert_eq!(wrong, 0, "{first:?}");
    // Shares of either sign, of one word and two.
    let large = expected.chunks(2).filter(|w| w[1] != 0 && w[1] != u32::MAX).count();
    let negative = expected.chunks(2).filter(|w| w[1] >> 31 == 1).count();
    assert!(large > 4000 && negative > 4000, "{large} {negative}");
}

#[test]
fn units_of_odd_numbers_of_photons_are_no_powers_of_two() {
    assert_eq!(FluxUnit::new(1.0, 3).power(), None);
    // A watt is 2^47 units of one photon.
    assert_eq!(FluxUnit::new(1.0, 1).power(), Some(47));
    assert_eq!(FluxUnit::new(1.0, 8).power(), Some(44));
}
