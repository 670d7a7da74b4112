//! Core's relighter on the device.

use super::product::{Dispatch, Product};
use super::{ANOTHER, SUBMIT_BYTES, spread, words};
use crate::gpu::{Binding, Buffer, Gpu, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::radiosity::Identity;
use etendue_core::radiosity::relight::{CoarseView, Pair, RelightError, Relighter, View};
use etendue_core::radiosity::tiles::{Planes, SIDE, Tiles, tile_rows};
use std::sync::{Arc, Mutex, PoisonError};

/// Lists of numbers per patch in the state; see `relight/passes.wgsl`.
const STATES: usize = 5;
const LAST: usize = 3;
const SUM: usize = 4;
/// Invocations of a workgroup.
const WORKGROUP: u32 = 64;

/// The second level's dispatches.
#[derive(Debug)]
struct Level {
    gather: Dispatch,
    product: Product,
    remain: Dispatch,
}

/// A relighter that is on the device, with room for one relighting at a time.
#[derive(Debug)]
pub struct Operator {
    gpu: Arc<Gpu>,
    identity: Identity,
    rows: usize,
    product: Product,
    coarse: Option<Level>,
    begin: Dispatch,
    /// Without a weight, then with each weight.
    finish: Vec<Dispatch>,
    state: Buffer,
    /// The state is one job's at a time.
    turn: Mutex<()>,
}

/// Sources of each patch's near light, in the order in which core adds them.
fn near(pairs: &[Pair], patches: usize) -> Vec<u32> {
    let mut lists: Vec<Vec<[u32; 2]>> = vec![Vec::new(); patches];
    for Pair { patches: [i, j], factors } in pairs {
        for (to, source, factor) in [(*i, *j, factors[0]), (*j, *i, factors[1])] {
            if let Some(list) = lists.get_mut(to as usize) {
                list.push([source, factor.to_bits()]);
            }
            if i == j {
                break;
            }
        }
    }
    let mut out = Vec::with_capacity(patches + 1);
    let mut start = 0;
    for list in &lists {
        out.push(start);
        start += list.len() as u32;
    }
    out.push(start);
    out.extend(lists.iter().flatten().flatten());
    out
}

/// What does not change, in the order of `relight/passes.wgsl`.
fn fixed(view: &View<'_>) -> Vec<f32> {
    let mut fixed = [view.into.as_flattened(), view.out.as_flattened()].concat();
    fixed.extend(view.albedo.as_flattened().as_flattened());
    if let Some(CoarseView { spread, shares, into, out, .. }) = view.coarse {
        for list in [spread, shares, into, out] {
            fixed.extend(list.as_flattened());
        }
    }
    fixed
}

impl Operator {
    /// Uploads a relighter.
    ///
    /// # Errors
    /// [`BackendError::LimitExceeded`] where numbers per patch or a stripe of tiles exceed a binding; what the device refuses.
    pub(crate) fn new(gpu: &Arc<Gpu>, relighter: &Relighter) -> Result<Self, BackendError> {
        gpu.scoped(|| Self::make(gpu, relighter))
    }

    fn make(gpu: &Arc<Gpu>, relighter: &Relighter) -> Result<Self, BackendError> {
        let view = relighter.view();
        let rows = tile_rows(relighter.len());
        let planes = |rows: usize| (rows * 3 * SIDE) as u64;
        let fixed = gpu.upload("fixed numbers of patches", words(&fixed(&view)))?;
        let near = gpu.upload("near patches", &near(view.near, SIDE * rows))?;
        let state = gpu.room("light of patches", STATES as u64 * planes(rows))?;
        let [x, y] = [gpu.room("x", planes(rows))?, gpu.room("y", planes(rows))?];
        let clusters = if view.coarse.is_some() { tile_rows(rows) } else { 0 };
        let [cluster_x, cluster_y] =
            [gpu.room("x of clusters", planes(clusters))?, gpu.room("y of clusters", planes(clusters))?];
        let coarse = view.coarse.is_some();
        let step = |entry: &'static str, weight: f32| -> Result<Dispatch, BackendError> {
            let name = if coarse { "relight::passes, with clusters" } else { "relight::passes" };
            let features: &[&str] = if coarse { &["COARSE"] } else { &[] };
            let link = Link { root: "//: use relight::passes", features, mutations: &[] };
            let mut bindings = [Binding::Write; 8];
            bindings[..3].copy_from_slice(&[Binding::Uniform, Binding::Read, Binding::Read]);
            let pipeline = gpu.pipeline(PipelineKey { name: name.into(), entry }, link, &bindings)?;
            let part = [rows as u32, weight.to_bits(), view.damping.to_bits(), 0];
            let part = gpu.uniform("a pass", &part);
            let buffers = [&part, &fixed, &near, &state, &x, &y, &cluster_x, &cluster_y];
            let group = gpu.bind(&pipeline, &buffers);
            let [gx, gy] = spread(gpu, (3 * rows as u32).div_ceil(WORKGROUP));
            Ok(Dispatch { pipeline, group, groups: [gx, gy, 1] })
        };
        let level = |tiles: &[Tiles; 3]| -> Result<Level, BackendError> {
            Ok(Level {
                gather: step("pass_gather", 1.0)?,
                product: Product::new(gpu, &tiles.each_ref(), &cluster_x, &cluster_y)?,
                remain: step("pass_remain", 1.0)?,
            })
        };
        let weights = std::iter::once(&1.0).chain(view.weights);
        Ok(Self {
            gpu: gpu.clone(),
            identity: relighter.identity().clone(),
            rows,
            product: Product::new(gpu, &[view.tiles], &x, &y)?,
            coarse: view.coarse.map(|c| level(c.tiles)).transpose()?,
            begin: step("pass_begin", 1.0)?,
            finish: weights.map(|w| step("pass_finish", *w)).collect::<Result<_, _>>()?,
            state,
            turn: Mutex::new(()),
        })
    }

    /// Whether it is of this relighter as it is now.
    pub fn is_of(&self, relighter: &Relighter) -> bool {
        self.identity.is(relighter.identity())
    }

    /// Whether it is on this device.
    pub(crate) fn is_on(&self, gpu: &Arc<Gpu>) -> bool {
        Arc::ptr_eq(&self.gpu, gpu)
    }

    /// How many parts the form factors are in, since a binding has its limit.
    pub fn parts(&self) -> usize {
        self.product.parts
    }

    /// [`Relighter::relight`] of the relighter that it was made of.
    ///
    /// # Errors
    /// As there, or of the device.
    pub fn relight(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
    ) -> Result<(), RelightError> {
        let start = self.start(relighter, light, indirect.len())?;
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let weighted = relighter.weights().len() == passes as usize;
        let sum = self.gpu.scoped(|| {
            let mut encoder = self.begin(&start);
            let mut bytes = 0;
            for pass in 0..passes as usize {
                self.pass(&mut encoder, if weighted { pass + 1 } else { 0 });
                bytes += self.product.bytes + self.coarse.as_ref().map_or(0, |c| c.product.bytes);
                if bytes > SUBMIT_BYTES {
                    self.gpu.submit(std::mem::replace(&mut encoder, self.gpu.encoder()));
                    bytes = 0;
                }
            }
            self.read(encoder, SUM)
        })?;
        give(&sum, indirect);
        Ok(())
    }

    /// [`Relighter::converge`] of the relighter that it was made of. Irradiance comes back after each pass.
    ///
    /// # Errors
    /// As there, or of the device.
    pub fn converge(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        (most, tolerance): (u32, f64),
    ) -> Result<u32, RelightError> {
        let start = self.start(relighter, light, indirect.len())?;
        let tolerance = if tolerance > 0.0 { tolerance } else { f64::MIN_POSITIVE };
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let (done, sum) = self.gpu.scoped(|| {
            let mut last = self.read(self.begin(&start), LAST)?;
            let mut done = 0;
            while done < most {
                let mut encoder = self.gpu.encoder();
                self.pass(&mut encoder, 0);
                let next = self.read(encoder, LAST)?;
                done += 1;
                let stands = relighter.change(&next, &last) <= tolerance;
                last = next;
                if stands {
                    break;
                }
            }
            Ok((done, self.read(self.gpu.encoder(), SUM)?))
        })?;
        give(&sum, indirect);
        Ok(done)
    }

    fn start(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: usize,
    ) -> Result<Vec<Planes<3>>, RelightError> {
        if !self.is_of(relighter) {
            return Err(ANOTHER.into());
        }
        let mut start = vec![Planes::<3>::default(); self.rows];
        relighter.start(light, indirect, &mut start)?;
        Ok(start)
    }

    /// Uploads a light; what precedes the first pass.
    fn begin(&self, start: &[Planes<3>]) -> wgpu::CommandEncoder {
        let start = bytemuck::cast_slice(start.as_flattened().as_flattened());
        if !start.is_empty() {
            self.gpu.queue.write_buffer(&self.state.raw, 0, start);
        }
        let mut encoder = self.gpu.encoder();
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            if let Some(coarse) = &self.coarse {
                coarse.gather.encode(&mut pass);
                coarse.product.encode(&mut pass);
            }
            self.begin.encode(&mut pass);
        }
        encoder
    }

    fn pass(&self, encoder: &mut wgpu::CommandEncoder, weight: usize) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        self.product.encode(&mut pass);
        if let Some(coarse) = &self.coarse {
            coarse.remain.encode(&mut pass);
            coarse.product.encode(&mut pass);
        }
        if let Some(finish) = self.finish.get(weight) {
            finish.encode(&mut pass);
        }
    }

    /// Sends what is encoded; one of the state's lists after it.
    fn read(&self, encoder: wgpu::CommandEncoder, list: usize) -> Result<Vec<Planes<3>>, BackendError> {
        let words = (self.rows * 3 * SIDE) as u64;
        let from = (&self.state, list as u64 * words);
        let found = self.gpu.submit_and_read_from(encoder, from, words).wait(&self.gpu)?;
        Ok(bytemuck::pod_collect_to_vec(&found))
    }
}

fn give(planes: &[Planes<3>], indirect: &mut [[f32; 3]]) {
    for (i, e) in indirect.iter_mut().enumerate() {
        *e = planes.get(i / SIDE).map_or([0.0; 3], |p| [0, 1, 2].map(|c| p[c][i % SIDE]));
    }
}
