//! Light: `emitter`.

use etendue_core::scene::{EnvironmentDesc, EnvironmentImage, LightDesc};

use super::Builder;
use super::transform::{Transform, unit};
use super::values::Object;
use crate::io::error::{LoadError, quoted};
use crate::io::exr::parse_exr;
use crate::io::source::read_file;

/// Longer pictures are refused.
const MAX_FILE: u64 = 1 << 30;
/// How others choose among lights.
const CHOICE: &[&str] = &["sampling_weight", "mis_compensation"];

impl Builder<'_, '_> {
    /// The radiance of an `emitter` within a shape.
    pub(super) fn area_light(&mut self, o: &Object<'_>) -> Result<[f32; 3], LoadError> {
        if o.kind() != "area" {
            return Err(o.unknown_kind("area (within a shape)"));
        }
        o.ignore(CHOICE);
        let radiance = o.color("radiance")?.unwrap_or([1.0; 3]);
        o.finish()?;
        Ok(radiance)
    }

    /// Reads an `emitter` that stands alone.
    pub(super) fn light(&mut self, o: &Object<'_>) -> Result<(), LoadError> {
        o.ignore(CHOICE);
        let light = match o.kind() {
            // For shapes that refer to it; alone it is nowhere.
            "area" => return Ok(()),
            "point" => {
                let to_world = o.transform("to_world")?;
                let position = match o.vector("position")? {
                    Some(p) => to_world.point(p),
                    None => to_world.column(3),
                };
                LightDesc::Point {
                    position: position.map(|x| x as f32),
                    intensity: o.color("intensity")?.unwrap_or([1.0; 3]),
                }
            }
            "spot" => self.spot(o)?,
            "directional" => {
                let to_world = o.transform("to_world")?;
                let direction = match o.vector("direction")? {
                    Some(d) => {
                        let moved = Transform::columns([
                            to_world.column(0),
                            to_world.column(1),
                            to_world.column(2),
                            [0.0; 3],
                        ]);
                        moved.point(d)
                    }
                    None => to_world.column(2),
                };
                let Some(direction) = unit(direction) else {
                    return Err(o.error("a direction of no length", "a direction"));
                };
                LightDesc::Directional {
                    direction: direction.map(|x| x as f32),
                    irradiance: o.color("irradiance")?.unwrap_or([1.0; 3]),
                }
            }
            "constant" => {
                o.ignore(&["to_world"]);
                let radiance = o.color("radiance")?.unwrap_or([1.0; 3]);
                LightDesc::Environment(EnvironmentDesc::uniform(radiance))
            }
            "envmap" => LightDesc::Environment(self.picture(o)?),
            _ => return Err(o.unknown_kind("area, point, spot, directional, constant, envmap")),
        };
        o.finish()?;
        self.loader.desc.lights.push(light);
        Ok(())
    }

    fn spot(&mut self, o: &Object<'_>) -> Result<LightDesc, LoadError> {
        let to_world = o.transform("to_world")?;
        let Some(direction) = unit(to_world.column(2)) else {
            return Err(o.error("a to_world that flattens space", "a direction"));
        };
        let cone = o.float("cutoff_angle")?.unwrap_or(20.0);
        let beam = o.float("beam_width")?.unwrap_or(cone * 0.75);
        if beam < cone {
            let message = format!(
                "between {beam} and {cone} degrees the spot light falls by a smooth step in the cosine, \
                 not evenly with the angle as elsewhere"
            );
            self.loader.note(o.file(), Some(o.line()), message);
        }
        Ok(LightDesc::Spot {
            position: to_world.column(3).map(|x| x as f32),
            direction: direction.map(|x| x as f32),
            intensity: o.color("intensity")?.unwrap_or([1.0; 3]),
            cone_deg: cone as f32,
            falloff_deg: beam as f32,
        })
    }

    fn picture(&mut self, o: &Object<'_>) -> Result<EnvironmentDesc, LoadError> {
        let scale = o.float("scale")?.unwrap_or(1.0) as f32;
        let to_world = o.transform("to_world")?;
        let (name, element) = o.filename()?;
        let Some(path) = self.find(o, element, name) else {
            return Err(o.error_at(element, quoted(name), format!("a file beside {}", self.scene.display())));
        };
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if !extension.eq_ignore_ascii_case("exr") {
            return Err(o.error_at(element, quoted(name), "a picture in EXR"));
        }
        if !to_world.even_scale().is_some_and(|s| (s - 1.0).abs() < 1e-3) {
            return Err(o.error("a to_world that scales or shears", "a rotation"));
        }
        let image = parse_exr(&read_file(self.loader.source, &path, MAX_FILE)?, &path)?;
        let mut texels = image.radiance;
        let axis = |j: usize, sign: f64| unit(to_world.column(j)).unwrap_or([0.0; 3]).map(|x| sign * x);
        // There the middle of the picture looks along +z, and +x is on the left; here along -z, and +x is on the
        // right: half a turn about y. A transform that mirrors is one that does not, of the mirrored picture.
        let mut x = -1.0;
        if to_world.determinant() < 0.0 {
            x = 1.0;
            texels.chunks_mut(image.width.max(1) as usize).for_each(<[_]>::reverse);
        }
        let columns = [axis(0, x), axis(1, 1.0), axis(2, -1.0)];
        Ok(EnvironmentDesc {
            radiance: [scale; 3],
            image: Some(EnvironmentImage {
                width: image.width,
                height: image.height,
                texels,
                to_world: [0, 1, 2].map(|i| columns.map(|c| c[i] as f32)),
            }),
        })
    }
}
