// A direction that was drawn.

// `found` is false where the light is absorbed; a density of 0 marks a direction without one.
struct BsdfSample { found: bool, wi: vec3<f32>, weight: vec3<f32>, pdf: f32 }

fn bsdf_absorbed() -> BsdfSample { return BsdfSample(false, vec3(0.0f), vec3(0.0f), 0.0f); }

// f per channel, and the density.
struct BsdfValue { f: vec3<f32>, pdf: f32 }
