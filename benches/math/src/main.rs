//! Error against speed, for every piece of the exact math and its rivals.
//!
//! `cargo run --release -p etendue-benches [-- PIECE ...]` times all contenders of each piece in turns and writes
//! `docs/error-against-speed.md` with its figures. With names of pieces it prints only their tables and writes figures
//! of them, but leaves the page alone.

use etendue_benches::figure::{Contest, Curves};
use etendue_benches::{bc1, draw, emission, linear_triangle, log_offset, polynomial, subdivide, timing};
use std::path::Path;

/// Turns that count, and the least time of one contender in a turn \[s\].
const TURNS: usize = 9;
const LEAST: f64 = 0.05;

/// A chapter of the page.
struct Piece {
    name: &'static str,
    heading: &'static str,
    /// What the figures show, for a reader who has not read the code.
    words: &'static str,
    contests: fn() -> Vec<Contest>,
    curves: fn() -> Vec<Curves>,
}

fn none() -> Vec<Curves> {
    Vec::new()
}

const PIECES: &[Piece] = &[
    Piece {
        name: "linear_triangle",
        heading: "Points of linear density over a triangle",
        words: "Weights and random numbers are uniform, so the hard cases of ACCURACY.md hardly occur; a NaN counts as an error of \
                one. Only the published form fails by more than rounding.",
        contests: || vec![linear_triangle::contest()],
        curves: none,
    },
    Piece {
        name: "emission",
        heading: "Mean albedo under a piece of a triangle",
        words: "What a piece of a lit, textured triangle reflects, against the integral of the renderer's own filter.",
        contests: emission::contests,
        curves: none,
    },
    Piece {
        name: "subdivide",
        heading: "Subdivision of a lit triangle",
        words: "Relative L2 error of the piecewise-linear irradiance, each method at its best settings: the published rule over all of \
                91 settings. A sample is a shadow ray. The first table is the price of the rule itself.",
        contests: || vec![subdivide::contest()],
        curves: subdivide::curves,
    },
    Piece {
        name: "log_offset",
        heading: "Numbers to 8 bits",
        words: "Form factors of an empty box, encoded and decoded; the error is that of the irradiance under twelve lights. Rivals with \
                16 bits take twice the memory.",
        contests: || log_offset::contests().into(),
        curves: || vec![log_offset::widths()],
    },
    Piece {
        name: "bc1",
        heading: "Blocks of 4x4 texels in 8 bytes",
        words: "All encoders get the same texels and weigh the channels alike, on one thread. PSNR is 20 log10(255 / error). texpresso never \
                uses the black entry of three-colour blocks: compare it with the opaque rows.",
        contests: bc1::contests,
        curves: none,
    },
    Piece {
        name: "polynomial",
        heading: "Bounces as a polynomial of a matrix",
        words: "Sums of powers of a transport operator, as matrices and applied to light; errors against f64.",
        contests: polynomial::contests,
        curves: polynomial::curves,
    },
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if let Some(unknown) = asked.iter().find(|a| !PIECES.iter().any(|p| p.name == **a)) {
        let known: Vec<_> = PIECES.iter().map(|p| p.name).collect();
        return Err(format!("no piece `{unknown}`; there are {}", known.join(", ")).into());
    }
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let figures = docs.join("error-against-speed");
    std::fs::create_dir_all(&figures)?;
    let mut page = String::from(
        "# Error against speed\n\n\
         Written by `cargo run --release -p etendue-benches`: all contenders of a table took turns within one process, so \
         that a machine's drift hits all alike; rates are medians over the turns, ratios are medians of the ratios within \
         each turn. One thread unless a name says otherwise. Rates belong to the machine; ratios travel better. In the \
         figures ours are filled, rivals hollow; lower is more exact, further right is faster.\n\n",
    );
    for piece in PIECES.iter().filter(|p| asked.is_empty() || asked.iter().any(|a| a == p.name)) {
        let mut chapter = format!("## {}\n\n{}\n\n", piece.heading, piece.words);
        for mut contest in (piece.contests)() {
            let timed = timing::run(&mut contest, TURNS, LEAST);
            let file = figures.join(contest.file).with_extension("svg");
            draw::contest(&contest, &timed, &file)?;
            let table = draw::contest_table(&contest, &timed);
            chapter += &section(contest.title, contest.file, &table);
        }
        for curves in (piece.curves)() {
            draw::curves(&curves, &figures.join(curves.file).with_extension("svg"))?;
            let table = format!("{}\n\n{}", curves.y_label, draw::curves_table(&curves));
            chapter += &section(curves.title, curves.file, &table);
        }
        println!("{chapter}");
        page += &chapter;
    }
    if asked.is_empty() {
        std::fs::write(docs.join("error-against-speed.md"), page.trim_end().to_owned() + "\n")?;
    }
    Ok(())
}

fn section(title: &str, file: &str, table: &str) -> String {
    format!("### {title}\n\n![{title}](error-against-speed/{file}.svg)\n\n{table}\n")
}
