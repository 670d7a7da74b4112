//! What of a wave of photons is sent to the device, stage by stage.

use super::wave::Order;
use super::{DIGITS, PASSES, PhotonTask, RUN, SCAN_RUN, Stage};
use crate::gpu::Pipeline;
use crate::session::task::WORKGROUP;

impl PhotonTask {
    /// The dispatches of a stage.
    pub(super) fn work(&self, pass: &mut wgpu::ComputePass<'_>) {
        let wave = &self.wave;
        let left = |all: u64, at: u64| all.saturating_sub(at).min(self.window);
        match self.stage {
            Stage::Start(at) => {
                let count = left(self.count(), at);
                self.run(pass, &wave.start, count);
                if self.kind.surfaces && !self.kind.sorted {
                    // Some have landed where they started.
                    self.turn(pass, &wave.landed);
                    self.run_indirect(pass, &wave.scatter, 16);
                }
                if at + count >= self.count() {
                    self.turn(pass, &wave.turn);
                }
            }
            Stage::Fly(at) if self.kind.sorted => {
                let count = left(self.asking, at);
                self.run(pass, &wave.trace, count);
                self.run(pass, &wave.arrive, count);
                if at + count >= self.asking {
                    self.turn(pass, &wave.turn);
                }
            }
            Stage::Fly(_) => {
                for _ in 0..self.pace.amount() {
                    self.run_indirect(pass, &wave.trace, 0);
                    self.run_indirect(pass, &wave.arrive, 0);
                    self.turn(pass, &wave.landed);
                    self.run_indirect(pass, &wave.scatter, 16);
                    self.turn(pass, &wave.turn);
                }
            }
            Stage::Order => self.order(pass),
            Stage::Scatter(at) => {
                let count = left(self.alive, at);
                self.run(pass, &wave.scatter, count);
                if at + count >= self.alive {
                    self.survive(pass);
                    self.turn(pass, &wave.turn);
                }
            }
            Stage::Sums => {}
        }
    }

    fn bind(&self, pass: &mut wgpu::ComputePass<'_>, pipeline: &Pipeline) {
        pass.set_pipeline(&pipeline.raw);
        pass.set_bind_group(0, &self.group, &[]);
    }

    /// As many invocations as there are items.
    fn run(&self, pass: &mut wgpu::ComputePass<'_>, pipeline: &Pipeline, items: u64) {
        self.bind(pass, pipeline);
        pass.dispatch_workgroups(items.div_ceil(u64::from(WORKGROUP)) as u32, 1, 1);
    }

    fn run_indirect(&self, pass: &mut wgpu::ComputePass<'_>, pipeline: &Pipeline, at: u64) {
        self.bind(pass, pipeline);
        pass.dispatch_workgroups_indirect(&self.groups.raw, at);
    }

    fn turn(&self, pass: &mut wgpu::ComputePass<'_>, pipeline: &Pipeline) {
        pass.set_pipeline(&pipeline.raw);
        pass.set_bind_group(0, &self.turn_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Sums of so many counts.
    fn scan(&self, pass: &mut wgpu::ComputePass<'_>, order: &Order, counts: u64) {
        let [runs, all, back] = &order.scan;
        self.run(pass, runs, counts.div_ceil(SCAN_RUN));
        self.run(pass, all, 1);
        self.run(pass, back, counts.div_ceil(SCAN_RUN));
    }

    /// Those of the living who have landed come into order.
    fn order(&self, pass: &mut wgpu::ComputePass<'_>) {
        let Some(order) = &self.wave.order else { return };
        let runs = self.alive.div_ceil(RUN);
        self.run(pass, &order.landed[0], runs);
        self.scan(pass, order, runs);
        self.run(pass, &order.landed[1], runs);
        self.run(pass, &order.turn, 1);
        for _ in 0..PASSES {
            self.run(pass, &order.digits[0], runs);
            self.scan(pass, order, DIGITS * runs);
            self.run(pass, &order.digits[1], runs);
            self.run(pass, &order.turn, 1);
        }
    }

    /// Roulette of those in order.
    fn survive(&self, pass: &mut wgpu::ComputePass<'_>) {
        let Some(order) = &self.wave.order else { return };
        let runs = self.alive.div_ceil(RUN);
        self.run(pass, &order.chances[0], runs);
        self.scan(pass, order, runs);
        self.run(pass, &order.chances[1], runs);
    }
}
