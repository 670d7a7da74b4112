//! The camera and how far light is followed: `sensor`, `film` and `integrator`.

use etendue_core::math;
use etendue_core::scene::CameraDesc;

use super::Builder;
use super::values::Object;
use crate::io::error::LoadError;

/// Larger images are refused, in either direction.
const MAX_RESOLUTION: i64 = 65_536;
/// Half the diagonal of a frame of film of 36 mm x 24 mm, whose focal lengths files speak of \[mm\].
const HALF_FRAME: f64 = 21.633_307_652_783_937;
/// Where nothing is said: the far end of what others see.
const FAR: f64 = 1e4;

impl Builder<'_, '_> {
    /// Reads a `sensor`.
    pub(super) fn camera(&mut self, o: &Object<'_>) -> Result<CameraDesc, LoadError> {
        let thin_lens = match o.kind() {
            "perspective" => false,
            "thinlens" => true,
            _ => return Err(o.unknown_kind("perspective, thinlens")),
        };
        let resolution = match o.at_most_one("film")? {
            Some(film) => self.film(&film)?,
            None => [768, 576],
        };
        let to_world = o.transform("to_world")?;
        if !to_world.even_scale().is_some_and(|s| (s - 1.0).abs() < 1e-3) {
            return Err(o.error("a to_world that scales or shears", "one that turns and moves"));
        }
        // +z looks forward, +y is up and +x on the left, so that right is forward x up, as here.
        if to_world.determinant() < 0.0 {
            return Err(o.unsupported("a camera that sees mirrored"));
        }
        let fov_x_deg = field_of_view(o, resolution)? as f32;
        let far = o.float("far_clip")?;
        if o.float("near_clip")?.is_some() || far.is_some() {
            let message = "near_clip and far_clip are ignored: everything is seen";
            self.loader.note(o.file(), Some(o.line()), message);
        }
        let focus = o.float("focus_distance")?;
        let (lens_radius, focus_distance) = match thin_lens {
            false => (0.0, 0.0),
            true => match o.float("aperture_radius")? {
                Some(radius) => (radius, focus.or(far).unwrap_or(FAR)),
                None => return Err(o.error("no aperture_radius", "the radius of the lens")),
            },
        };
        for name in ["principal_point_offset_x", "principal_point_offset_y"] {
            if let Some((offset, element)) = o.float_at(name)?
                && offset != 0.0
            {
                return Err(o.error_at(element, offset.to_string(), "0: the picture is centred"));
            }
        }
        let mut media = o.objects("medium")?;
        let medium = match (media.pop(), media.is_empty()) {
            (None, _) => String::new(),
            (Some(medium), true) => self.medium(&medium)?,
            (Some(_), false) => return Err(o.error("several media", "at most one")),
        };
        o.objects("sampler")?;
        o.ignore(&["shutter_open", "shutter_close"]);
        o.finish()?;
        let position = to_world.column(3);
        let forward = to_world.column(2);
        // As far along the axis as the origin is: a direction between near points would lose digits.
        let far = position.iter().fold(1.0f64, |m, x| m.max(x.abs()));
        Ok(CameraDesc {
            position: position.map(|x| x as f32),
            look_at: [0, 1, 2].map(|k| (position[k] + far * forward[k]) as f32),
            up: to_world.column(1).map(|x| x as f32),
            fov_x_deg,
            resolution,
            lens_radius: lens_radius as f32,
            focus_distance: focus_distance as f32,
            medium,
        })
    }

    fn film(&mut self, o: &Object<'_>) -> Result<[u32; 2], LoadError> {
        let side = |key: &'static str, default: i64| match o.integer(key)?.unwrap_or(default) {
            n @ 1..=MAX_RESOLUTION => Ok(n as u32),
            n => Err(o.error(format!("{key} {n}"), format!("a number of pixels from 1 to {MAX_RESOLUTION}"))),
        };
        let size = [side("width", 768)?, side("height", 576)?];
        let whole = [
            ("crop_width", i64::from(size[0])),
            ("crop_height", i64::from(size[1])),
            ("crop_offset_x", 0),
            ("crop_offset_y", 0),
        ];
        for (key, value) in whole {
            if o.integer(key)?.is_some_and(|n| n != value) {
                return Err(o.unsupported(format!("a cropped picture ({key})")));
            }
        }
        let filter = o.at_most_one("rfilter")?;
        let kind = filter.as_ref().map_or("gaussian", |f| f.kind());
        if kind != "box" {
            let message = format!("the filter {kind} is replaced by a box: pixels differ a little at edges");
            let at = filter.as_ref().unwrap_or(o);
            self.loader.note(at.file(), Some(at.line()), message);
        }
        // Whatever else it says is about the file that is written.
        Ok(size)
    }

    /// Reads what an `integrator` says of the length of paths.
    pub(super) fn integrator(&mut self, o: &Object<'_>) -> Result<(), LoadError> {
        if o.flag("hide_emitters")? == Some(true) {
            return Err(o.error("hide_emitters = true", "lights that are seen"));
        }
        let depth = match o.integer("max_depth")? {
            None if o.kind() == "direct" => Some(2),
            other => other,
        };
        // Below 0 there is no limit.
        if let Some(Ok(depth)) = depth.map(u32::try_from) {
            self.max_depth = Some(depth);
            let message = format!("paths are meant to end at depth {depth}: --max-depth {depth}");
            self.loader.note(o.file(), Some(o.line()), message);
        }
        for inner in o.objects("integrator")? {
            self.integrator(&inner)?;
        }
        Ok(())
    }
}

/// The horizontal field of view \[degrees\].
fn field_of_view(o: &Object<'_>, [width, height]: [u32; 2]) -> Result<f64, LoadError> {
    let fov = o.float_at("fov")?;
    let focal = o.string("focal_length")?;
    let axis = o.word("fov_axis", &["x", "y", "diagonal", "smaller", "larger"])?;
    let (width, height) = (f64::from(width), f64::from(height));
    let diagonal = math::sqrt64(width * width + height * height);
    // The tangent of half the angle along some length of the picture, in pixels.
    let (tangent, along) = match (fov, focal) {
        (Some(_), Some((_, element))) => {
            return Err(o.error_at(element, "a focal length beside fov", "one of them"));
        }
        (Some((fov, element)), None) => {
            if !(fov > 0.0 && fov < 180.0) {
                return Err(o.error_at(element, fov.to_string(), "an angle between 0 and 180 degrees"));
            }
            let along = match axis {
                "x" => width,
                "y" => height,
                "diagonal" => diagonal,
                "smaller" => width.min(height),
                _ => width.max(height),
            };
            if along == width {
                return Ok(fov);
            }
            let (sin, cos) = math::sin_cos((fov as f32).to_radians() / 2.0);
            (f64::from(sin) / f64::from(cos), along)
        }
        (None, focal) => {
            let text = focal.map_or("50mm", |f| f.0);
            let length = text.trim().strip_suffix("mm").unwrap_or(text).trim().parse::<f64>();
            let Some(length) = length.ok().filter(|l| *l > 0.0 && l.is_finite()) else {
                let at = focal.map_or(o.element(), |f| f.1);
                return Err(o.error_at(at, text, "a length such as 50mm"));
            };
            (HALF_FRAME / length, diagonal)
        }
    };
    let x = tangent * width / along;
    Ok(2.0 * f64::from(math::atan2(x as f32, 1.0).to_degrees()))
}
