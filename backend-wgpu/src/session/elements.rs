//! The elements of an illumination map on a device.

use crate::gpu::{Buffer, Gpu};
use etendue_core::backend::BackendError;
use etendue_core::illumination::{ElementSettings, Elements};
use etendue_core::light::emit;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::volume::LightMedia;
use std::sync::{Arc, Mutex, PoisonError};

/// Elements, what an arrival counts for as shaders read it (`illumination/elements.wgsl`), which lights have no size, and what these send into.
#[derive(Debug)]
pub(super) struct ElementBuffers {
    pub(super) elements: Arc<Elements>,
    pub(super) words: Buffer,
    pub(super) word_count: u64,
    pub(super) primitives: u64,
    /// Equal parts of all primitives together.
    pub(super) divisions: u64,
    /// Where nodes begin among the words.
    pub(super) nodes: u32,
    /// Where the numbers of the lights without size begin, and how many there are.
    pub(super) lights: [u32; 2],
}

impl ElementBuffers {
    pub(super) fn new(
        gpu: &Gpu,
        (scene, media): (&CompiledScene, &LightMedia),
        elements: Arc<Elements>,
    ) -> Result<Self, BackendError> {
        let (places, nodes) = elements.parts();
        let (mut words, divisions) = place_words(scene, &elements);
        let first_node = words.len() as u32;
        words.extend(nodes);
        let first_light = words.len() as u32;
        let lights = scene.lights.iter().zip(0..).filter(|(light, _)| emit::is_point_like(light));
        let numbers: Vec<u32> = lights.map(|(_, number)| number).collect();
        words.extend(&numbers);
        let lights = [first_light, numbers.len() as u32];
        words.extend(media.outside().packed());
        for number in numbers {
            // A light without size sends into the same all over it.
            let of = media.all_over(number as usize);
            words.extend(of.unwrap_or(media.outside()).packed());
        }
        let word_count = words.len() as u64;
        let words = gpu.scoped(|| gpu.upload("elements", &words))?;
        let primitives = places.len() as u64;
        Ok(Self { elements, words, word_count, primitives, divisions, nodes: first_node, lights })
    }
}

/// Four words of each primitive, and the divisions of all.
pub(super) fn place_words(scene: &CompiledScene, elements: &Elements) -> (Vec<u32>, u64) {
    let places = elements.parts().0;
    let mut words = Vec::with_capacity(4 * places.len());
    let mut divisions = 0_u64;
    for (place, primitive) in places.iter().zip(0..) {
        let area = scene.primitive_area(primitive).to_bits();
        // There are no more than 2^31 divisions.
        words.extend([place.first, place.divisions, divisions as u32, area]);
        divisions += u64::from(elements.cells(primitive));
    }
    (words, divisions)
}

/// The elements that were asked for last, and on which device they are: the next job has them too, most likely.
#[derive(Debug, Default)]
pub(super) struct KeptElements {
    made: Mutex<Option<(ElementSettings, Arc<Elements>)>>,
    sent: Mutex<Option<(Arc<Gpu>, Arc<ElementBuffers>)>>,
}

impl KeptElements {
    /// A scene's elements.
    pub(super) fn of(&self, scene: &CompiledScene, settings: &ElementSettings) -> Arc<Elements> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, elements)) = &*made
            && of == settings
        {
            return elements.clone();
        }
        let elements = Arc::new(Elements::new(scene, *settings));
        *made = Some((*settings, elements.clone()));
        elements
    }

    /// The same on a device.
    pub(super) fn on(
        &self,
        gpu: &Arc<Gpu>,
        (scene, media): (&CompiledScene, &LightMedia),
        elements: &Arc<Elements>,
    ) -> Result<Arc<ElementBuffers>, BackendError> {
        let mut sent = self.sent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, buffers)) = &*sent
            && Arc::ptr_eq(of, gpu)
            && Arc::ptr_eq(&buffers.elements, elements)
        {
            return Ok(buffers.clone());
        }
        let buffers = Arc::new(ElementBuffers::new(gpu, (scene, media), elements.clone())?);
        *sent = Some((gpu.clone(), buffers.clone()));
        Ok(buffers)
    }
}
