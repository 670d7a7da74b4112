//! Embree 4, opened at run time where `ETENDUE_EMBREE` names its library; never linked, never needed.
//!
//! Only what one bench asks of its C API: a scene of triangles, single rays, single occlusion rays.
#![allow(unsafe_code, reason = "a C library opened by name")]

use etendue::core::geometry::{Primitives, Ray};
use libloading::{Library, Symbol};
use std::ffi::{c_char, c_int, c_uint, c_void};

type Handle = *mut c_void;

/// `RTCRay` followed by `RTCHit`, with room to spare: 48 bytes of ray, then Ng, u, v, primID, geomID, instID.
#[repr(C, align(16))]
struct RayHit {
    org: [f32; 3],
    tnear: f32,
    dir: [f32; 3],
    time: f32,
    tfar: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    ng: [f32; 3],
    u: f32,
    v: f32,
    prim: c_uint,
    geom: c_uint,
    room: [c_uint; 9],
}

const NOTHING: c_uint = c_uint::MAX;
const ROBUST: c_int = 1 << 2;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;

/// The opened library.
pub(crate) struct Embree {
    library: Library,
    device: Handle,
}

/// A committed scene.
pub(crate) struct Scene {
    scene: Handle,
    intersect: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
    occluded: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
}

// SAFETY: Embree's scenes may be asked by several threads once they are committed.
unsafe impl Sync for Scene {}

impl Embree {
    /// Opens the library that `ETENDUE_EMBREE` names; `None` where it is not set.
    pub(crate) fn open() -> Option<Self> {
        let path = std::env::var_os("ETENDUE_EMBREE")?;
        // SAFETY: the user names a library of Embree 4; its initialisers are that library's own.
        let library = unsafe { Library::new(&path) }
            .unwrap_or_else(|e| panic!("ETENDUE_EMBREE={}: {e}", path.to_string_lossy()));
        let mut this = Self { library, device: std::ptr::null_mut() };
        // SAFETY: rtcNewDevice(const char*), as Embree 4's rtcore_device.h declares it.
        this.device = unsafe {
            let new: Symbol<'_, unsafe extern "C" fn(*const c_char) -> Handle> =
                this.symbol(b"rtcNewDevice\0");
            new(c"".as_ptr())
        };
        assert!(!this.device.is_null(), "Embree gives no device");
        Some(this)
    }

    /// A function by name.
    ///
    /// # Safety
    /// `T` is the function's type.
    unsafe fn symbol<T>(&self, name: &[u8]) -> Symbol<'_, T> {
        // SAFETY: the caller's promise.
        unsafe { self.library.get(name) }.unwrap_or_else(|e| panic!("Embree lacks a function: {e}"))
    }

    /// Builds a scene of the triangles.
    pub(crate) fn scene(&self, primitives: &Primitives<'_>, robust: bool) -> Scene {
        type New = unsafe extern "C" fn(Handle) -> Handle;
        type Act = unsafe extern "C" fn(Handle);
        type Query = unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void);
        // SAFETY: the types are those of rtcore_scene.h, rtcore_geometry.h and rtcore_ray.h of Embree 4; the buffers that
        // rtcSetNewGeometryBuffer returns hold as many items of the stride as were asked for.
        unsafe {
            let scene = self.symbol::<New>(b"rtcNewScene\0")(self.device);
            let flags = self.symbol::<unsafe extern "C" fn(Handle, c_int)>(b"rtcSetSceneFlags\0");
            flags(scene, if robust { ROBUST } else { 0 });
            let geometry = self.symbol::<unsafe extern "C" fn(Handle, c_int) -> Handle>(b"rtcNewGeometry\0")(
                self.device,
                0,
            );
            type Buffer = unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
            let buffer = self.symbol::<Buffer>(b"rtcSetNewGeometryBuffer\0");
            let (p, t) = (primitives.positions, primitives.triangles);
            let indices = buffer(geometry, 0, 0, FORMAT_UINT3, 12, t.len()).cast::<[u32; 3]>();
            std::ptr::copy_nonoverlapping(t.as_ptr(), indices, t.len());
            let vertices = buffer(geometry, 1, 0, FORMAT_FLOAT3, 12, p.len()).cast::<[f32; 3]>();
            std::ptr::copy_nonoverlapping(p.as_ptr(), vertices, p.len());
            self.symbol::<Act>(b"rtcCommitGeometry\0")(geometry);
            self.symbol::<unsafe extern "C" fn(Handle, Handle) -> c_uint>(b"rtcAttachGeometry\0")(
                scene, geometry,
            );
            self.symbol::<Act>(b"rtcReleaseGeometry\0")(geometry);
            self.symbol::<Act>(b"rtcCommitScene\0")(scene);
            Scene {
                scene,
                intersect: *self.symbol::<Query>(b"rtcIntersect1\0"),
                occluded: *self.symbol::<Query>(b"rtcOccluded1\0"),
            }
        }
    }
}

fn ray_hit(ray: &Ray) -> RayHit {
    RayHit {
        org: ray.origin.to_array(),
        tnear: 0.0,
        dir: ray.direction.to_array(),
        time: 0.0,
        tfar: ray.t_max,
        mask: NOTHING,
        id: 0,
        flags: 0,
        ng: [0.0; 3],
        u: 0.0,
        v: 0.0,
        prim: NOTHING,
        geom: NOTHING,
        room: [NOTHING; 9],
    }
}

impl Scene {
    /// Distance of the closest hit.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray) -> Option<f32> {
        let mut r = ray_hit(ray);
        // SAFETY: a committed scene, a ray-hit of the layout that it expects, no arguments.
        unsafe { (self.intersect)(self.scene, &raw mut r, std::ptr::null_mut()) };
        (r.geom != NOTHING).then_some(r.tfar)
    }

    /// Whether anything is hit.
    #[inline]
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        let mut r = ray_hit(ray);
        // SAFETY: as above; an occluded ray comes back with tfar = -infinity.
        unsafe { (self.occluded)(self.scene, &raw mut r, std::ptr::null_mut()) };
        r.tfar < 0.0
    }
}
