//! Pictures of environments: checked, scaled, and with the distribution of their directions.

use super::check::{finite, not_negative, out_of_range};
use super::compile::MAX_COUNT;
use super::compiled::{CompiledScene, bounding_sphere};
use super::desc::EnvironmentImage;
use super::error::SceneError;
use super::lights::LightDraft;
use crate::light::EnvironmentMap;
use alloc::string::ToString;
use alloc::vec::Vec;

/// Most texels along a side.
const MAX_SIDE: u32 = 65_536;
/// How far from a rotation a matrix may be.
const TURNED: f32 = 1e-4;

/// The light of a picture; the picture itself is added to the scene. A dark one makes a light without power, which is dropped later.
pub(super) fn draft(
    out: &mut CompiledScene,
    place: &str,
    radiance: [f32; 3],
    image: &EnvironmentImage,
) -> Result<LightDraft, SceneError> {
    if out.environment_map.is_some() {
        return Err(SceneError::SecondImage { place: place.to_string() });
    }
    for n in [image.width, image.height] {
        if n == 0 || n > MAX_SIDE {
            return out_of_range(place, "width and height", n as f32, "1 to 65536 texels");
        }
    }
    let expected = image.width as usize * image.height as usize;
    if image.texels.len() != expected {
        let (place, found) = (place.to_string(), image.texels.len());
        return Err(SceneError::WrongLength { place, field: "texels", found, expected });
    }
    if expected > MAX_COUNT {
        return Err(SceneError::TooLarge { what: "texels", found: expected });
    }
    not_negative(place, "texels", image.texels.as_flattened())?;
    finite(place, "to_world", image.to_world.as_flattened())?;
    check_rotation(place, image.to_world)?;
    let scaled = |t: &[f32; 3]| [t[0] * radiance[0], t[1] * radiance[1], t[2] * radiance[2]];
    let texels: Vec<[f32; 3]> = image.texels.iter().map(scaled).collect();
    finite(place, "radiance times texels", texels.as_flattened())?;
    let mut largest = [0.0_f32; 3];
    for t in &texels {
        largest = [0, 1, 2].map(|c| largest[c].max(t[c]));
    }
    let radius = bounding_sphere(&out.bounds).1;
    let Ok(map) = EnvironmentMap::try_new((image.width, image.height), texels, image.to_world) else {
        return Ok(LightDraft::environment([0.0; 3], [0.0; 3], radius));
    };
    let integral = map.integral();
    out.environment_map = Some(map);
    Ok(LightDraft::environment(largest, integral, radius))
}

fn check_rotation(place: &str, m: [[f32; 3]; 3]) -> Result<(), SceneError> {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut worst = 0.0_f32;
    for (i, a) in m.iter().enumerate() {
        for (j, b) in m.iter().enumerate() {
            worst = worst.max((dot(*a, *b) - if i == j { 1.0 } else { 0.0 }).abs());
        }
    }
    // Mirrored ones are pictures too.
    if worst <= TURNED {
        return Ok(());
    }
    out_of_range(
        place,
        "to_world",
        worst,
        "a rotation: its rows times their transpose off the identity by at most 1e-4",
    )
}
