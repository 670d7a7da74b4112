//! `etendue bake`: the multi-bounce transport of a scene between patches, in a file.

use super::args::{BackendArgs, TalkArgs};
use super::bake_args::BakeArgs;
use super::error::{CliError, INTERRUPTED};
use super::job::{Stages, heading, open, read_scene};
use super::output::check_folder;
use super::progress::Bar;
use super::radiosity_args::error_json;
use crate::driver::operator_file;
use crate::driver::radiosity::{BakeError, Transport, bake};
use crate::io::{BlockFormat, SaveError, encode_operator, write_ktx2, write_whole};
use etendue_core::backend::BackendError;
use etendue_core::radiosity::blocks::{BlockOperator, Format, SIDE};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `bake`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .xml (Mitsuba 3), .obj or .ply
    scene: PathBuf,
    /// The operator: patches, form factors and what belongs to them; lights without size may change after
    #[arg(short, long, value_name = "OP.etd")]
    output: PathBuf,
    #[command(flatten)]
    bake: BakeArgs,
    /// The same as --pair-samples
    #[arg(long, value_name = "N", conflicts_with = "pair_samples", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    samples: Option<u32>,
    /// Also write the blocks of `--codec published|bc1|bc4` as a texture, a texel for each pair of rows; what is kept aside, and what codes stand for, is in the operator alone. Of a codec that stores half, blocks right of
    /// the diagonal are 0
    #[arg(long, value_name = "FILE")]
    ktx2: Option<PathBuf>,
    /// Seed of all rays
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    args.bake.check()?;
    if args.ktx2.is_some() && !args.bake.has_blocks() {
        return Err(CliError::Usage("--ktx2 needs --codec published, bc1 or bc4".into()));
    }
    for file in std::iter::once(&args.output).chain(&args.ktx2) {
        check_folder(file)?;
    }
    let mut stages = Stages::new();
    let (scene, _) = read_scene(&args.scene, None, &args.talk, &mut stages)?;
    let opened = open(scene, &args.backend, &args.talk, &mut stages)?;
    let samples = args.samples.or(args.bake.pair_samples);
    let settings = BakeArgs { pair_samples: samples, ..args.bake.clone() }.settings(args.seed);
    let bar = Bar::new(&args.talk);
    let baked = match bake(&*opened.session, &settings, &bar) {
        Err(BakeError::Backend(BackendError::Cancelled)) => {
            bar.finish();
            eprintln!("stopped before the operator was complete: nothing was written");
            return Ok(ExitCode::from(INTERRUPTED));
        }
        other => other?,
    };
    bar.finish();
    stages.add(&baked.stages);
    let bytes = encode_operator(&operator_file(&baked, &settings, opened.session.scene()), &args.output)?;
    write_whole(&args.output, &bytes)?;
    if let (Some(file), Transport::Blocks(blocks)) = (&args.ktx2, &baked.operator.transport) {
        write_texture(file, blocks)?;
    }
    stages.done("write");
    let operator = &baked.operator;
    let n = operator.map.patches.len();
    let per_pair = operator.bytes() as f64 / (n as f64 * n as f64);
    if args.talk.json {
        let mut map = heading(&opened, args.seed, &stages);
        let mut add = |name: &str, value: Value| map.insert(name.into(), value);
        add("method", json!("radiosity"));
        add("patches", json!(n));
        add("rays", json!(baked.rays));
        add("bytes", json!(bytes.len()));
        add("bytes_per_pair", json!(per_pair));
        add("passes", json!(operator.passes));
        add("codec_error", error_json(&baked.error));
        add("output", json!(args.output));
        println!("{}", Value::Object(map));
    } else if !args.talk.quiet {
        println!(
            "{}: {n} patches, {:.1} M rays, {per_pair:.3} bytes a pair ({:.2} MB in all), codec error {:.2} % (worst light {:.2} %) in {} passes ({})",
            args.output.display(),
            baked.rays as f64 * 1e-6,
            bytes.len() as f64 * 1e-6,
            100.0 * baked.error.rms,
            100.0 * baked.error.worst,
            operator.passes,
            stages.text()
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// Blocks as a texture.
fn write_texture(file: &Path, operator: &BlockOperator) -> Result<(), SaveError> {
    let parts = operator.parts();
    let n = operator.len();
    let rows = n.div_ceil(SIDE);
    let mut bytes = Vec::with_capacity(8 * rows * rows);
    let mut blocks = parts.blocks.iter();
    for row in 0..rows {
        let stored = if parts.half { row + 1 } else { rows };
        bytes.extend(blocks.by_ref().take(stored).flatten());
        bytes.resize(8 * rows * (row + 1), 0);
    }
    let format = match parts.format {
        Format::Bc1 => BlockFormat::Bc1RgbUnorm,
        Format::Bc4 => BlockFormat::Bc4Unorm,
    };
    write_ktx2(file, (n as u32, n as u32), format, &bytes, &BTreeMap::new())
}
