use std::time::Instant;
use etendue_core::codec::bc1;
fn main() {
    let w = 256; let h = 256;
    let mut img = vec![0u8; w * h * 4];
    let mut s = 1u64;
    for y in 0..h { for x in 0..w {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let n = ((s >> 33) % 32) as f64;
        let f = |k: f64, p: f64| (128.0 + 90.0 * ((x as f64) * k + p).sin() * ((y as f64) * k * 1.3 + p).cos() + n - 16.0).clamp(0.0, 255.0) as u8;
        let o = (y * w + x) * 4;
        img[o] = f(0.05, 0.0); img[o+1] = f(0.07, 1.0); img[o+2] = f(0.03, 2.0); img[o+3] = 255;
    }}
    let nb = w * h / 16;
    let mut blocks = vec![[[0u8; 3]; 16]; nb];
    for b in 0..nb { let (bx, by) = (b % (w/4), b / (w/4)); for i in 0..16 { let o = ((by*4 + i/4)*w + bx*4 + i%4)*4; blocks[b][i] = [img[o], img[o+1], img[o+2]]; }}
    let psnr = |enc: &[[u8;8]]| { let mut e = 0u64; for (b, t) in enc.iter().zip(&blocks) { for (x, y) in bc1::decode(*b).iter().zip(t) { for c in 0..3 { let d = x[c] as i64 - y[c] as i64; e += (d*d) as u64; } } } 10.0*(255.0f64*255.0*(nb*48) as f64/e as f64).log10() };
    let mut out = vec![[0u8; 8]; nb];
    if let Ok(q) = std::env::var("ONLY") { let q = if q == "c" { bc1::Quality::Cluster } else { bc1::Quality::Refined }; for _ in 0..100 { etendue_cpu::bc1::encode_blocks(&blocks, q, bc1::Black::Allowed, &mut out).unwrap(); } return; }
    let time = |name: &str, f: &mut dyn FnMut(&mut Vec<[u8;8]>), out: &mut Vec<[u8;8]>| { let mut best = f64::MAX; for _ in 0..9 { let t = Instant::now(); f(out); best = best.min(t.elapsed().as_secs_f64()); } println!("{name:20} {:.3} dB {:.3} Mblocks/s", psnr(out), nb as f64/best/1e6); };
    time("intel", &mut |o| intel_tex_2::bc1::compress_blocks_into(&intel_tex_2::RgbaSurface { data: &img, width: w as u32, height: h as u32, stride: w as u32 * 4 }, o.as_flattened_mut()), &mut out);
    time("block_compression", &mut |o| block_compression::encode::compress_rgba8(block_compression::CompressionVariant::BC1, &img, o.as_flattened_mut(), w as u32, h as u32, w as u32 * 4), &mut out);
    for (n, a) in [("tp range", texpresso::Algorithm::RangeFit), ("tp cluster", texpresso::Algorithm::ClusterFit), ("tp iter", texpresso::Algorithm::IterativeClusterFit)] {
        time(n, &mut |o| texpresso::Format::Bc1.compress(&img, w, h, texpresso::Params { algorithm: a, weights: [1.0;3], weigh_colour_by_alpha: false }, o.as_flattened_mut()), &mut out);
    }
    time("our range", &mut |o| for (b, t) in o.iter_mut().zip(&blocks) { *b = bc1::encode_range_fit(t, 0xffff) }, &mut out);

    use bc1::{Quality as Q, Black as B};
    for q in Q::ALL { for b in [B::Avoided, B::Allowed] {
        time(&format!("{q:?} {b:?}"), &mut |o| etendue_cpu::bc1::encode_blocks(&blocks, q, b, o).unwrap(), &mut out);
    }
        if q <= Q::Cluster { time("sse", &mut |o| bc1::encode_blocks(&blocks, q, B::Avoided, o).unwrap(), &mut out); }
    }
}
