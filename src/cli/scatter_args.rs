//! Options of single scattering that is summed along the camera's rays.

use super::args::{Method, SamplingArgs};
use super::error::CliError;
use clap::{Args, ValueEnum};
use etendue_core::transport::volume::{NODES_MAX, Rule, SingleScatter};
use serde_json::{Map, Value, json};

/// How light that is scattered once comes to the camera.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of --method path")]
pub(super) struct ScatterArgs {
    /// Sum the light of point, spot and directional lights that is scattered once in a medium along the camera's rays, instead of drawing where it is scattered
    #[arg(long, value_enum)]
    single_scatter: Option<RuleChoice>,
    /// Nodes of --single-scatter for each light and each stretch of a ray within one medium [default: 16]
    #[arg(long, value_name = "N", requires = "single_scatter", value_parser = clap::value_parser!(u32).range(1..=i64::from(NODES_MAX)))]
    scatter_nodes: Option<u32>,
}

/// Where nodes lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum RuleChoice {
    /// At equal steps, the first one random: unbiased
    Trapezoid,
    /// At equal steps from end to end: no noise, a bias that falls by the square of the nodes
    Plain,
    /// At equal angles as seen from the light, the first one random: unbiased
    Equiangular,
}

impl ScatterArgs {
    /// What was asked for.
    pub(super) fn single(&self) -> Option<SingleScatter> {
        let rule = match self.single_scatter? {
            RuleChoice::Trapezoid => Rule::Trapezoid,
            RuleChoice::Plain => Rule::PlainTrapezoid,
            RuleChoice::Equiangular => Rule::Equiangular,
        };
        Some(SingleScatter { rule, nodes: self.scatter_nodes.unwrap_or(SingleScatter::NODES) })
    }

    /// Refuses it where another estimator was asked for.
    pub(super) fn check(&self, sampling: &SamplingArgs) -> Result<(), CliError> {
        if self.single_scatter.is_some() && sampling.method.is_some_and(|m| m != Method::Path) {
            return Err(CliError::Usage("--single-scatter needs --method path".into()));
        }
        Ok(())
    }

    /// Adds what decides the bits.
    pub(super) fn describe(&self, map: &mut Map<String, Value>) {
        let Some(single) = self.single() else { return };
        let name = match single.rule {
            Rule::Trapezoid => "trapezoid",
            Rule::PlainTrapezoid => "plain",
            Rule::Equiangular => "equiangular",
        };
        map.insert("single_scatter".into(), json!(name));
        map.insert("scatter_nodes".into(), json!(single.nodes));
    }
}
