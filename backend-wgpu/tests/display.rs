//! Tone mapping on a device against core: where the device's arithmetic is exact, bytes and floats are equal, elsewhere nearly so.

mod adapter;

use etendue_core::backend::{Arithmetic, Backend};
use etendue_core::tone::{ToneMap, ToneSettings, display, display_srgb8};
use etendue_wgpu::{Options, WgpuBackend, wgpu};

const MAPS: [ToneMap; 3] = [ToneMap::Reinhard, ToneMap::Gamma, ToneMap::None];

fn settings() -> Vec<ToneSettings> {
    let plain = MAPS.map(|map| ToneSettings { map, ..ToneSettings::default() });
    let bright = plain.map(|s| ToneSettings { exposure: 2.3, ..s });
    let mut all = [plain, bright].concat();
    all.push(ToneSettings { map: ToneMap::Gamma, exposure: -1.0, gamma_a: 0.9, gamma_c: 0.02, gamma: 0.4 });
    all.push(ToneSettings { exposure: f32::NAN, ..ToneSettings::default() });
    all
}

/// From dark to bright, and what is no light at all.
fn pixels(count: usize) -> Vec<[f32; 3]> {
    let hard = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, -0.0, 0.0, f32::MAX, f32::MIN_POSITIVE];
    let light = |i: usize| match i {
        0..8 => hard[i],
        _ => f32::from_bits(0x3000_0000 + (i as u32).wrapping_mul(7919) % 0x1400_0000),
    };
    (0..count).map(|i| [light(i), light(2 * i + 1), light((3 * i) ^ 5)]).collect()
}

#[test]
fn pixels_have_the_bits_of_core() {
    let Some(backend) = adapter::backend() else { return };
    let is_exact = backend.arithmetic() == Arithmetic::Ieee;
    let pixels = pixels(20_011);
    for settings in settings() {
        let bytes = backend.tone_map(&settings, &pixels).unwrap();
        let floats = backend.tone_map_floats(&settings, &pixels).unwrap();
        assert_eq!([bytes.len(), floats.len()], [pixels.len(); 2]);
        for (i, pixel) in pixels.iter().enumerate() {
            let (byte, float) = (display_srgb8(settings, *pixel), display(settings, *pixel));
            if is_exact {
                let bits = [floats[i], float].map(|v| v.map(f32::to_bits));
                assert_eq!((bytes[i], bits[0]), (byte, bits[1]), "{settings:?} {pixel:?}");
                continue;
            }
            for c in 0..3 {
                let near = bytes[i][c].abs_diff(byte[c]) <= 1 && (floats[i][c] - float[c]).abs() <= 1e-6;
                assert!(near, "{settings:?} {pixel:?}: {:?} {:?}", bytes[i], floats[i]);
            }
        }
    }
    assert!(backend.tone_map(&ToneSettings::default(), &[]).unwrap().is_empty());
}

#[test]
fn images_larger_than_a_binding_come_in_parts() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 4096, ..wgpu::Limits::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    let Some(backend) = adapter::backend_with(options) else { return };
    let (settings, pixels) = (ToneSettings::default(), pixels(2000));
    let expected: Vec<_> = pixels.iter().map(|p| display_srgb8(settings, *p)).collect();
    let found = backend.tone_map(&settings, &pixels).unwrap();
    let near = found.as_flattened().iter().zip(expected.as_flattened()).all(|(a, b)| a.abs_diff(*b) <= 1);
    assert!(found.len() == expected.len() && near);
}

/// A device of the test's own, as a host has one.
fn host() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let Ok(adapter) = adapter else {
        adapter::skip("no adapter");
        return None;
    };
    // As this crate's own device does where it can: shaders then keep their arithmetic.
    let features = adapter.features() & wgpu::Features::PASSTHROUGH_SHADERS;
    let descriptor = wgpu::DeviceDescriptor { required_features: features, ..Default::default() };
    Some(pollster::block_on(adapter.request_device(&descriptor)).unwrap())
}

/// The texels of a picture, row by row.
fn texels(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Vec<[u8; 4]> {
    let size = texture.size();
    let row = (4 * size.width).next_multiple_of(256);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * size.height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, size);
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |r| r.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let view = buffer.get_mapped_range(..).unwrap();
    let rows = view.chunks(row as usize);
    rows.flat_map(|r| r[..4 * size.width as usize].chunks(4).map(|t| [t[0], t[1], t[2], t[3]])).collect()
}

#[test]
fn pictures_are_there_for_a_host_to_present() {
    let Some((device, queue)) = host() else { return };
    let backend = WgpuBackend::from_device(device.clone(), queue.clone());
    let is_exact = backend.arithmetic() == Arithmetic::Ieee;
    let size = [37, 19];
    let picture = backend.picture(size).unwrap();
    assert_eq!(picture.size(), size);
    assert!(texels(&device, &queue, picture.texture()).iter().all(|t| t[..3] == [0; 3]));
    let pixels = pixels(37 * 19);
    for settings in settings() {
        let expected: Vec<_> = pixels
            .iter()
            .map(|p| {
                let [r, g, b] = display_srgb8(settings, *p);
                [r, g, b, 255]
            })
            .collect();
        picture.show(&settings, &pixels).unwrap();
        let shown = texels(&device, &queue, picture.texture());
        if is_exact {
            assert_eq!(shown, expected, "{settings:?}");
        }

        let light = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 12 * pixels.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let words: Vec<u8> = pixels.as_flattened().iter().flat_map(|x| x.to_ne_bytes()).collect();
        queue.write_buffer(&light, 0, &words);
        picture.show(&settings, &[[0.0; 3]; 37 * 19]).unwrap();
        picture.show_buffer(&settings, &light).unwrap();
        assert_eq!(texels(&device, &queue, picture.texture()), shown, "{settings:?}");
    }
    if !is_exact {
        return;
    }
    // A view for targets that encode themselves.
    let _ = picture.texture().create_view(&wgpu::TextureViewDescriptor {
        format: Some(wgpu::TextureFormat::Rgba8UnormSrgb),
        ..Default::default()
    });
}

#[test]
fn what_the_device_refuses_is_an_error() {
    let Some((device, queue)) = host() else { return };
    let backend = WgpuBackend::from_device(device.clone(), queue);
    assert!(backend.picture([1 << 20, 4]).is_err());
    let picture = backend.picture([4, 4]).unwrap();
    let wrong = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 192,
        usage: wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    assert!(picture.show_buffer(&ToneSettings::default(), &wrong).is_err());
    picture.show(&ToneSettings::default(), &[[1.0; 3]; 99]).unwrap();
    backend.picture([0, 0]).unwrap().show(&ToneSettings::default(), &[]).unwrap();
}
