//! What goes wrong is told and leaves nothing half done: lost devices, limits, cancelled jobs; and what hosts do with sessions.

mod adapter;

use etendue_conformance::golden;
use etendue_conformance::scenes::{camera, mesh};
use etendue_core::backend::{
    Backend, BackendError, BidirectionalJob, Control, NoControl, PathJob, Session, image_film_settings,
    probe_film_settings,
};
use etendue_core::film::Film;
use etendue_core::sampling::counter::Counter;
use etendue_core::scene::{CompiledScene, SceneDesc, TextureDesc, Wrap, compile};
use etendue_cpu::CpuBackend;
use etendue_tree::WideTree;
use etendue_wgpu::{Options, Step, WgpuBackend, wgpu};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

fn compiled(scene: &SceneDesc) -> Arc<CompiledScene> {
    Arc::new(compile(scene).unwrap().0)
}

fn terrace() -> SceneDesc {
    golden::scenes().into_iter().find(|s| s.name == "terrace").unwrap().scene
}

/// Some waves of paths.
fn job(blocks: std::ops::Range<u32>) -> PathJob {
    PathJob { seed: 5, block_length: 32, blocks, max_depth: 6 }
}

fn empty(scene: &CompiledScene, job: &PathJob) -> Film {
    Film::new(image_film_settings(scene, job).unwrap())
}

fn image(session: &dyn Session, job: &PathJob, control: &dyn Control) -> Result<Film, BackendError> {
    let mut film = empty(session.scene(), job);
    let before = film.clone();
    let done = session.path_image(job, control, &mut film);
    if let Err(e) = done {
        assert!(film == before, "an error changed the film");
        return Err(e);
    }
    Ok(film)
}

/// Does something at the first so many reports of progress.
struct AtFirst<F> {
    times: u32,
    seen: AtomicU32,
    work: F,
}

impl<F: Fn() -> ControlFlow<()> + Sync> AtFirst<F> {
    fn new(times: u32, work: F) -> Self {
        Self { times, seen: AtomicU32::new(0), work }
    }
}

impl<F: Fn() -> ControlFlow<()> + Sync> Control for AtFirst<F> {
    fn advance(&self, done: u64, total: u64) -> ControlFlow<()> {
        assert!(done <= total);
        if self.seen.fetch_add(1, Ordering::Relaxed) < self.times {
            (self.work)()
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn a_job_whose_device_is_lost_is_done_again_on_a_fresh_one() {
    let Some(backend) = adapter::backend() else { return };
    let session = backend.open(compiled(&terrace())).unwrap();
    let whole = image(&*session, &job(0..8), &NoControl).unwrap();
    let lose = |times| {
        AtFirst::new(times, || {
            backend.lose_device();
            ControlFlow::Continue(())
        })
    };
    let once = lose(1);
    assert!(image(&*session, &job(0..8), &once).unwrap() == whole);
    assert!(once.seen.into_inner() > 2, "the device was not lost in the middle");
    // Between jobs.
    backend.lose_device();
    assert!(image(&*session, &job(0..8), &NoControl).unwrap() == whole);
    // Again and again is for the host to hear.
    let found = image(&*session, &job(0..8), &lose(u32::MAX));
    assert!(matches!(found, Err(BackendError::DeviceLost { .. })), "{found:?}");
    assert!(image(&*session, &job(0..8), &NoControl).unwrap() == whole);
    // What is opened on a lost device, and kernels there.
    backend.lose_device();
    assert!(backend.open(compiled(&terrace())).is_ok());
    backend.lose_device();
    let mut out = [0; 1];
    backend.map(etendue_core::kernel::Kernel::U32ToUnit, &[], &[1 << 31], &mut out).unwrap();
    assert_eq!(out, [0.5_f32.to_bits()]);
}

/// A device such as a host has, made of the best adapter.
fn host_device() -> Option<(wgpu::Device, wgpu::Queue)> {
    let wanted = adapter::backend()?.info().adapter;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let list = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let adapter = list.into_iter().find(|a| wanted.starts_with(&a.get_info().name)).unwrap();
    let descriptor = wgpu::DeviceDescriptor {
        required_features: adapter.features() & wgpu::Features::PASSTHROUGH_SHADERS,
        required_limits: adapter.limits(),
        ..Default::default()
    };
    Some(pollster::block_on(adapter.request_device(&descriptor)).unwrap())
}

#[test]
fn a_hosts_lost_device_is_told() {
    let Some((device, queue)) = host_device() else { return };
    let backend = WgpuBackend::from_device(device.clone(), queue);
    let session = backend.open(compiled(&terrace())).unwrap();
    let whole = image(&*session, &job(0..8), &NoControl).unwrap();
    let ours = adapter::backend().unwrap();
    let same = image(&*ours.open(compiled(&terrace())).unwrap(), &job(0..8), &NoControl).unwrap();
    assert!(whole == same || !backend.is_exact());
    let lose = AtFirst::new(1, || {
        device.destroy();
        ControlFlow::Continue(())
    });
    for control in [&lose as &dyn Control, &NoControl] {
        let found = image(&*session, &job(0..8), control);
        assert!(matches!(found, Err(BackendError::DeviceLost { .. })), "{found:?}");
    }
    let mut out = [7; 1];
    let found = backend.map(etendue_core::kernel::Kernel::U32ToUnit, &[], &[0], &mut out);
    assert!(matches!(found, Err(BackendError::DeviceLost { .. })), "{found:?}");
    let opened = backend.open(compiled(&terrace())).map(|_| ());
    assert!(matches!(opened, Err(BackendError::DeviceLost { .. })), "{opened:?}");
}

/// Shreds under printed ground, with few corners for many triangles: so records need less room than the tree's triangles.
fn ground() -> SceneDesc {
    const SIDE: u32 = 20;
    let corner = |i: u32| {
        let [x, y] = [i % SIDE, i / SIDE].map(|k| 6.0 * k as f32 / SIDE as f32 - 3.0);
        [x, y, 0.2 * (i * 7 % 5) as f32 / 5.0 - 0.3]
    };
    let positions = (0..SIDE * SIDE).map(corner).collect();
    let random = Counter::new(1);
    let shred = |i: u32| {
        let at = random.bits4(0, i, 0);
        let first = at[0] % (SIDE * (SIDE - 4));
        [first, first + 1 + at[1] % 3, first + SIDE * (1 + at[2] % 3) + at[3] % 3]
    };
    let triangles = (0..4000).map(shred).collect();
    let mut scene = terrace();
    scene.meshes.push(mesh(positions, triangles, "white"));
    let texels = (0..240 * 240_u32).map(|i| [i % 251, i % 241, i % 239].map(|x| x as u8)).collect();
    scene.textures =
        vec![TextureDesc { name: "print".into(), width: 240, height: 240, texels, wrap: Wrap::Repeat }];
    scene.camera = Some(camera([0.5, -4.0, 2.2], [0.0, 0.0, 0.5], 55.0, [32, 20]));
    scene
}

fn narrow(bytes: u64) -> Option<WgpuBackend> {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: bytes, ..wgpu::Limits::default() };
    adapter::backend_with(Options { limits: Some(limits), ..Options::default() })
}

#[test]
fn what_one_binding_does_not_hold_is_in_two() {
    let Some(wide) = adapter::backend() else { return };
    let scene = compiled(&ground());
    let blocks = 320 * WideTree::build(&scene.primitives()).parts().blocks.len() as u64;
    let texels = 4 * scene.texels.len() as u64;
    // Less than either.
    let allowed = blocks.min(texels) - 320;
    println!("{blocks} bytes of triangles, {texels} of texels, {allowed} allowed");
    let Some(small) = narrow(allowed) else { return };
    let film = |backend: &WgpuBackend| {
        image(&*backend.open(scene.clone()).unwrap(), &job(0..4), &NoControl).unwrap()
    };
    assert!(film(&small) == film(&wide));
    // Less than the half.
    let Some(cramped) = narrow(blocks.max(texels) / 2 - 320) else { return };
    let refused = cramped.open(scene.clone()).map(|_| ());
    let Err(BackendError::LimitExceeded { what, asked, allowed }) = refused else { panic!("{refused:?}") };
    assert!(asked > allowed);
    let said = BackendError::LimitExceeded { what, asked, allowed }.to_string();
    println!("{said}");
    assert!([asked.to_string(), allowed.to_string()].iter().all(|n| said.contains(n.as_str())), "{said}");
}

#[test]
fn a_cancelled_job_leaves_its_film() {
    let Some(backend) = adapter::backend() else { return };
    let session = backend.open(compiled(&terrace())).unwrap();
    let mut film = image(&*session, &job(0..2), &NoControl).unwrap();
    let before = film.clone();
    let stop = AtFirst::new(1, || ControlFlow::Break(()));
    let found = session.path_image(&job(2..20), &stop, &mut film);
    assert!(matches!(found, Err(BackendError::Cancelled)), "{found:?}");
    assert!(film == before);
    session.path_image(&job(2..4), &NoControl, &mut film).unwrap();
    assert!(film == image(&*session, &job(0..4), &NoControl).unwrap());
}

#[test]
fn threads_share_a_session_and_it_takes_many_jobs() {
    let Some(backend) = adapter::backend() else { return };
    let session = backend.open(compiled(&terrace())).unwrap();
    let whole = image(&*session, &job(0..4), &NoControl).unwrap();
    let parts = std::thread::scope(|threads| {
        let part = |blocks: std::ops::Range<u32>| {
            let session = &*session;
            threads.spawn(move || {
                // Many jobs on what was opened once.
                let mut film = empty(session.scene(), &job(blocks.clone()));
                for block in blocks {
                    session.path_image(&job(block..block + 1), &NoControl, &mut film).unwrap();
                }
                film
            })
        };
        [part(0..2), part(2..4)].map(|t| t.join().unwrap())
    });
    let [mut film, other] = parts;
    film.merge(&other).unwrap();
    assert!(film == whole);
}

#[test]
fn steps_do_not_wait_and_end_with_the_same_film() {
    let Some(backend) = adapter::backend() else { return };
    let session = backend.open_scene(compiled(&terrace())).unwrap();
    let job = job(0..8);
    let whole = image(&session, &job, &NoControl).unwrap();
    let mut task = session.path_image_task(&job).unwrap();
    let (mut longest, mut steps, mut last) = (Duration::ZERO, 0_u32, 0);
    loop {
        let start = Instant::now();
        let step = task.step(false).unwrap();
        longest = longest.max(start.elapsed());
        steps += 1;
        match step {
            // What a host does meanwhile.
            Step::Working => std::thread::sleep(Duration::from_micros(200)),
            Step::Progress { done, total } => {
                assert!(done >= last && done <= total);
                last = done;
            }
            Step::Done => break,
        }
    }
    println!("{steps} steps, the longest {longest:?}");
    let (film, stats) = task.finish();
    assert!(film == whole && stats.rays > 0);
    // A submission is meant to take 25 ms, and a step never waits for one; the rest is for a machine that does other things too.
    assert!(longest < Duration::from_millis(500), "{longest:?}");
}

/// A film of nothing has its blocks as on the CPU, by every method.
#[test]
fn no_probes_are_measured_too() {
    let Some(device) = adapter::backend() else { return };
    let scene = compiled(&terrace());
    let sessions = [device.open(scene.clone()).unwrap(), CpuBackend::new(None).unwrap().open(scene).unwrap()];
    let path = job(0..3);
    let films = sessions.each_ref().map(|session| {
        let settings = probe_film_settings(session.scene(), &path, 0);
        let mut films = [Film::new(settings), Film::new(settings)];
        session.path_probes(&path, &[], &NoControl, &mut films[0]).unwrap();
        let both = BidirectionalJob::new(path.clone());
        session.bidirectional_probes(&both, &[], &NoControl, &mut films[1]).unwrap();
        films
    });
    assert_eq!(films[0][0].block_count(), 3);
    assert!(films[0] == films[1]);
}
