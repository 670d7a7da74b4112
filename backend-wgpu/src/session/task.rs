//! What jobs on the device have in common: steps that never wait, submissions of a length that a desktop bears, and the bindings of a scene.

use super::scene::SceneBuffers;
use crate::gpu::{Binding, Buffer, Gpu};
use etendue_core::backend::{BackendError, Control};
use std::ops::ControlFlow;
use std::time::Duration;

/// Invocations of a workgroup, as the shaders have it.
pub(super) const WORKGROUP: u32 = 64;
/// How long one submission should keep the device: a desktop goes on meanwhile.
const SUBMISSION: Duration = Duration::from_millis(25);

/// How far a task is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The device is at work; come back.
    Working,
    /// Something was added: `done` of `total` units of the job.
    Progress {
        /// Finished.
        done: u64,
        /// In all.
        total: u64,
    },
    /// All is in the film.
    Done,
}

/// A job in steps.
pub(super) trait Task: Sized {
    /// What it makes: of most the film, and what the job took.
    type Made;

    /// Goes on as far as it can without waiting; with `wait`, until something has come back.
    fn step(&mut self, wait: bool) -> Result<Step, BackendError>;

    /// What it has made.
    fn finish(self) -> Self::Made;

    /// Takes all steps, unless the control cancels.
    fn drive(self, control: &dyn Control) -> Result<Self::Made, BackendError> {
        Ok(self.drive_all(control)?.finish())
    }

    /// The same, and the task as it is then.
    fn drive_all(mut self, control: &dyn Control) -> Result<Self, BackendError> {
        loop {
            match self.step(true)? {
                Step::Working => {}
                Step::Progress { done, total } => {
                    if control.advance(done, total).is_break() {
                        return Err(BackendError::Cancelled);
                    }
                }
                Step::Done => return Ok(self),
            }
        }
    }
}

/// Passes on the progress of one part of a job as that of all of it.
pub(super) struct Portion<'a> {
    pub(super) control: &'a dyn Control,
    /// Of the job, before this part; what one unit of the part counts for; and all of it.
    pub(super) before: u64,
    pub(super) factor: u64,
    pub(super) all: u64,
}

impl Control for Portion<'_> {
    fn advance(&self, done: u64, _: u64) -> ControlFlow<()> {
        self.control.advance(self.before + done * self.factor, self.all)
    }
}

/// How much work goes into one submission: more where the last was short, less where it was long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    amount: u64,
    least: u64,
    most: u64,
}

impl Pace {
    /// Begins with `first`, and never takes more than `most`, nor less than a part of `first`: where others keep the machine, no amount is quick, and small ones would take for ever.
    pub(super) fn new(first: u64, most: u64) -> Self {
        let amount = first.clamp(1, most.max(1));
        Self { amount, least: (amount / 8).max(1), most: most.max(1) }
    }

    pub(super) fn amount(self) -> u64 {
        self.amount
    }

    /// Learns how long a submission of so much took.
    pub(super) fn took(&mut self, amount: u64, time: Duration) {
        if time < SUBMISSION / 2 && amount >= self.amount {
            self.amount = (self.amount * 2).min(self.most);
        } else if time > SUBMISSION * 2 {
            self.amount = (self.amount.min(amount) / 2).max(self.least);
        }
    }
}

/// Bindings of a job's pipeline: the scene with the job's numbers, and two of its own buffers, at 7 and 8.
pub(super) const fn bindings(own: [Binding; 2]) -> [Binding; 10] {
    let [u, r] = [Binding::Uniform, Binding::Read];
    [u, u, r, r, r, r, r, own[0], own[1], r]
}

impl SceneBuffers {
    /// The buffers for [`bindings`].
    pub(super) fn bound<'a>(&'a self, job: &'a Buffer, own: [&'a Buffer; 2]) -> [&'a Buffer; 10] {
        let ([near, far], [blocks, more]) = (&self.texels, &self.blocks);
        [&self.offsets, job, &self.nodes, blocks, more, &self.arena, near, own[0], own[1], far]
    }
}

/// Whether the processor plays the device.
pub(super) fn is_played(gpu: &Gpu) -> bool {
    gpu.device.adapter_info().device_type == wgpu::DeviceType::Cpu
}
