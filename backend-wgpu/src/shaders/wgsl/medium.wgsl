// What a medium is to a ray: the same everywhere, or by grids. A record's words (core's `MediumRecord`) lie in the arena, those of grids
// from `scene_at.grids` on. Without `GRIDS` media are the same everywhere.
//: use geometry::ray
//: use math::choice
//: use medium::flight
//: if GRIDS
//: use medium::grid
//: use medium::grid::regular
//: end

const MEDIUM_WORDS: u32 = 16u;
const GRID_WORDS: u32 = 20u;
const MEDIUM_NO_GRID: u32 = 0xffffffffu;

struct Medium {
    sigma_t: vec3<f32>,
    g: f32,
    sigma_s: vec3<f32>,
    density: u32,
    emission: vec3<f32>,
    albedo: u32,
}

fn medium_triple(at: u32) -> vec3<f32> {
    return vec3(scene_float(at), scene_float(at + 1u), scene_float(at + 2u));
}

fn medium_new(at: u32) -> Medium {
    let sigma_s = medium_triple(at + 4u);
    return Medium(
        medium_triple(at) + sigma_s,
        scene_float(at + 3u),
        sigma_s,
        scene_word(at + 11u),
        medium_triple(at + 8u),
        scene_word(at + 12u),
    );
}

fn medium_is_homogeneous(medium: Medium) -> bool {
    return medium.density == MEDIUM_NO_GRID && medium.albedo == MEDIUM_NO_GRID;
}

//: if GRIDS
fn medium_grid(index: u32) -> Grid { return grid_new(scene_at.grids + GRID_WORDS * index); }

fn medium_line(grid: Grid, ray: Ray, lead: f32) -> GridLine {
    return grid_line(grid, ray.origin - ray.direction * lead, ray.direction);
}

fn medium_fly_through(medium: Medium, ray: Ray, lead: f32, limit: f32, carried: vec3<f32>, u: vec2<f32>) -> Flight {
    let grid = medium_grid(medium.density);
    let p = flight_channels(carried);
    let channel = flight_pick(p, u.x);
    let wanted = flight_wanted(math_component(medium.sigma_t, channel), u.y);
    let reached = regular_fly(grid, medium_line(grid, ray, lead), limit, wanted, channel);
    let left = flight_transmittance_of(medium.sigma_t, reached.optical);
    var length = limit;
    var density = math_dot(p, left);
    if reached.met {
        length = reached.length;
        let place = ray.origin + ray.direction * (length - lead);
        density = math_dot(p, medium.sigma_t * grid_at(grid, place) * left);
    }
    var weight = vec3(0.0f);
    if density > 0.0f { weight = left / density; }
    return Flight(length, reached.met, weight, left);
}
//: end

// Draws a flight of at most `limit`, counted from `lead` before the ray's origin.
fn medium_fly(medium: Medium, ray: Ray, lead: f32, limit: f32, carried: vec3<f32>, u: vec2<f32>) -> Flight {
    //: if GRIDS
    if medium.density != MEDIUM_NO_GRID { return medium_fly_through(medium, ray, lead, limit, carried, u); }
    //: end
    return flight_sample(medium.sigma_t, carried, limit, u);
}

// What is left of light after a length along a ray.
fn medium_transmittance(medium: Medium, ray: Ray, lead: f32, length: f32) -> vec3<f32> {
    //: if GRIDS
    if medium.density != MEDIUM_NO_GRID {
        let grid = medium_grid(medium.density);
        let optical = regular_optical_length(grid, medium_line(grid, ray, lead), length, medium.sigma_t);
        return flight_transmittance_of(medium.sigma_t, optical);
    }
    //: end
    return flight_transmittance(medium.sigma_t, length);
}

// Where on the way from 0 to `limit` there may be any extinction: from x to y, or (0, -1) where nowhere.
fn medium_extent(medium: Medium, ray: Ray, lead: f32, limit: f32) -> vec2<f32> {
    //: if GRIDS
    if medium.density != MEDIUM_NO_GRID {
        let grid = medium_grid(medium.density);
        let extent = regular_extent(grid, medium_line(grid, ray, lead), limit);
        if !extent.found { return vec2(0.0f, -1.0f); }
        return vec2(extent.begin, extent.end);
    }
    //: end
    return vec2(0.0f, limit);
}

// Radiance that the medium sends back along a length of a ray.
fn medium_emitted(medium: Medium, ray: Ray, lead: f32, length: f32) -> vec3<f32> {
    //: if GRIDS
    if medium.density != MEDIUM_NO_GRID {
        if math_is_zero3(medium.emission) { return vec3(0.0f); }
        let grid = medium_grid(medium.density);
        return regular_emitted(grid, medium_line(grid, ray, lead), length, medium.sigma_t, medium.emission);
    }
    //: end
    return flight_emitted(medium.emission, medium.sigma_t, length);
}

fn medium_sigma_t_at(medium: Medium, position: vec3<f32>) -> vec3<f32> {
    //: if GRIDS
    if medium.density != MEDIUM_NO_GRID { return medium.sigma_t * grid_at(medium_grid(medium.density), position); }
    //: end
    return medium.sigma_t;
}

fn medium_sigma_s_at(medium: Medium, position: vec3<f32>) -> vec3<f32> {
    //: if GRIDS
    var density = vec3(1.0f);
    if medium.density != MEDIUM_NO_GRID { density = grid_at(medium_grid(medium.density), position); }
    if medium.albedo != MEDIUM_NO_GRID {
        return medium.sigma_t * density * grid_at(medium_grid(medium.albedo), position);
    }
    return medium.sigma_s * density;
    //: else
    return medium.sigma_s;
    //: end
}
