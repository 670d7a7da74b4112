// Samples of a light on a triangle that is cut into pieces.
//: use direct::irradiance
//: use tree::walk
//: if VOLUME
//: use transport::volume::lights
//: end

const FIRST_SHOT_INSET: f32 = 1.0f / 2048.0f;

// Barycentrics that are no less than the inset.
fn first_shot_inset(b: vec3<f32>) -> vec3<f32> {
    let inner = vec3(
        math_max_number(b.x, FIRST_SHOT_INSET),
        math_max_number(b.y, FIRST_SHOT_INSET),
        math_max_number(b.z, FIRST_SHOT_INSET),
    );
    let sum = inner.x + inner.y + inner.z;
    return inner / sum;
}

// Mean of the channels of what arrives, and the rays that took.
struct FirstShotSample { irradiance: f32, rays: u32 }

//: if VOLUME
// `inside`: what the light sends into, and what is outside.
fn first_shot_sample(
    triangle: u32, light: u32, at: vec3<f32>, inside: Inside, outside: Inside,
) -> FirstShotSample {
//: else
fn first_shot_sample(triangle: u32, light: u32, at: vec3<f32>) -> FirstShotSample {
//: end
    let b = first_shot_inset(at);
    let point = surface_on(triangle, b.y, b.z);
    let normal = surface_front(triangle);
    let direct = irradiance_from_light(light, point, normal);
    var sample = FirstShotSample(0.0f, 0u);
    if direct.found {
        //: if VOLUME
        let followed = lights_follow(LIGHTS_BACK, direct.ray, inside, outside, point.position, normal, false);
        sample = FirstShotSample(math_mean(direct.irradiance * followed.left), followed.rays);
        //: else
        let hidden = tree_occluded(direct.ray);
        sample = FirstShotSample(select(math_mean(direct.irradiance), 0.0f, hidden), 1u);
        //: end
    }
    return sample;
}
