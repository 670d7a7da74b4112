//! The fuzz targets without libFuzzer: seeds, and seeds changed at random, for SECONDS in all. Runs on stable, sees no
//! coverage; the same SEED gives the same inputs. `cargo run --no-default-features --bin smoke -- [SECONDS [SEED]]`

use etendue_fuzz::TARGETS;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

fn mutate(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    const WORDS: [&[u8]; 12] = [
        b"-1",
        b"0",
        b"nan",
        b"1e39",
        b"4294967296",
        b"[",
        b"]",
        b"\"",
        b"\n",
        b"\xff\xff\xff\xff",
        b"\0\0\0\0",
        b"\0\0\x80\x7f",
    ];
    let mut input = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(6) {
        let at = random.below(input.len() + 1);
        let end = (at + random.below(24)).min(input.len());
        match random.below(6) {
            0 if at < input.len() => input[at] ^= 1 << random.below(8),
            1 if at < input.len() => input[at] = random.below(256) as u8,
            2 => drop(input.drain(at..end)),
            3 => {
                let copy = input[at..end].to_vec();
                let to = random.below(input.len() + 1);
                input.splice(to..to, copy);
            }
            4 => drop(input.splice(at..end, WORDS[random.below(WORDS.len())].iter().copied())),
            _ => {
                let other = &seeds[random.below(seeds.len())];
                let cut = random.below(other.len() + 1);
                input.splice(at.., other[cut..].iter().copied());
            }
        }
    }
    input.truncate(1 << 14);
    input
}

fn main() {
    let number = |n: usize| std::env::args().nth(n).and_then(|s| s.parse::<u64>().ok());
    let (seconds, seed) = (number(1).unwrap_or(20), number(2).unwrap_or(1));
    let share = Duration::from_secs(seconds) / TARGETS.len() as u32;
    let (mut failed, mut passed) = (0, 0);
    for (name, target) in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds").join(name);
        let mut files: Vec<_> =
            fs::read_dir(&folder).expect("a folder of seeds").map(|e| e.expect("a seed").path()).collect();
        files.sort();
        let seeds: Vec<Vec<u8>> = files.iter().map(|f| fs::read(f).expect("a seed")).collect();
        assert!(!seeds.is_empty(), "no seeds in {}", folder.display());
        let mut random = Random(seed);
        let (start, mut runs) = (Instant::now(), 0_u64);
        let mut crash = None;
        while (runs as usize) < seeds.len() || start.elapsed() < share {
            let input = seeds.get(runs as usize).cloned().unwrap_or_else(|| mutate(&seeds, &mut random));
            runs += 1;
            if std::panic::catch_unwind(|| target(&input)).is_err() {
                crash = Some(input);
                break;
            }
        }
        println!("fuzz {name}: {runs} inputs in {:.1} s", start.elapsed().as_secs_f32());
        if let Some(input) = crash {
            let out = Path::new(env!("CARGO_MANIFEST_DIR")).join("artifacts");
            fs::create_dir_all(&out).expect("artifacts can be written");
            let file = out.join(format!("smoke-{name}"));
            fs::write(&file, input).expect("artifacts can be written");
            println!("fuzz {name}: FAILED, input kept in {}", file.display());
            failed += 1;
        } else {
            passed += 1;
        }
    }
    println!("fuzz: {passed} targets passed, {failed} failed");
    std::process::exit(i32::from(failed > 0));
}
