//! How the devices of this machine decode textures of BC1.

mod adapter;

use etendue_core::codec::bc1::Rule;
use etendue_wgpu::{Bc1Texture, WgpuBackend, adapters};

#[test]
fn each_adapter_has_a_known_answer() {
    if adapter::backend().is_none() {
        return;
    }
    for adapter in adapters() {
        let Ok(backend) = WgpuBackend::request_named(&adapter.to_string()) else { continue };
        let found = backend.bc1_texture().unwrap();
        println!("{adapter}: {found:?}");
        let name = adapter.to_string().to_lowercase();
        if name.contains("swiftshader") {
            // It reports the feature, and gives zeros.
            assert_eq!(found, Bc1Texture::Wrong);
        } else if name.contains("llvmpipe") && adapter.api == "vulkan" {
            assert_eq!(found, Bc1Texture::Rule(Rule::Mesa));
        }
        assert_eq!(backend.bc1_texture().unwrap(), found);
    }
}

#[test]
fn a_device_without_the_feature_has_none() {
    let instance = etendue_wgpu::wgpu::Instance::new(
        etendue_wgpu::wgpu::InstanceDescriptor::new_without_display_handle(),
    );
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&Default::default())) else {
        return adapter::skip("no adapter");
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default())).unwrap();
    let backend = WgpuBackend::from_device(device, queue);
    assert_eq!(backend.bc1_texture().unwrap(), Bc1Texture::Missing);
}
