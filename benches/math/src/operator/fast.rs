//! Time against error, one thread, in turns.

use super::{Made, Outcome, small, target};
use crate::figure::{Dot, Dots};
use crate::timing::median;
use cpu_time::ProcessTime;
use etendue::core::backend::Session;
use etendue::core::radiosity::operator::{Dense, LinearOperator, SymmetricHalf};
use etendue::core::radiosity::polynomial::{ConjugateGradients, GaussSeidel, Inner, Jacobi, Settings, solve};
use etendue::cpu::CpuSession;
use etendue::driver::radiosity::{CodecError, Judge, Rooms, Transport};
use etendue_cpu::Linear;

/// Turns, besides one that does not count.
const TURNS: usize = 9;
/// What solvers are asked for: a proved bound of the error, relative to the largest radiosity.
const TOLERANCE: f64 = 1e-4;
/// The light that is timed: a lamp near a wall.
const LIGHT: usize = 2;

type Light = Vec<[f32; 3]>;

/// Gives indirect irradiance from direct, and the passes over form factors that took.
type Work<'a> = Box<dyn FnMut(&Light) -> Outcome<(Light, u32)> + 'a>;

struct Contender<'a> {
    name: String,
    /// Bytes that a pass reads, where that is one number.
    bytes: usize,
    work: Work<'a>,
}

/// What one reached.
pub struct Timed {
    /// Its name.
    pub name: String,
    /// Median CPU milliseconds.
    pub milliseconds: f64,
    /// Median of how many times less that is than the first's in the same turn, and its least and most.
    pub ratio: [f64; 3],
    /// Passes over form factors.
    pub passes: u32,
    /// Bytes of what is read in a pass.
    pub bytes: usize,
    /// Over the probe lights.
    pub error: CodecError,
}

/// E = F B of so many bounces.
fn plain<O: LinearOperator>(
    operator: &O,
    albedo: &[[f32; 3]],
    direct: &Light,
    passes: u32,
) -> Outcome<Light> {
    let reflect = |e: &[[f32; 3]], into: &mut Light| {
        for (((b, e), direct), rho) in into.iter_mut().zip(e).zip(direct).zip(albedo) {
            *b = [0, 1, 2].map(|c| rho[c] * (direct[c] + e[c]));
        }
    };
    let mut found = vec![[0.0; 3]; direct.len()];
    let mut radiosity = found.clone();
    for _ in 0..passes {
        reflect(&found, &mut radiosity);
        operator.apply_rgb(&radiosity, &mut found)?;
    }
    Ok(found)
}

fn solved<O: LinearOperator, I: Inner<O>>(
    inner: &I,
    operator: &O,
    (areas, albedo): (&[f32], &[[f32; 3]]),
    direct: &Light,
) -> Outcome<(Light, u32)> {
    let start: Light = direct.iter().zip(albedo).map(|(e, rho)| [0, 1, 2].map(|c| rho[c] * e[c])).collect();
    let settings = Settings { tolerance: TOLERANCE, ..Settings::default() };
    let found = solve(inner, operator, areas, albedo, &start, settings)?;
    let mut irradiance = start;
    operator.apply_rgb(&found.radiosity, &mut irradiance)?;
    Ok((irradiance, found.passes + found.wide_passes + 1))
}

fn dense(made: &Made) -> Outcome<Dense> {
    let (n, f) = (made.len(), &made.form_factors);
    let mut entries = Vec::with_capacity(n * n);
    for i in 0..n {
        entries.extend((0..n).map(|j| f.flux(i, j) / f.areas[i]));
    }
    Ok(Dense::try_new(n, entries)?)
}

/// Times everything on one thread.
///
/// # Errors
/// Of the driver.
pub fn measure(session: &CpuSession, made: &Made, table: &small::Table) -> Outcome<Vec<Timed>> {
    let full = dense(made)?;
    let half = SymmetricHalf::try_new(made.form_factors.areas.clone(), made.form_factors.half.clone())?;
    let linear = Linear::new(Some(1))?;
    let (areas, albedo) = (&made.form_factors.areas[..], made.truth.relighter.albedo_list());
    let (albedo, n) = (&albedo[..], made.len());
    let (wide, wide_half) = (linear.operator(&full), linear.operator(&half));
    let ground = (areas, albedo);
    let (of_full, of_half) = (4 * n * n, 2 * n * (n + 1));
    let mut contenders: Vec<Contender<'_>> = Vec::new();
    contenders.push(Contender {
        name: small::PLAIN.into(),
        bytes: of_full,
        work: Box::new(|e| Ok((plain(&wide, albedo, e, 3)?, 3))),
    });
    contenders.push(Contender {
        name: "half of A F f32, 3 plain passes".into(),
        bytes: of_half,
        work: Box::new(|e| Ok((plain(&wide_half, albedo, e, 3)?, 3))),
    });
    for row in &table.rows {
        let Some(transport) = &row.transport else { continue };
        if row.name.starts_with("f32") {
            continue;
        }
        let (passes, mut rooms, mut found) = (row.passes, Rooms::default(), vec![[0.0; 3]; n]);
        let work: Work<'_> = Box::new(move |e| {
            transport.relight(session, (e, &[]), &mut found, passes, &mut rooms)?;
            Ok((found.clone(), passes))
        });
        contenders.push(Contender { name: row.name.clone(), bytes: row.bytes, work });
    }
    let name = |method: &str| format!("{method} to 1e-4, F f32");
    contenders.push(Contender {
        name: name("Jacobi"),
        bytes: of_full,
        work: Box::new(|e| solved(&Jacobi, &wide, ground, e)),
    });
    contenders.push(Contender {
        name: name("Gauss-Seidel"),
        bytes: of_full,
        work: Box::new(|e| solved(&GaussSeidel, &full, ground, e)),
    });
    contenders.push(Contender {
        name: name("conjugate gradients"),
        bytes: of_full,
        work: Box::new(|e| solved(&ConjugateGradients, &wide, ground, e)),
    });
    run(made, contenders)
}

fn run(made: &Made, mut contenders: Vec<Contender<'_>>) -> Outcome<Vec<Timed>> {
    let light = &made.truth.lights[LIGHT];
    let mut judged = Vec::new();
    for c in &mut contenders {
        let mut judge = Judge::default();
        for (direct, exact) in made.truth.lights.iter().zip(&made.truth.exact) {
            judge.add(&made.form_factors.areas, &(c.work)(direct)?.0, exact);
        }
        judged.push(judge.error());
    }
    let mut seconds = vec![Vec::new(); contenders.len()];
    let mut passes = vec![0; contenders.len()];
    for _ in 0..TURNS {
        for (k, c) in contenders.iter_mut().enumerate() {
            let start = ProcessTime::now();
            let (found, count) = (c.work)(light)?;
            seconds[k].push(start.elapsed().as_secs_f64());
            std::hint::black_box(found);
            passes[k] = count;
        }
    }
    let timed = contenders.iter().enumerate().map(|(k, c)| {
        let ratios: Vec<f64> = seconds[0].iter().zip(&seconds[k]).map(|(a, b)| a / b).collect();
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let most = ratios.iter().copied().fold(0.0, f64::max);
        Timed {
            name: c.name.clone(),
            milliseconds: 1e3 * median(seconds[k].iter().copied()),
            ratio: [median(ratios.iter().copied()), least, most],
            passes: passes[k],
            bytes: c.bytes,
            error: judged[k],
        }
    });
    Ok(timed.collect())
}

/// The table as text, and whether targets were reached.
///
/// # Errors
/// Of the driver.
pub fn text(session: &dyn Session, made: &Made, table: &small::Table, timed: &[Timed]) -> Outcome<String> {
    let mut out = String::from(
        "| way | ms a light | times faster than 3 passes of F f32 (least to most) | passes | ms a pass | GB/s | rms error, % |\n|---|---:|---:|---:|---:|---:|---:|\n",
    );
    for t in timed {
        let pass = t.milliseconds / f64::from(t.passes);
        let [ratio, least, most] = t.ratio;
        out += &format!(
            "| {} | {:.2} | {ratio:.2} ({least:.2} to {most:.2}) | {} | {pass:.2} | {:.2} | {:.3} |\n",
            t.name,
            t.milliseconds,
            t.passes,
            1e-6 * t.bytes as f64 / pass,
            100.0 * t.error.rms
        );
    }
    let find = |name: &str| timed.iter().find(|t| t.name == name);
    let (Some(auto), Some(base)) = (find(small::AUTO), timed.first()) else { return Ok(out) };
    let per_pass = base.milliseconds / f64::from(base.passes);
    // The same number of passes: what that many of F f32 take.
    let same = auto.ratio[0] * f64::from(auto.passes) / f64::from(base.passes);
    let needed = small::plain_passes(session, made, auto.error.rms)?;
    let equal = auto.ratio[0] * f64::from(needed) / f64::from(base.passes);
    out += &format!(
        "\nAt equal error: {needed} plain passes of F f32, {:.1} ms, reach the {:.2} % that `{}` reaches in {} passes and {:.2} ms.\n\n",
        per_pass * f64::from(needed),
        100.0 * auto.error.rms,
        auto.name,
        auto.passes,
        auto.milliseconds
    );
    let row = table.row(small::AUTO).and_then(|r| r.transport.as_ref());
    if let Some(Transport::Tiles(tiles)) = row {
        let census = tiles.tiles().census();
        let all: u64 = census.iter().sum();
        let full = all - census[0];
        let pass = auto.milliseconds / f64::from(auto.passes);
        out += &format!(
            "A pass of `{}` reads {:.0} times fewer bytes than one of F f32 and takes {:.1} times less: {:.0} ns for each of the {:.0} % of tiles that are not empty, the step on clusters included.\n\n",
            auto.name,
            base.bytes as f64 / auto.bytes as f64,
            same,
            1e6 * pass / full as f64,
            100.0 * full as f64 / all as f64
        );
    }
    out += &target("6 times faster than as many passes of F f32", &format!("{same:.1} times"), same >= 6.0);
    out += &target("13 times faster at equal error", &format!("{equal:.1} times"), equal >= 13.0);
    Ok(out)
}

/// Error over time.
pub fn figure(timed: &[Timed]) -> Dots {
    let ours = |name: &str| ["auto", "tiles", "f16", "bc"].iter().any(|start| name.starts_with(start));
    let dot = |t: &Timed| Dot {
        name: t.name.clone(),
        ours: ours(&t.name),
        at: (t.milliseconds, 100.0 * t.error.rms),
    };
    Dots {
        title: "Error of indirect irradiance over eight lights against time, one thread",
        labels: ["CPU milliseconds a light", "rms error, %"],
        dots: timed.iter().map(dot).collect(),
    }
}
