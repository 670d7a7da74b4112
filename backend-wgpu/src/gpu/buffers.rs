//! Buffers of 32-bit words, and answers on their way back.

use super::Gpu;
use etendue_core::backend::BackendError;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Words on the device.
#[derive(Debug)]
pub(crate) struct Buffer {
    pub(crate) raw: wgpu::Buffer,
}

/// The bytes that a binding has at least: an empty one is none.
const LEAST: u64 = 16;

impl Gpu {
    /// Room for so many words, zero.
    pub(crate) fn room(&self, label: &'static str, words: u64) -> Result<Buffer, BackendError> {
        let bytes = (4 * words).max(LEAST);
        if bytes > self.binding_bytes() {
            return Err(BackendError::LimitExceeded {
                what: "bytes in one buffer of the device",
                asked: bytes,
                allowed: self.binding_bytes(),
            });
        }
        let raw = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::INDIRECT,
            mapped_at_creation: false,
        });
        Ok(Buffer { raw })
    }

    /// Words that the device reads.
    pub(crate) fn upload(&self, label: &'static str, words: &[u32]) -> Result<Buffer, BackendError> {
        let buffer = self.room(label, words.len() as u64)?;
        if !words.is_empty() {
            self.queue.write_buffer(&buffer.raw, 0, bytemuck::cast_slice(words));
        }
        Ok(buffer)
    }

    /// A few words that every invocation reads.
    pub(crate) fn uniform(&self, label: &'static str, words: &[u32]) -> Buffer {
        let bytes = (4 * words.len() as u64).next_multiple_of(16).max(LEAST);
        let raw = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&raw, 0, bytemuck::cast_slice(words));
        Buffer { raw }
    }

    /// Sends what `encoder` holds and asks for the first words of a buffer after it.
    pub(crate) fn submit_and_read(
        &self,
        encoder: wgpu::CommandEncoder,
        from: &Buffer,
        words: u64,
    ) -> Pending {
        self.submit_and_read_from(encoder, (from, 0), words)
    }

    /// The same for words from a place in the buffer on.
    pub(crate) fn submit_and_read_from(
        &self,
        encoder: wgpu::CommandEncoder,
        (from, first): (&Buffer, u64),
        words: u64,
    ) -> Pending {
        self.submit_and_read_all(encoder, &[(from, first, words)])
    }

    /// The same for several runs of words, one after the other: of which buffer, from which word on, how many.
    pub(crate) fn submit_and_read_all(
        &self,
        mut encoder: wgpu::CommandEncoder,
        runs: &[(&Buffer, u64, u64)],
    ) -> Pending {
        let words: u64 = runs.iter().map(|r| r.2).sum();
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("answer"),
            size: (4 * words).max(LEAST),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut at = 0;
        for (from, first, words) in runs {
            encoder.copy_buffer_to_buffer(&from.raw, 4 * first, &staging, at, 4 * words);
            at += 4 * words;
        }
        self.submit(encoder);
        let (send, answered) = channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody listens where the job was dropped.
            let _ = send.send(result.map_err(|e| e.to_string()));
        });
        Pending { staging, answered, words: words as usize }
    }
}

/// An answer on its way.
#[derive(Debug)]
pub(crate) struct Pending {
    staging: wgpu::Buffer,
    answered: Receiver<Result<(), String>>,
    words: usize,
}

impl Pending {
    /// The words; without `wait`, `None` where the device is still at work.
    pub(crate) fn answer(&self, gpu: &Gpu, wait: bool) -> Result<Option<Vec<u32>>, BackendError> {
        if wait { self.wait(gpu).map(Some) } else { self.poll(gpu).transpose() }
    }

    /// Whether the words are there: `None` where the device is still at work.
    fn poll(&self, gpu: &Gpu) -> Option<Result<Vec<u32>, BackendError>> {
        if let Err(e) = gpu.poll(false) {
            return Some(Err(e));
        }
        match self.answered.try_recv() {
            Ok(answer) => Some(self.take(gpu, answer)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(gpu.lost("an answer never came"))),
        }
    }

    /// Waits for the words.
    pub(crate) fn wait(&self, gpu: &Gpu) -> Result<Vec<u32>, BackendError> {
        gpu.poll(true)?;
        match self.answered.recv() {
            Ok(answer) => self.take(gpu, answer),
            Err(_) => Err(gpu.lost("an answer never came")),
        }
    }

    fn take(&self, gpu: &Gpu, answer: Result<(), String>) -> Result<Vec<u32>, BackendError> {
        answer.map_err(|e| gpu.lost(e))?;
        let view = self.staging.get_mapped_range(..).map_err(|e| gpu.lost(e.to_string()))?;
        let words: &[u8] = view.get(..4 * self.words).ok_or_else(|| gpu.lost("an answer is too short"))?;
        Ok(bytemuck::pod_collect_to_vec(words))
    }
}
