//! From form factors to what is stored of them.

use super::{BakeError, Codec, CodecError, Order, Transport, Truth};
use etendue_core::backend::Session;
use etendue_core::radiosity::blocks::{self, Matrix};
use etendue_core::radiosity::form_factors::FormFactors;
use etendue_core::radiosity::relight::{RelightError, Relighter, Symmetric};
use etendue_core::radiosity::tiles::{Kind, Rates, SIDE, tile_rows};

/// What a bit may cost in the clusters' inverses, over what it may cost in form factors: what they err by is mended by the passes.
const COARSE: f64 = 32.0;
/// What a bit may cost in form factors of patches that emit, over what it may cost in others: a lamp is small and far brighter than what it lights, and its form factors weigh little among all.
const EMITTERS: f64 = 1.0 / 1024.0;
/// Steps of the search for the cheapest tiles, and how near to the limit it may end.
const SEARCH_STEPS: u32 = 9;
const NEAR: f64 = 0.97;
/// Passes that a bake begins its search with, and the most of a scene whose light decays slowly.
pub const PASSES: u32 = 3;
const PASSES_MOST: u32 = 12;
/// Share of the allowed error, in the root mean square, that is left to passes.
const PASSES_SHARE: f64 = 0.8;
/// What passes may leave where form factors are stored as they are.
const FULL_ERROR: f64 = 0.005;
/// Most plain bounces.
const BOUNCES_MOST: u32 = 200;

/// Form factors as a codec stores them.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// What relights.
    pub transport: Transport,
    /// In so many passes.
    pub passes: u32,
    /// What that costs.
    pub error: CodecError,
}

/// Stores form factors as the codec says, and measures what that costs; `voxels` is the order of the patches before they were put in order.
///
/// # Errors
/// Of form factors that make no operator.
pub fn encode(
    session: &dyn Session,
    (form_factors, voxels): (&FormFactors, &[u32]),
    truth: &Truth,
    codec: Codec,
    passes: Option<u32>,
) -> Result<Encoded, BakeError> {
    let uniform = |kind: Kind| {
        let tiles = TileEncoder::new(session, form_factors, truth, passes, FULL_ERROR)?;
        tiles.uniform(kind)
    };
    let in_blocks = |settings: blocks::Settings<'_>| encode_blocks(session, form_factors, truth, &settings);
    match codec {
        Codec::Auto { max_error } => {
            let tiles = TileEncoder::new(session, form_factors, truth, passes, max_error * PASSES_SHARE)?;
            tiles.cheapest(max_error)
        }
        Codec::Tiles => uniform(Kind::Bits8),
        Codec::F16 => uniform(Kind::F16),
        Codec::F32 => uniform(Kind::F32),
        Codec::Published { bounces, keep, order } => in_blocks(blocks::Settings {
            matrix: bounces.map_or(Matrix::AllBounces, Matrix::Bounces),
            keep,
            order: match order {
                Order::Voxels => blocks::Order::Given(voxels),
                Order::Kd => blocks::Order::Patches,
                Order::Greedy1 => blocks::Order::Greedy { passes: 1 },
                Order::Greedy2 => blocks::Order::Greedy { passes: 2 },
            },
            ..blocks::Settings::published(PASSES)
        }),
        Codec::Bc1 { keep } => in_blocks(blocks::Settings { keep, ..blocks::Settings::mended() }),
        Codec::Bc4 { keep } => {
            let bounces = bounces_needed(session, truth)?;
            in_blocks(blocks::Settings { keep, ..blocks::Settings::bounced(bounces) })
        }
    }
}

/// Form factors on their way into tiles.
struct TileEncoder<'a> {
    session: &'a dyn Session,
    form_factors: &'a FormFactors,
    symmetric: Symmetric<'a>,
    truth: &'a Truth,
    albedo: Vec<[f32; 3]>,
    passes: u32,
    weights: Vec<f32>,
}

impl<'a> TileEncoder<'a> {
    /// With as many passes as are asked for, or as few as leave no more than `limit`.
    fn new(
        session: &'a dyn Session,
        form_factors: &'a FormFactors,
        truth: &'a Truth,
        passes: Option<u32>,
        limit: f64,
    ) -> Result<Self, BakeError> {
        let mut count = truth.bounces.or(passes).unwrap_or(PASSES);
        // So many bounces are as many plain passes, none weighted.
        let mut weights = Vec::new();
        while truth.bounces.is_none() {
            weights = truth.weights(session, count)?;
            let made = Transport::Tiles(Box::new(truth.relighter.clone().with_weights(weights.clone())?));
            let good = truth.measure(session, &made, count)?.rms <= limit;
            if good || passes.is_some() || count >= PASSES_MOST {
                break;
            }
            count += 1;
        }
        let (symmetric, albedo) = (Symmetric::new(form_factors), truth.relighter.albedo_list());
        Ok(Self { session, form_factors, symmetric, truth, albedo, passes: count, weights })
    }

    /// Tiles of the kinds wanted, clusters at these rates.
    fn make(
        &self,
        want: &(dyn Fn(usize, usize) -> Kind + Sync),
        coarse: Rates,
    ) -> Result<Encoded, BakeError> {
        let tiles = self.session.tiles(&self.symmetric, want).map_err(RelightError::Tiles)?;
        let relighter = Relighter::of(self.form_factors, &self.albedo, tiles)?
            .with_coarse_of(&self.truth.relighter, coarse)?
            .with_weights(self.weights.clone())?;
        let transport = Transport::Tiles(Box::new(relighter));
        let error = self.truth.measure(self.session, &transport, self.passes)?;
        Ok(Encoded { transport, passes: self.passes, error })
    }

    fn uniform(&self, kind: Kind) -> Result<Encoded, BakeError> {
        self.make(&|_, _| kind, Rates::Uniform(kind))
    }

    /// The fewest bytes whose error stays below a limit; f32 where nothing in few bits does.
    fn cheapest(&self, max_error: f64) -> Result<Encoded, BakeError> {
        let curves = self.session.rate_curves(&self.symmetric);
        let mut emits = vec![false; tile_rows(self.symmetric.len())];
        if let Some([emission, _]) = &self.truth.own {
            for (i, e) in emission.iter().enumerate() {
                emits[i / SIDE] |= *e != [0.0; 3];
            }
        }
        // The error grows with what a bit may cost; look for the largest cost that is allowed.
        let (mut low, mut high) = (1e-12_f64, 1e-3_f64);
        let mut best = None;
        for _ in 0..SEARCH_STEPS {
            let lambda = (low * high).sqrt();
            let coarse = Rates::Cheapest { lambda: COARSE * lambda };
            let want = |row: usize, column: usize| {
                let emits = emits[row] || emits[column];
                curves.kind(row, column, if emits { EMITTERS * lambda } else { lambda })
            };
            let found = self.make(&want, coarse)?;
            let rms = found.error.rms;
            if rms > max_error {
                high = lambda;
                continue;
            }
            low = lambda;
            best = Some(found);
            if rms >= NEAR * max_error {
                break;
            }
        }
        best.map_or_else(|| self.uniform(Kind::F32), Ok)
    }
}

/// Texture blocks.
fn encode_blocks(
    session: &dyn Session,
    form_factors: &FormFactors,
    truth: &Truth,
    settings: &blocks::Settings<'_>,
) -> Result<Encoded, BakeError> {
    let made = session.encode_blocks(form_factors, &truth.relighter.albedo_list(), settings)?;
    let passes = match settings.matrix {
        Matrix::FormFactors { bounces } => bounces,
        _ => 1,
    };
    let transport = Transport::Blocks(Box::new(made));
    let error = truth.measure(session, &transport, passes)?;
    Ok(Encoded { transport, passes, error })
}

/// Plain bounces after which little is left to come.
fn bounces_needed(session: &dyn Session, truth: &Truth) -> Result<u32, BakeError> {
    if let Some(bounces) = truth.bounces {
        return Ok(bounces);
    }
    let plain = Transport::Tiles(Box::new(truth.relighter.clone().without_coarse()));
    let mut bounces = 4;
    while bounces < BOUNCES_MOST && truth.measure(session, &plain, bounces)?.rms > FULL_ERROR {
        bounces += bounces / 2;
    }
    Ok(bounces)
}
