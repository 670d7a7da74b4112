//! Participating media: `medium`, `volume` and `phase`.

use etendue_core::scene::{GridDesc, MediumDesc};

use super::Builder;
use super::transform::Transform;
use super::values::Object;
use crate::io::error::{LoadError, quoted};
use crate::io::source::read_file;
use crate::io::volume::{MAX_FILE, parse_vol};

/// A coefficient that is the same everywhere, or that is on a grid.
enum Coefficient {
    Same([f32; 3]),
    Grid(GridDesc),
}

impl Builder<'_, '_> {
    /// The name of a medium, which is read when it is first asked for.
    pub(super) fn medium(&mut self, o: &Object<'_>) -> Result<String, LoadError> {
        if let Some(name) = self.media.get(&o.index) {
            return Ok(name.clone());
        }
        let mut desc = self.read_medium(o)?;
        // Media written out twice are one: light that leaves the first is then not taken to be in the second.
        let alike = |m: &&MediumDesc| MediumDesc { name: String::new(), ..(*m).clone() } == desc;
        let name = match self.loader.desc.media.iter().find(alike) {
            Some(same) => same.name.clone(),
            None => {
                let plain = o.id().map_or_else(|| format!("medium:{}", o.line()), str::to_owned);
                let mut name = plain.clone();
                let mut n = 2;
                while self.loader.desc.media.iter().any(|m| m.name == name) {
                    name = format!("{plain}#{n}");
                    n += 1;
                }
                desc.name.clone_from(&name);
                self.loader.desc.media.push(desc);
                name
            }
        };
        self.media.insert(o.index, name.clone());
        Ok(name)
    }

    fn read_medium(&mut self, o: &Object<'_>) -> Result<MediumDesc, LoadError> {
        let on_grids = match o.kind() {
            "homogeneous" => false,
            "heterogeneous" => true,
            _ => return Err(o.unknown_kind("homogeneous, heterogeneous")),
        };
        // How others sample it.
        o.ignore(&["sample_emitters", "has_spectral_extinction"]);
        if o.old() {
            o.ignore(&["method", "strategy"]);
        }
        let scale = o.float("scale")?.unwrap_or(1.0) as f32;
        let g = match o.at_most_one("phase")? {
            Some(phase) => asymmetry(&phase)?,
            None => 0.0,
        };
        let absorbed = if o.old() { (o.color("sigma_a")?, o.color("sigma_s")?) } else { (None, None) };
        let extinction = match self.coefficient(o, "sigma_t")? {
            None if o.old() && on_grids => self.coefficient(o, "density")?,
            found => found,
        };
        let albedo = self.coefficient(o, "albedo")?;
        o.finish()?;
        if absorbed != (None, None) {
            if extinction.is_some() || albedo.is_some() {
                return Err(o.error("sigma_a or sigma_s beside sigma_t or albedo", "two of them that agree"));
            }
            let [a, s] = [absorbed.0, absorbed.1].map(|c| c.unwrap_or([0.0; 3]).map(|x| x * scale));
            return Ok(MediumDesc::new("", a, s, g));
        }
        let (extinction, albedo) = (
            extinction.unwrap_or(Coefficient::Same([1.0; 3])),
            albedo.unwrap_or(Coefficient::Same([0.75; 3])),
        );
        let (sigma_t, density) = match extinction {
            Coefficient::Same(t) => (t.map(|x| x * scale), None),
            Coefficient::Grid(grid) => ([scale; 3], Some(grid)),
        };
        if !on_grids && (density.is_some() || matches!(albedo, Coefficient::Grid(_))) {
            return Err(o.error("a volume on a grid", "the same everywhere, or type=\"heterogeneous\""));
        }
        let (albedo, grid) = match albedo {
            Coefficient::Same(albedo) => (albedo, None),
            // The grid takes its share of the sum, whatever the parts.
            Coefficient::Grid(grid) => ([0.0; 3], Some(grid)),
        };
        let sigma_s = [0, 1, 2].map(|k| sigma_t[k] * albedo[k]);
        let sigma_a = [0, 1, 2].map(|k| sigma_t[k] - sigma_s[k]);
        Ok(MediumDesc { density, albedo: grid, ..MediumDesc::new("", sigma_a, sigma_s, g) })
    }

    /// A colour, or a `volume`.
    fn coefficient(&mut self, o: &Object<'_>, name: &'static str) -> Result<Option<Coefficient>, LoadError> {
        let color = o.color(name)?;
        let Some(volume) = o.object("volume", name)? else { return Ok(color.map(Coefficient::Same)) };
        if color.is_some() {
            return Err(volume.error("a volume beside a colour", "one of them"));
        }
        let found = match volume.kind() {
            "constvolume" => Coefficient::Same(volume.color("value")?.unwrap_or([1.0; 3])),
            "gridvolume" => Coefficient::Grid(self.grid(&volume)?),
            _ => return Err(volume.unknown_kind("constvolume, gridvolume")),
        };
        volume.finish()?;
        Ok(Some(found))
    }

    fn grid(&mut self, o: &Object<'_>) -> Result<GridDesc, LoadError> {
        o.ignore(&["raw", "accel", "id", "max_value"]);
        if o.old() {
            o.ignore(&["sendData", "send_data"]);
        }
        o.word("filter_type", &["trilinear"])?;
        o.word("wrap_mode", &["clamp"])?;
        let by_file = o.flag("use_grid_bbox")?.unwrap_or(o.old());
        let to_world = o.transform("to_world")?;
        let (name, element) = o.filename()?;
        let Some(path) = self.find(o, element, name) else {
            return Err(o.error_at(element, quoted(name), format!("a file beside {}", self.scene.display())));
        };
        let volume = parse_vol(&read_file(self.loader.source, &path, MAX_FILE)?, &path)?;
        let [low, high] = volume.bounds.map(|c| c.map(f64::from));
        let bounds = Transform::columns([
            [high[0] - low[0], 0.0, 0.0],
            [0.0, high[1] - low[1], 0.0],
            [0.0, 0.0, high[2] - low[2]],
            low,
        ]);
        let placed = if by_file { to_world.after(&bounds) } else { to_world };
        Ok(GridDesc {
            size: volume.size,
            channels: volume.channels,
            values: volume.values,
            to_world: placed.affine(o)?,
        })
    }
}

/// The mean cosine of a phase function.
fn asymmetry(o: &Object<'_>) -> Result<f32, LoadError> {
    let g = match o.kind() {
        "isotropic" => 0.0,
        "hg" => o.float("g")?.unwrap_or(0.8),
        _ => return Err(o.unknown_kind("isotropic, hg")),
    };
    o.finish()?;
    Ok(g as f32)
}
