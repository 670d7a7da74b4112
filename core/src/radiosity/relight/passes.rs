//! Passes over the form factors.

use super::{Products, RelightError, Relighter, Workspace, add_sent, check, check_len, fill, planes};
use crate::math;
use crate::radiosity::tiles::{Planes, SIDE, Scratch, tile_rows};
use crate::sampling::counter::Counter;

/// Passes that find the largest part of the error that a pass takes away, and the largest that it may.
const SETTLE_PASSES: u32 = 24;
const SETTLED: f64 = 1.7;
const SETTLE_SEED: u64 = 0x5e77;

impl Workspace {
    /// Zeros for so many runs of patches.
    fn clear(&mut self, rows: usize) {
        for planes in [
            &mut self.start,
            &mut self.radiosity,
            &mut self.rest,
            &mut self.last,
            &mut self.sum,
            &mut self.x,
            &mut self.y,
        ] {
            planes.clear();
            planes.resize(rows, Planes::default());
        }
    }
}

/// What a product reads and writes.
struct Gather<'a> {
    radiosity: &'a [Planes<3>],
    x: &'a mut [Planes<3>],
    y: &'a mut [Planes<3>],
    scratch: &'a mut Scratch<3>,
}

impl Relighter {
    /// y = F B, in planes.
    fn gather<P: Products>(&self, products: &P, room: &mut Gather<'_>) {
        for ((x, b), into) in room.x.iter_mut().zip(room.radiosity).zip(&self.into) {
            for c in 0..3 {
                for k in 0..SIDE {
                    x[c][k] = b[c][k] * into[k];
                }
            }
        }
        products.apply(&self.tiles, room.x, room.y, room.scratch);
        for (y, out) in room.y.iter_mut().zip(&self.out) {
            for y in y {
                for k in 0..SIDE {
                    y[k] *= out[k];
                }
            }
        }
    }

    /// F x for three channels: one bounce without albedo. For baselines and checks.
    ///
    /// # Errors
    /// A wrong length.
    pub fn bounce<P: Products>(
        &self,
        products: &P,
        x: &[[f32; 3]],
        y: &mut [[f32; 3]],
    ) -> Result<(), RelightError> {
        check_len("x", x.len(), self.len())?;
        check_len("y", y.len(), self.len())?;
        let radiosity = planes(x);
        let mut room = (radiosity.clone(), radiosity.clone(), Scratch::default());
        let mut gather =
            Gather { radiosity: &radiosity, x: &mut room.0, y: &mut room.1, scratch: &mut room.2 };
        self.gather(products, &mut gather);
        for (i, y) in y.iter_mut().enumerate() {
            *y = [0, 1, 2].map(|c| room.1[i / SIDE][c][i % SIDE]);
        }
        Ok(())
    }

    /// Indirect irradiance \[W/m^2\] per patch from direct irradiance and what patches emit themselves (empty: nothing), by so many passes over the form factors.
    ///
    /// With clusters that is all bounces (with no pass, as clusters alone have it); without, as many as there are passes. It is linear in the light, and where little
    /// light comes it may be a little below 0. Nothing is allocated once the workspace has been used.
    ///
    /// # Errors
    /// A wrong length; irradiance that is not finite.
    pub fn relight<P: Products>(
        &self,
        products: &P,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
        room: &mut Workspace,
    ) -> Result<(), RelightError> {
        self.run(products, light, indirect, (passes, 0.0), room).map(|_| ())
    }

    /// [`Self::relight`] with as many passes as it takes until one changes irradiance, in the root mean square by area, by no more than this part, or until the most are made.
    /// How many were.
    ///
    /// # Errors
    /// As [`Self::relight`].
    pub fn converge<P: Products>(
        &self,
        products: &P,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        (most, tolerance): (u32, f64),
        room: &mut Workspace,
    ) -> Result<u32, RelightError> {
        self.run(
            products,
            light,
            indirect,
            (most, if tolerance > 0.0 { tolerance } else { f64::MIN_POSITIVE }),
            room,
        )
    }

    /// Relative change from one irradiance to the next, in runs of eight patches: what [`Self::converge`] compares.
    pub fn change(&self, next: &[Planes<3>], last: &[Planes<3>]) -> f64 {
        let (mut moved, mut all) = (0.0, 0.0);
        for (i, area) in self.areas.iter().enumerate() {
            for c in 0..3 {
                let [a, b] = [next, last].map(|x| f64::from(x[i / SIDE][c][i % SIDE]));
                moved += f64::from(*area) * (a - b) * (a - b);
                all += f64::from(*area) * a * a;
            }
        }
        if moved <= 0.0 {
            0.0
        } else if all > 0.0 {
            math::sqrt64(moved / all)
        } else {
            f64::INFINITY
        }
    }

    /// B0 = R E_direct + emission of light that [`Self::relight`] takes, in runs of eight patches: `start` has all of them, and zeros beyond the last patch. `indirect` is how many
    /// numbers are wanted.
    ///
    /// # Errors
    /// As [`Self::relight`].
    pub fn start(
        &self,
        (direct, emission): (&[[f32; 3]], &[[f32; 3]]),
        indirect: usize,
        start: &mut [Planes<3>],
    ) -> Result<(), RelightError> {
        let n = self.len();
        check_len("direct irradiance", direct.len(), n)?;
        check_len("indirect irradiance", indirect, n)?;
        check_len("runs of patches", start.len(), tile_rows(n))?;
        if !emission.is_empty() {
            check_len("emission", emission.len(), n)?;
        }
        check("direct irradiance", direct, f32::is_finite)?;
        check("emission", emission, f32::is_finite)?;
        fill(start, direct);
        for (b, rho) in start.iter_mut().zip(&self.albedo) {
            for c in 0..3 {
                for k in 0..SIDE {
                    b[c][k] *= rho[c][k];
                }
            }
        }
        for (i, emission) in emission.iter().enumerate() {
            for (b, e) in start[i / SIDE].iter_mut().zip(emission) {
                b[i % SIDE] += e;
            }
        }
        Ok(())
    }

    fn run<P: Products>(
        &self,
        products: &P,
        (direct, emission): (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        (passes, tolerance): (u32, f64),
        room: &mut Workspace,
    ) -> Result<u32, RelightError> {
        room.clear(tile_rows(self.len()));
        self.start((direct, emission), indirect.len(), &mut room.start)?;
        room.radiosity.copy_from_slice(&room.start);
        if let Some(coarse) = &self.coarse {
            let sent = coarse.apply(products, &room.start, &mut room.coarse);
            add_sent(&mut room.last, sent, coarse.spread());
            self.bounce_all(&room.start, &room.last, &mut room.radiosity);
            room.sum.copy_from_slice(&room.last);
        }
        let weights =
            if tolerance <= 0.0 && self.weights.len() == passes as usize { &self.weights[..] } else { &[] };
        let mut done = 0;
        for pass in 0..passes as usize {
            self.pass(products, room);
            let weight = weights.get(pass).copied().unwrap_or(1.0);
            for (sum, (y, last)) in room.sum.iter_mut().zip(room.y.iter().zip(&room.last)) {
                for c in 0..3 {
                    for k in 0..SIDE {
                        sum[c][k] += weight * (y[c][k] - last[c][k]);
                    }
                }
            }
            // B + r + R P Gc Q r = B0 + R (F B + P Gc Q r).
            self.bounce_all(&room.start, &room.y, &mut room.radiosity);
            let stands = tolerance > 0.0 && self.change(&room.y, &room.last) <= tolerance;
            core::mem::swap(&mut room.y, &mut room.last);
            done += 1;
            if stands {
                break;
            }
        }
        for (i, e) in indirect.iter_mut().enumerate() {
            *e = [0, 1, 2].map(|c| room.sum[i / SIDE][c][i % SIDE]);
        }
        Ok(done)
    }

    /// B = B0 + R E.
    fn bounce_all(&self, start: &[Planes<3>], irradiance: &[Planes<3>], radiosity: &mut [Planes<3>]) {
        for (((b, b0), e), rho) in radiosity.iter_mut().zip(start).zip(irradiance).zip(&self.albedo) {
            for c in 0..3 {
                for k in 0..SIDE {
                    b[c][k] = b0[c][k] + rho[c][k] * e[c][k];
                }
            }
        }
    }

    /// From irradiance `last` and the radiosity that it makes of the start, the next irradiance, in y.
    fn pass<P: Products>(&self, products: &P, room: &mut Workspace) {
        let mut gather =
            Gather { radiosity: &room.radiosity, x: &mut room.x, y: &mut room.y, scratch: &mut room.scratch };
        self.gather(products, &mut gather);
        let Some(coarse) = &self.coarse else { return };
        // r = B0 + R F B - B.
        self.bounce_all(&room.start, &room.y, &mut room.rest);
        for (r, b) in room.rest.as_flattened_mut().iter_mut().zip(room.radiosity.as_flattened()) {
            for k in 0..SIDE {
                r[k] -= b[k];
            }
        }
        let sent = coarse.apply(products, &room.rest, &mut room.coarse);
        add_sent(&mut room.y, sent, coarse.spread());
        // What clusters cannot hold goes once more to where most of it goes.
        coarse.subtract_means(&mut room.rest);
        room.x.iter_mut().for_each(|x| *x = Planes::default());
        self.near.add(&room.rest, &mut room.x);
        coarse.subtract_means(&mut room.x);
        for (y, x) in room.y.as_flattened_mut().iter_mut().zip(room.x.as_flattened()) {
            for k in 0..SIDE {
                y[k] += x[k];
            }
        }
        if self.damping < 1.0 {
            for (y, last) in room.y.as_flattened_mut().iter_mut().zip(room.last.as_flattened()) {
                for k in 0..SIDE {
                    y[k] = last[k] + self.damping * (y[k] - last[k]);
                }
            }
        }
    }

    /// The damping with which no part of the error grows from pass to pass.
    ///
    /// Surfaces that face each other closely send light to and fro, which a pass overshoots: parts of the error are multiplied by 1 - w with w up to 2.5, where clusters add their share. The largest w is
    /// found by repeated passes over darkness.
    pub(super) fn settled<P: Products>(mut self, products: &P) -> Self {
        self.damping = 1.0;
        if self.coarse.is_none() {
            return self;
        }
        let mut room = Workspace::default();
        room.clear(tile_rows(self.len()));
        let numbers = Counter::new(SETTLE_SEED);
        for (i, block) in room.last.iter_mut().enumerate() {
            for (c, plane) in block.iter_mut().enumerate() {
                for (k, x) in plane.iter_mut().enumerate() {
                    *x = if SIDE * i + k < self.areas.len() {
                        numbers.unit(c as u32, (SIDE * i + k) as u32, 0) - 0.5
                    } else {
                        0.0
                    };
                }
            }
        }
        let mut most = 0.0;
        for _ in 0..SETTLE_PASSES {
            let before = self.norm(&room.last);
            self.bounce_all(&room.start, &room.last, &mut room.radiosity);
            self.pass(products, &mut room);
            // What a pass takes away: w times each part.
            for (y, last) in room.y.as_flattened_mut().iter_mut().zip(room.last.as_flattened()) {
                for k in 0..SIDE {
                    y[k] = last[k] - y[k];
                }
            }
            let after = self.norm(&room.y);
            if !(before > 0.0 && after > 0.0 && after.is_finite()) {
                return self;
            }
            most = after / before;
            let scale = (1.0 / after) as f32;
            for (last, y) in room.last.as_flattened_mut().iter_mut().zip(room.y.as_flattened()) {
                *last = y.map(|y| scale * y);
            }
        }
        if most > SETTLED {
            self.damping = (SETTLED / most) as f32;
        }
        self
    }

    /// Root of the sum over patches of area x irradiance^2 x albedo, the measure in which passes are symmetric.
    fn norm(&self, values: &[Planes<3>]) -> f64 {
        let mut sum = 0.0;
        for (i, area) in self.areas.iter().enumerate() {
            for (plane, rho) in values[i / SIDE].iter().zip(&self.albedo[i / SIDE]) {
                let x = f64::from(plane[i % SIDE]);
                sum += f64::from(*area) * f64::from(rho[i % SIDE]) * x * x;
            }
        }
        math::sqrt64(sum)
    }
}
