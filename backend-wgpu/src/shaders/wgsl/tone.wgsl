// From linear light to what a display shows.
//: use math::choice
//: use math::consts
//: use math::exp_ln
//: use math::pow
//: use math::vector

const TONE_REINHARD: u32 = 0u;
const TONE_GAMMA: u32 = 1u;
const TONE_NONE: u32 = 2u;

struct ToneSettings { map: u32, exposure: f32, gamma_a: f32, gamma_c: f32, gamma: f32 }

// NaN becomes 0, and so does -0, which drivers lose in sums with 0.
fn tone_light(x: f32) -> f32 {
    if x > 0.0f { return math_min(x, MAX_FLOAT); }
    return 0.0f;
}

fn tone_exposure_factor(stops_in: f32) -> f32 {
    if math_is_nan(stops_in) { return 1.0f; }
    let stops = math_clamp_number(stops_in, -126.0f, 127.0f);
    let whole = i32(stops);
    let rest = stops - f32(whole);
    let power = math_pow2(whole);
    if rest == 0.0f { return power; }
    return power * math_exp(rest * LN_2);
}

fn tone_apply_one(settings: ToneSettings, factor: f32, x: f32) -> f32 {
    let e = tone_light(tone_light(x) * factor);
    if settings.map == TONE_REINHARD { return e / (1.0f + e); }
    if settings.map == TONE_GAMMA {
        return tone_light(settings.gamma_a * math_pow(tone_light(e + settings.gamma_c), settings.gamma));
    }
    return e;
}

fn tone_apply(settings: ToneSettings, rgb: vec3<f32>) -> vec3<f32> {
    let factor = tone_exposure_factor(settings.exposure);
    return vec3(
        tone_apply_one(settings, factor, rgb.x),
        tone_apply_one(settings, factor, rgb.y),
        tone_apply_one(settings, factor, rgb.z),
    );
}

fn tone_encode_srgb(linear: f32) -> f32 {
    let x = math_min_number(tone_light(linear), 1.0f);
    if x <= 0.0031308f { return 12.92f * x; }
    return math_clamp_number(1.055f * math_pow(x, 1.0f / 2.4f) - 0.055f, 0.0f, 1.0f);
}

fn tone_quantise8(value: f32) -> u32 { return u32(math_min_number(tone_light(value), 1.0f) * 255.0f + 0.5f); }

fn tone_display(settings: ToneSettings, rgb: vec3<f32>) -> vec3<f32> {
    let v = tone_apply(settings, rgb);
    if settings.map == TONE_GAMMA {
        return vec3(math_min_number(v.x, 1.0f), math_min_number(v.y, 1.0f), math_min_number(v.z, 1.0f));
    }
    return vec3(tone_encode_srgb(v.x), tone_encode_srgb(v.y), tone_encode_srgb(v.z));
}

fn tone_display_srgb8(settings: ToneSettings, rgb: vec3<f32>) -> vec3<u32> {
    let v = tone_display(settings, rgb);
    return vec3(tone_quantise8(v.x), tone_quantise8(v.y), tone_quantise8(v.z));
}
