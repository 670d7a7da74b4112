// How far light flies in a homogeneous medium.
//: use math::choice
//: use math::exp_ln
//: use math::vector

struct Flight { length: f32, collided: bool, weight: vec3<f32>, left: vec3<f32> }

fn flight_left(sigma: f32, length: f32) -> f32 {
    if sigma > 0.0f { return math_exp(-sigma * length); }
    return 1.0f;
}

// Per channel, of the integral of a density per channel.
fn flight_transmittance_of(sigma_t: vec3<f32>, optical: vec3<f32>) -> vec3<f32> {
    return vec3(
        flight_left(sigma_t.x, optical.x),
        flight_left(sigma_t.y, optical.y),
        flight_left(sigma_t.z, optical.z),
    );
}

fn flight_transmittance(sigma_t: vec3<f32>, length: f32) -> vec3<f32> {
    return flight_transmittance_of(sigma_t, vec3(length));
}

fn flight_emitted_one(j: f32, sigma: f32, length: f32) -> f32 {
    let tau = sigma * length;
    if j <= 0.0f || (sigma <= 0.0f && length > MAX_FLOAT) { return 0.0f; }
    if tau < 0.1f {
        return j * length
            * (1.0f - tau * (0.5f - tau * (1.0f / 6.0f - tau * (1.0f / 24.0f - tau * (1.0f / 120.0f)))));
    }
    return j / sigma * (1.0f - math_exp(-tau));
}

fn flight_emitted(emission: vec3<f32>, sigma_t: vec3<f32>, length: f32) -> vec3<f32> {
    return vec3(
        flight_emitted_one(emission.x, sigma_t.x, length),
        flight_emitted_one(emission.y, sigma_t.y, length),
        flight_emitted_one(emission.z, sigma_t.z, length),
    );
}

fn flight_channels(carried: vec3<f32>) -> vec3<f32> {
    let sum = carried.x + carried.y + carried.z;
    if sum > 0.0f && sum <= MAX_FLOAT { return carried / sum; }
    return vec3(1.0f / 3.0f);
}

fn flight_pick(p: vec3<f32>, u: f32) -> u32 {
    if u < p.x { return 0u; }
    if u < p.x + p.y { return 1u; }
    return 2u;
}

// The optical length that a number draws: infinite where a channel is not extinguished.
fn flight_wanted(sigma: f32, u: f32) -> f32 {
    if sigma > 0.0f { return -math_ln(1.0f - u) / sigma; }
    return math_infinity();
}

fn flight_sample(sigma_t: vec3<f32>, carried: vec3<f32>, limit: f32, u: vec2<f32>) -> Flight {
    let p = flight_channels(carried);
    var length = flight_wanted(math_component(sigma_t, flight_pick(p, u.x)), u.y);
    let collided = length < limit;
    if !collided { length = limit; }
    let left = flight_transmittance(sigma_t, length);
    var density = math_dot(p, left);
    if collided { density = math_dot(p, sigma_t * left); }
    var weight = vec3(0.0f);
    if density > 0.0f { weight = left / density; }
    return Flight(length, collided, weight, left);
}
