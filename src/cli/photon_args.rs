//! Options of photons, for every verb that traces them.

use super::args::positive;
use crate::driver::{Budget, PhotonSettings, choose_start};
use clap::{Args, ValueEnum};
use etendue_core::backend::{BackendError, PhotonStart, Session};
use etendue_core::illumination::{Basis, ElementSettings, Sides};
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use serde_json::{Map, Value, json};

/// Where photons start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum From {
    /// Where it is forecast to cost least
    Auto,
    /// On the lights, by flux
    Lights,
    /// On the surfaces that lights without size light, by what these send on
    Surfaces,
}

/// How photons that start on surfaces are weighted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum WeightsName {
    /// Without bias
    Exact,
    /// As published: alike within a piece; biased at edges of shadows
    Density,
}

/// How lit triangles are cut into pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Subdivide {
    /// With bounded angles, by seven samples, where it matters
    Robust,
    /// As published
    Published,
    /// Not at all
    None,
}

/// What irradiance is between the numbers of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BasisName {
    /// Constant on each face
    Constant,
    /// Linear between vertices
    Linear,
}

/// Where the numbers of photons come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SequenceName {
    /// Sobol' points handed out in order along a space-filling curve, anew at each bounce
    Sorted,
    /// One Sobol' point per photon
    Sobol,
    /// Independent random numbers
    Random,
}

/// How photons are traced and summed.
#[derive(Debug, Args)]
pub(super) struct PhotonArgs {
    /// Where photons start [default: auto]
    #[arg(long, value_enum)]
    from: Option<From>,
    /// How photons from surfaces are weighted; with `density` they start there unless told otherwise [default: exact]
    #[arg(long, value_enum)]
    weights: Option<WeightsName>,
    /// How lit triangles are cut into pieces, for photons from surfaces [default: robust]
    #[arg(long, value_enum)]
    subdivide: Option<Subdivide>,
    /// Irradiance of the map between its numbers [default: constant]
    #[arg(long, value_enum)]
    basis: Option<BasisName>,
    /// Where the numbers of photons come from [default: sorted]
    #[arg(long, value_enum)]
    sequence: Option<SequenceName>,
    /// Longest edge of the map's faces: larger triangles are divided [default: the scene's own triangles; for render and probe one that suits the scene]
    #[arg(long, value_name = "METRES", value_parser = positive, allow_negative_numbers = true)]
    element_size: Option<f64>,
}

impl PhotonArgs {
    fn weights(&self) -> WeightsName {
        self.weights.unwrap_or(WeightsName::Exact)
    }

    fn subdivide(&self) -> Subdivide {
        self.subdivide.unwrap_or(Subdivide::Robust)
    }

    fn basis(&self) -> BasisName {
        self.basis.unwrap_or(BasisName::Constant)
    }

    fn sequence(&self) -> SequenceName {
        self.sequence.unwrap_or(SequenceName::Sorted)
    }

    /// The first option that was given, if any was.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--from", self.from.is_some()),
            ("--weights", self.weights.is_some()),
            ("--subdivide", self.subdivide.is_some()),
            ("--basis", self.basis.is_some()),
            ("--sequence", self.sequence.is_some()),
            ("--element-size", self.element_size.is_some()),
        ];
        given.into_iter().find(|g| g.1).map(|g| g.0)
    }

    /// The settings for a session and a budget.
    pub(super) fn settings(
        &self,
        session: &dyn Session,
        budget: Budget,
        sides: Sides,
    ) -> Result<PhotonSettings, BackendError> {
        let weights = match self.weights() {
            WeightsName::Exact => Weights::EXACT,
            WeightsName::Density => Weights::Density,
        };
        let subdivision = match self.subdivide() {
            Subdivide::None => Subdivision::None,
            Subdivide::Published => Subdivision::published(),
            Subdivide::Robust => Subdivision::robust(weights),
        };
        let start = match self.from.unwrap_or(From::Auto) {
            From::Auto if self.weights() == WeightsName::Exact => choose_start(session, budget)?,
            From::Lights => PhotonStart::LIGHTS,
            From::Auto | From::Surfaces => PhotonStart::Surfaces { subdivision, weights },
        };
        let sequence = match self.sequence() {
            SequenceName::Sorted => Sequence::Sorted,
            SequenceName::Sobol => Sequence::Sobol,
            SequenceName::Random => Sequence::Random,
        };
        let basis = match self.basis() {
            BasisName::Constant => Basis::Constant,
            BasisName::Linear => Basis::Linear,
        };
        let largest = self.element_size.map_or(f32::INFINITY, |x| x as f32);
        Ok(PhotonSettings { start, sequence, elements: ElementSettings { basis, sides, largest } })
    }

    /// Adds the choices, as the user says them, but for where photons start and the size of elements.
    pub(super) fn describe(&self, start: &PhotonStart, map: &mut Map<String, Value>) {
        let mut add = |name: &str, value: Option<clap::builder::PossibleValue>| {
            map.insert(name.into(), json!(value.map(|v| v.get_name().to_owned())));
        };
        if matches!(start, PhotonStart::Surfaces { .. }) {
            add("weights", self.weights().to_possible_value());
            add("subdivide", self.subdivide().to_possible_value());
        }
        add("basis", self.basis().to_possible_value());
        add("sequence", self.sequence().to_possible_value());
        map.insert("from".into(), json!(name_of(start)));
    }
}

/// Where photons start, as users say it.
pub(super) fn name_of(start: &PhotonStart) -> &'static str {
    match start {
        PhotonStart::Lights { .. } => "lights",
        PhotonStart::Surfaces { .. } => "surfaces",
    }
}
