//! BC1 on this machine's registers and threads: the bits of core.

use etendue_core::codec::bc1::{self, Black, LengthError, Quality, Texels};
use etendue_cpu::bc1::{encode_blocks, encode_blocks_parallel};

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }
}

fn blocks(n: usize) -> Vec<Texels> {
    let mut random = Random(7);
    (0..n)
        .map(|k| {
            let spread = 1 << (k % 9);
            let base = [0; 3].map(|_: u64| random.below(256));
            let dark = k % 5 == 0;
            [(); 16].map(|()| {
                if dark && random.below(3) == 0 {
                    [0; 3]
                } else {
                    base.map(|b| (b + random.below(spread)).min(255) as u8)
                }
            })
        })
        .collect()
}

#[test]
fn registers_give_the_bits_of_arrays() {
    for (quality, n) in [
        (Quality::RangeFit, 3000),
        (Quality::LeastSquares, 30_003),
        (Quality::Cluster, 3000),
        (Quality::Refined, 1000),
        (Quality::Exhaustive, 30),
    ] {
        let texels = blocks(n);
        for black in [Black::Allowed, Black::Avoided] {
            let (mut here, mut there) = (vec![[0; 8]; n], vec![[1; 8]; n]);
            encode_blocks(&texels, quality, black, &mut here).unwrap();
            bc1::encode_blocks(&texels, quality, black, &mut there).unwrap();
            assert_eq!(here, there, "{quality:?}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let texels = blocks(4321);
    for quality in [Quality::LeastSquares, Quality::Cluster] {
        let mut one = vec![[0; 8]; texels.len()];
        encode_blocks(&texels, quality, Black::Allowed, &mut one).unwrap();
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut out = vec![[0; 8]; texels.len()];
            pool.install(|| encode_blocks_parallel(&texels, quality, Black::Allowed, &mut out)).unwrap();
            assert_eq!(out, one);
        }
    }
    let wrong = Err(LengthError { texels: 4321, blocks: 1 });
    assert_eq!(encode_blocks_parallel(&texels, Quality::RangeFit, Black::Allowed, &mut [[0; 8]]), wrong);
    assert_eq!(encode_blocks(&texels, Quality::RangeFit, Black::Allowed, &mut [[0; 8]]), wrong);
}
