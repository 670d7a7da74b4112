//! Bytes against error.

use super::{Made, Outcome, target};
use crate::figure::{Dot, Dots};
use etendue::core::backend::Session;
use etendue::driver::radiosity::{Codec, CodecError, Order, Transport, encode};
use std::collections::HashMap;
use std::time::Instant;

/// A codec of blocks that would take longer to encode [s] is left out.
const PATIENCE: f64 = 60.0;
/// Most patches for the greedy order; beyond, it is that of halves.
const GREEDY_MOST: usize = 4500;
/// Share of kept entries.
const KEEP: f32 = 0.04;
/// Bounces of the published codec, and plain passes beside it.
const BOUNCES: u32 = 3;

/// One way to store the operator.
pub struct Row {
    /// Its name.
    pub name: String,
    /// Bytes of all that a relighting reads.
    pub bytes: usize,
    /// Passes of a relighting.
    pub passes: u32,
    /// Seconds of encoding, all searches included.
    pub seconds: f64,
    /// Against all bounces.
    pub error: CodecError,
    /// What relights; none for plain matrices.
    pub transport: Option<Transport>,
}

/// All rows of a scene and size.
pub struct Table {
    /// Those that were measured.
    pub rows: Vec<Row>,
    /// Those that were left out, and why.
    pub without: Vec<String>,
}

impl Table {
    /// The row of a name.
    pub fn row(&self, name: &str) -> Option<&Row> {
        self.rows.iter().find(|r| r.name == name)
    }
}

/// Name of the row that targets are for.
pub const AUTO: &str = "auto, 1 %";
/// Name of the best of the block codecs.
pub const BC1: &str = "bc1, mended, 4 % kept";
/// Name of what everything is compared with.
pub const PLAIN: &str = "F f32, 3 plain passes";
/// Start of the name of the published codec.
pub const PUBLISHED: &str = "published, k = 3";

/// Names, codecs, and passes where they are not the codec's to choose.
fn codecs(n: usize) -> Vec<(String, Codec, Option<u32>)> {
    let auto = |percent: f64| (format!("auto, {percent} %"), Codec::Auto { max_error: 0.01 * percent }, None);
    let (order, name) = if n <= GREEDY_MOST { (Order::Greedy2, "greedy2") } else { (Order::Kd, "kd") };
    let published = |bounces| Codec::Published { bounces, keep: KEEP, order };
    vec![
        auto(2.0),
        auto(1.0),
        auto(0.5),
        ("tiles, 8 bits".into(), Codec::Tiles, None),
        ("f16".into(), Codec::F16, None),
        ("f32".into(), Codec::F32, None),
        (format!("f32, {BOUNCES} passes"), Codec::F32, Some(BOUNCES)),
        (format!("{PUBLISHED}, {name}"), published(Some(BOUNCES)), None),
        (format!("published, all bounces, {name}"), published(None), None),
        (BC1.into(), Codec::Bc1 { keep: KEEP }, None),
        ("bc4, 4 % kept".into(), Codec::Bc4 { keep: KEEP }, None),
    ]
}

/// Seconds that codecs took at a size, for guesses at the next.
pub type Times = HashMap<String, (usize, f64)>;

fn is_dense(codec: Codec) -> bool {
    matches!(codec, Codec::Published { .. } | Codec::Bc1 { .. } | Codec::Bc4 { .. })
}

/// Encodes by all codecs.
///
/// # Errors
/// Of the driver.
pub fn measure(session: &dyn Session, made: &Made, times: &mut Times) -> Outcome<Table> {
    let n = made.len();
    let mut table = Table { rows: Vec::new(), without: Vec::new() };
    for (name, codec, passes) in codecs(n) {
        // Of one family whatever the order.
        let family = name.replace(", greedy2", "").replace(", kd", "");
        if let Some((size, seconds)) = times.get(&family)
            && is_dense(codec)
        {
            // Matrices are multiplied in n^3 operations.
            let guess = seconds * {
                let x = n as f64 / *size as f64;
                x * x * x
            };
            if guess > PATIENCE {
                table.without.push(format!("{name} (about {guess:.0} s to encode)"));
                continue;
            }
        }
        let start = Instant::now();
        let made = encode(session, (&made.form_factors, &made.voxels), &made.truth, codec, passes);
        let seconds = start.elapsed().as_secs_f64();
        eprintln!("  {name}: {seconds:.1} s");
        times.insert(family, (n, seconds));
        let encoded = match made {
            Ok(encoded) => encoded,
            Err(e) => {
                table.without.push(format!("{name} ({e})"));
                continue;
            }
        };
        table.rows.push(Row {
            name,
            bytes: encoded.transport.bytes(),
            passes: encoded.passes,
            seconds,
            error: encoded.error,
            transport: Some(encoded.transport),
        });
    }
    let plain = Transport::Tiles(Box::new(made.truth.relighter.clone().without_coarse()));
    let error = made.truth.measure(session, &plain, BOUNCES)?;
    let row = |name: &str, bytes, passes| Row {
        name: name.into(),
        bytes,
        passes,
        seconds: 0.0,
        error,
        transport: None,
    };
    // An albedo per patch beside the matrix; M has it inside.
    table.rows.push(row(PLAIN, 4 * n * n + 12 * n, BOUNCES));
    table.rows.push(row("M f32, k = 3", 12 * n * n, 1));
    Ok(table)
}

/// How many plain passes over f32 it takes to reach an error.
///
/// # Errors
/// Of the driver.
pub fn plain_passes(session: &dyn Session, made: &Made, error: f64) -> Outcome<u32> {
    const MOST: u32 = 200;
    let plain = Transport::Tiles(Box::new(made.truth.relighter.clone().without_coarse()));
    for passes in 1..MOST {
        if made.truth.measure(session, &plain, passes)?.rms <= error {
            return Ok(passes);
        }
    }
    Ok(MOST)
}

/// The table of a scene and size as text.
pub fn text(table: &Table, made: &Made) -> String {
    let mut out = String::from(
        "| codec | B per pair | times less than M f32 | times less than F f32 | passes | rms error, % | worst light, % | energy, % | encoding, s |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let pairs = (made.len() * made.len()) as f64;
    for r in &table.rows {
        let bytes = r.bytes as f64;
        out += &format!(
            "| {} | {:.3} | {:.1} | {:.1} | {} | {:.2} | {:.2} | {:.3} | {} |\n",
            r.name,
            bytes / pairs,
            12.0 * pairs / bytes,
            4.0 * pairs / bytes,
            r.passes,
            100.0 * r.error.rms,
            100.0 * r.error.worst,
            100.0 * r.error.energy,
            if r.transport.is_some() { format!("{:.1}", r.seconds) } else { "-".into() }
        );
    }
    if !table.without.is_empty() {
        out += &format!("\nLeft out: {}.\n", table.without.join("; "));
    }
    out
}

/// What the table says, and whether the row that targets are for reaches them.
pub fn targets(table: &Table, made: &Made) -> String {
    let Some(auto) = table.row(AUTO) else { return String::new() };
    let pairs = (made.len() * made.len()) as f64;
    let mut said = format!(
        "`{AUTO}` takes {:.0} times fewer bytes than M in f32 and {:.0} times fewer than F in f32",
        12.0 * pairs / auto.bytes as f64,
        4.0 * pairs / auto.bytes as f64
    );
    for start in [PUBLISHED, "bc1"] {
        if let Some(other) = table.rows.iter().find(|r| r.name.starts_with(start)) {
            said += &format!(
                ", {:.1} times fewer than `{}`, whose error is {:.0} times as large",
                other.bytes as f64 / auto.bytes as f64,
                other.name,
                other.error.rms / auto.error.rms
            );
        }
    }
    if let Some(plain) = table.row(PLAIN) {
        said += &format!("; three bounces with no compression err by {:.1} %", 100.0 * plain.error.rms);
    }
    let (bytes, error) = (made.per_pair(auto.bytes), auto.error);
    let most = if made.len() > 6000 { 0.11 } else { 0.15 };
    let found = format!("{:.2} % at {bytes:.3} in {} passes", 100.0 * error.rms, auto.passes);
    let mut out = format!("{said}.\n\n");
    out += &target(
        &format!("at most 1 % in 3 passes at {most} B per pair"),
        &found,
        error.rms <= 0.01 && auto.passes <= 3 && bytes <= most,
    );
    out += &target("energy within 0.1 %", &format!("{:.3} %", 100.0 * error.energy), error.energy <= 1e-3);
    out
}

/// Error over bytes.
pub fn figure(table: &Table, made: &Made) -> Dots {
    let dot = |r: &Row| Dot {
        name: r.name.clone(),
        ours: !(r.name.starts_with("published") || r.transport.is_none()),
        at: (made.per_pair(r.bytes), 100.0 * r.error.rms),
    };
    Dots {
        title: "Error of indirect irradiance over eight lights against bytes",
        labels: ["bytes per pair of patches, all counted", "rms error, %"],
        dots: table.rows.iter().map(dot).collect(),
    }
}
