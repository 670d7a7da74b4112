// Constants, each the float nearest to the true value.

const PI: f32 = 3.14159274f;
const TAU: f32 = 6.28318548f;
const HALF_PI: f32 = 1.57079637f;
const INV_PI: f32 = 0.318309873f;
const INV_TAU: f32 = 0.15915494f;
const INV_FOUR_PI: f32 = 0.07957747f;
const LN_2: f32 = 0.693147182f;
const HALF_PI_LOW: f32 = -4.371139e-8f;
const PI_LOW: f32 = -8.742278e-8f;
