//! `cargo run --release -p etendue-benches --bin operator [-- PART ...]`: writes `docs/operator.md` with its figures.
//!
//! Parts are the tables of a scene (`cornell`, `colonnade`, `sponza`), `published`, `bake` and `probes`; with names of parts only these are written anew, and the rest of the page stays. `--quick` prints all of it for 1000 patches,
//! `--sizes 1000,2000` for others, and neither writes. `ETENDUE_SCENES` names the folder of the shared scenes; without it Sponza and the probes are left out.
#![allow(clippy::disallowed_methods, reason = "a program that prints")]

use etendue_benches::draw;
use etendue_benches::operator::{Made, Outcome, bake, fast, open, probes, published, scenes, small};
use std::path::{Path, PathBuf};

const PARTS: [&str; 6] = ["cornell", "colonnade", "sponza", "published", "bake", "probes"];
/// Threads of a bake.
const THREADS: usize = 2;

struct Plan {
    data: Option<PathBuf>,
    /// Of the tables.
    sizes: Vec<u32>,
    /// Of the probes.
    probes: Vec<u32>,
    /// Of the bake and of the published table.
    bake: u32,
    published: u32,
    figures: PathBuf,
}

/// Bytes and time of a scene.
fn tables(name: &str, plan: &Plan) -> Outcome<String> {
    let mut out = String::new();
    for case in scenes::cases(plan.data.as_deref())?.iter().filter(|c| c.name == name) {
        out += &format!("## {}\n\n{}; {} triangles.\n", case.name, case.about, case.scene.triangles.len());
        let mut times = small::Times::new();
        for count in &plan.sizes {
            let session = open(&case.scene, THREADS)?;
            let made = Made::new(&session, *count)?;
            let n = made.len();
            eprintln!("{}: {n} patches", case.name);
            let table = small::measure(&session, &made, &mut times)?;
            let [bytes, time] = ["bytes", "time"].map(|what| format!("{}_{count}_{what}.svg", case.name));
            draw::dots(&small::figure(&table, &made), &plan.figures.join(&bytes))?;
            out += &format!(
                "\n### {}: {n} patches, bytes\n\n![error against bytes](operator/{bytes})\n\n{}\n{}",
                case.name,
                small::text(&table, &made),
                small::targets(&table, &made)
            );
            let one = open(&case.scene, 1)?;
            let timed = fast::measure(&one, &made, &table)?;
            draw::dots(&fast::figure(&timed), &plan.figures.join(&time))?;
            out += &format!(
                "\n### {}: {n} patches, time\n\n![error against time](operator/{time})\n\n{}",
                case.name,
                fast::text(&one, &made, &table, &timed)?
            );
        }
    }
    Ok(out)
}

fn part(name: &str, plan: &Plan) -> Outcome<String> {
    match name {
        "cornell" | "colonnade" | "sponza" => tables(name, plan),
        "published" => {
            let cases = scenes::cases(None)?;
            let case = cases.iter().find(|c| c.name == "colonnade").ok_or("no colonnade")?;
            let made = Made::new(&open(&case.scene, THREADS)?, plan.published)?;
            let text = published::text(&published::table(&made)?);
            Ok(format!(
                "{}\n{text}{}",
                include_str!("../operator/published.md"),
                include_str!("../operator/published_after.md")
            ))
        }
        "bake" => {
            let cases = scenes::cases(plan.data.as_deref())?;
            let case = cases.last().ok_or("no scene")?;
            let stages = bake::stages(case, plan.bake, THREADS)?;
            Ok(format!("## Bake\n\n{stages}\n{}", bake::form_factors()?))
        }
        _ => {
            let head = include_str!("../operator/probes.md");
            let Some(data) = &plan.data else {
                return Ok(format!(
                    "{head}\nLeft out: ETENDUE_SCENES does not name the folder of the shared scenes.\n"
                ));
            };
            Ok(format!("{head}\n{}", probes::table(data, &plan.probes)?))
        }
    }
}

fn mark(name: &str) -> String {
    format!("<!-- part: {name} -->\n")
}

/// The part of a name in a page that was written before.
fn old<'a>(page: &'a str, name: &str) -> &'a str {
    let Some(start) = page.find(&mark(name)) else { return "" };
    let rest = &page[start + mark(name).len()..];
    rest.find("<!-- part: ").map_or(rest, |end| &rest[..end]).trim_end()
}

fn numbers(list: &str) -> Outcome<Vec<u32>> {
    Ok(list.split(',').map(str::parse).collect::<Result<_, _>>()?)
}

fn main() -> Outcome<()> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let mut plan = Plan {
        data: std::env::var_os("ETENDUE_SCENES").map(PathBuf::from),
        sizes: vec![4000, 8000],
        probes: vec![1000, 2000, 4000, 8000, 16_000],
        bake: 8000,
        published: 4000,
        figures: docs.join("operator"),
    };
    let mut asked = Vec::new();
    let mut writes = true;
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--quick" | "--sizes" => {
                let list = if arg == "--quick" {
                    "1000".into()
                } else {
                    args.next().ok_or("--sizes needs numbers")?
                };
                let sizes = numbers(&list)?;
                let last = *sizes.last().ok_or("--sizes needs numbers")?;
                (plan.bake, plan.published) = (last, sizes[0]);
                (plan.sizes, plan.probes) = (sizes.clone(), sizes);
                plan.figures = std::env::temp_dir().join("etendue-operator");
                writes = false;
            }
            name if PARTS.contains(&name) => asked.push(arg),
            _ => return Err(format!("{arg}: known are {}, --quick and --sizes", PARTS.join(", ")).into()),
        }
    }
    std::fs::create_dir_all(&plan.figures)?;
    let file = docs.join("operator.md");
    for name in PARTS {
        if !asked.is_empty() && !asked.iter().any(|a| a == name) {
            continue;
        }
        let new = part(name, &plan)?;
        println!("{new}");
        if !writes {
            continue;
        }
        // Written after each part: what comes later may take long.
        let before = std::fs::read_to_string(&file).unwrap_or_default();
        let mut page = include_str!("../operator/page.md").to_owned();
        for p in PARTS {
            let text = if p == name { new.trim_end() } else { old(&before, p).trim_end() };
            page += &format!("\n{}{text}\n", mark(p));
        }
        std::fs::write(&file, page)?;
    }
    Ok(())
}
