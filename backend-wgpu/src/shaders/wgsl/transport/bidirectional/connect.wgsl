// Vertices of the two walks joined: what a joint brings, and whether the way is free.
//: use sensor
//: use transport::bidirectional::emitters
//: use transport::bidirectional::vertex
//: use transport::bidirectional::walk
//: use transport::bidirectional::weight
//: use wavefront::slots
//: if VOLUME
//: use transport::volume::boundaries
//: use transport::volume::way
//: end

// Groups of the chances of connections.
const CHANCE_GROUPS: u32 = 1u << 28u;
// What would bring less than this part of what the sample has brought so far is joined by chance.
const JOINT_SMALL: f32 = 0.05f;

// A straight way between two vertices, or to a light or the camera: what it brings if nothing is on it, unweighted, and what its weight
// needs to know.
struct Joint {
    // It can bring something.
    goes: bool,
    carried: vec3<f32>,
    // Of the light's walk and of the sensor's.
    light: End,
    sensor: End,
    // Where it lands, if not in the sample's own pixel.
    to_camera: bool,
    pixel: CameraPixel,
    ray: Ray,
    //: if VOLUME
    // Where it ends, from the vertex that it leaves, and the media in which it starts.
    lead: f32,
    length: f32,
    inside: Inside,
    //: end
}

// The other end of a joint, as seen from the vertex that the ray leaves.
struct Target {
    found: bool,
    distant: bool,
    point: SurfacePoint,
    normal: vec3<f32>,
    wi: vec3<f32>,
    d2: f32,
    distance: f32,
}

fn connect_target(v: WalkVertex, point: SurfacePoint, normal: vec3<f32>) -> Target {
    let to = point.position - v.point.position;
    let d2 = math_dot(to, to);
    let distance = sqrt(d2);
    return Target(true, false, point, normal, to / distance, d2, distance);
}

// The ray to the other end, both ends off their surfaces.
fn connect_ray(v: WalkVertex, target_: Target) -> Ray {
    if target_.distant { return Ray(walk_vertex_leave(v, target_.wi, 0.0f), target_.wi, MAX_FLOAT); }
    let origin = walk_vertex_leave(v, target_.wi, target_.distance);
    var end = target_.point.position;
    if !math_is_zero3(target_.normal) {
        end = geometry_offset_origin(light_within(target_.point, target_.distance), target_.normal, -target_.wi);
    }
    return geometry_segment(origin, end);
}

// Joins a vertex: of the light's walk to the camera, or the sensor's last one to a light (`number` 0) or to `other`, a vertex of the
// light's walk. `event`: of the walk before the vertex sent it on.
fn connect_exchange(
    v: WalkVertex, other: WalkVertex, to_camera: bool, number: u32, sampler: BlockSampler, event: u32,
) -> Joint {
    var joint: Joint;
    joint.to_camera = to_camera;
    var target_: Target;
    var s = light_nothing();
    var light = 0u;
    var camera: Camera;
    if to_camera {
        camera = scene_camera(scene_at.camera);
        var lens = camera.position;
        if camera.lens_radius > 0.0f {
            lens = camera_sample_lens(camera, sobol_group2(sampler, LIGHT_GROUPS + WALK_GROUPS * event + 1u));
        }
        joint.pixel = camera_pixel(camera, lens, v.point.position);
        target_ = connect_target(v, SurfacePoint(lens, 0.0f), vec3(0.0f));
        target_.found = joint.pixel.found && weight_uses(v.index + 1u, 1u);
    } else if number == 0u {
        if scene_at.light_count == 0u || !weight_uses(1u, v.index + 1u) { return joint; }
        let bits = sobol_bits4(sampler, 1u + WALK_GROUPS * event + 1u);
        light = light_record(emitters_pick(bits.x));
        s = light_sample_light(light, v.point.position, bits.yz);
        let to = s.point - v.point.position;
        target_ = Target(s.found, s.distant, SurfacePoint(s.point, s.extent), s.normal, s.wi, 1.0f, math_infinity());
        if !s.distant {
            target_.d2 = math_dot(to, to);
            target_.distance = sqrt(target_.d2);
        }
    } else {
        target_ = connect_target(v, other.point, other.geometric);
        let d2 = target_.d2;
        target_.found = d2 >= MIN_POSITIVE && d2 <= MAX_FLOAT && v.edges + other.edges + 1u <= job.max_depth
            && weight_uses(other.index + 1u, v.index + 1u);
    }
    if !target_.found { return joint; }
    let here = walk_vertex_scattering(v, to_camera, target_.wi);
    let facing = walk_vertex_facing(v, target_.wi, target_.d2);
    joint.carried = v.carried * here.f;
    joint.light = End(true, 0u, Chain(1.0f, 0.0f, 0.0f, 0.0f), here.forward, 0.0f);
    joint.sensor = End(true, v.index, v.chain, 0.0f, here.backward);
    if to_camera {
        let pdf = camera_pdf_solid_angle(camera, -target_.wi);
        joint.carried *= pdf / target_.d2;
        joint.light = End(true, v.index, v.chain, pdf * facing, here.backward);
        joint.sensor.is_there = false;
    } else if number == 0u {
        let preference = emitters_preference(light, s.pdf, math_abs(math_dot(s.wi, s.normal)) / target_.d2);
        joint.carried *= s.contribution;
        joint.sensor.forward = emitters_pdf_towards(light, s.wi, s.normal) * facing / preference;
        // Densities of the place on the light are over that of light sampling here.
        if s.pdf > 0.0f { joint.light.chain = Chain(s.pdf, 0.0f, 1.0f, 0.0f); }
    } else {
        if math_is_zero3(here.f) { return joint; }
        let there = walk_vertex_scattering(other, true, -target_.wi);
        joint.carried = joint.carried * (other.carried * there.f) / target_.d2;
        // Both stand for three colours.
        if v.coloured && other.coloured { joint.carried *= 1.0f / 3.0f; }
        let forward = here.forward * walk_vertex_facing(other, target_.wi, target_.d2);
        joint.light = End(true, other.index, other.chain, forward, there.backward);
        joint.sensor.forward = there.forward * facing;
    }
    joint.goes = !math_is_zero3(joint.carried) && math_is_finite3(joint.carried);
    joint.ray = connect_ray(v, target_);
    //: if VOLUME
    joint.ray = way_with_unit_direction(joint.ray);
    joint.lead = walk_vertex_lead(v, joint.ray.origin, joint.ray.direction);
    joint.length = target_.distance;
    joint.inside = walk_vertex_media(v, joint.ray.direction);
    //: end
    return joint;
}

// Leaves out by chance what would bring little, and makes up for it. `radiance`: what the sample has brought so far, `eye`: number of the
// sensor's vertex.
fn connect_by_chance(
    joint: ptr<function, Joint>, weight: f32, radiance: vec3<f32>, sampler: BlockSampler, eye: u32,
) {
    let brings = math_mean((*joint).carried) * weight;
    let enough = JOINT_SMALL * math_mean(radiance);
    if brings < enough && !(*joint).to_camera && job.only_s == JOB_ALL {
        let chance = brings / enough;
        let u = sobol_group2(sampler, CHANCE_GROUPS + ((*joint).light.index << 12u) + eye).x;
        (*joint).carried /= chance;
        if u >= chance { (*joint).goes = false; }
    }
}

//: if VOLUME
const FOLLOWED_WHOLE: u32 = 0u;
const FOLLOWED_BLOCKED: u32 = 1u;
const FOLLOWED_PART: u32 = 2u;

// A way to the other end of a joint, from where it has been followed to, and what is left of what it brings.
struct Followed {
    ray: Ray,
    lead: f32,
    length: f32,
    inside: Inside,
    crossed: u32,
    carried: vec3<f32>,
    // Mean chance over the channels to fly this far.
    through: f32,
}

// Goes on from where its ray has met a surface, or nothing.
fn connect_follow(way: ptr<function, Followed>, met: Hit) -> u32 {
    let ray = (*way).ray;
    let missed = met.primitive == TREE_NOTHING;
    let length = select((*way).lead + met.t, (*way).length, missed);
    let record = inside_current((*way).inside);
    if record != MEDIUM_NONE {
        let left = medium_transmittance(medium_new(record), ray, (*way).lead, length);
        (*way).carried *= left;
        (*way).through *= math_mean(left);
    }
    if missed { return FOLLOWED_WHOLE; }
    if !boundaries_passes(met.primitive) || (*way).crossed >= CROSSINGS_MAX { return FOLLOWED_BLOCKED; }
    let resolved = boundaries_resolve(ray, met, (*way).inside);
    if !boundaries_passes(resolved.hit.primitive) { return FOLLOWED_BLOCKED; }
    let surface = surface_at(ray, resolved.hit);
    if !surface.found { return FOLLOWED_BLOCKED; }
    //: if LOBES
    let straight = interface_straight(surface.interface_);
    if straight.found {
        (*way).carried *= straight.transmit;
        (*way).through *= straight.chance;
    }
    //: end
    if math_is_zero3((*way).carried) { return FOLLOWED_BLOCKED; }
    let origin = geometry_offset_origin(surface.point, surface.geometric, ray.direction);
    // It ends where it ended before.
    if ray.t_max < MAX_FLOAT { (*way).ray.t_max = ray.t_max - math_dot(origin - ray.origin, ray.direction); }
    (*way).ray.origin = origin;
    (*way).lead = way_lead(surface.point.position, surface.geometric, origin, ray.direction);
    (*way).length = math_max((*way).length - length, 0.0f);
    (*way).inside = resolved.inside;
    (*way).crossed += 1u;
    return FOLLOWED_PART;
}
//: end
