//! The table of the published source, with our numbers.

use super::{Made, Outcome};
use etendue::core::radiosity::blocks::{PublishedTable, published_table};
use etendue_cpu::Linear;

/// Bounces and the share of kept entries.
const BOUNCES: u32 = 3;
const KEEP: f32 = 0.04;

/// The table of one scene.
///
/// # Errors
/// Of the codec.
pub fn table(made: &Made) -> Outcome<PublishedTable> {
    // No order is that in which patches come from voxels.
    let form_factors = made.form_factors.reordered(&made.voxels);
    let list = made.truth.relighter.albedo_list();
    let albedo: Vec<[f32; 3]> = made.voxels.iter().map(|i| list[*i as usize]).collect();
    Ok(published_table(&Linear::new(None)?, &form_factors, &albedo, BOUNCES, KEEP)?)
}

/// It as text.
pub fn text(table: &PublishedTable) -> String {
    let mut out = format!(
        "{} patches, k = {}, {:.0} % kept; the entries of M (no unit) of all channels add up to {:.1}, the largest is {:.4}.\n\n",
        table.patches,
        table.bounces,
        100.0 * table.keep,
        table.matrix_total,
        table.matrix_max
    );
    out += "| order | mean error | largest | total | relative L2, % | distance of neighbours, steps of codes | B per pair | times less than M f32 | times less than F f32 |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    let pairs = (table.patches * table.patches) as f64;
    for (order, name) in table.orders.iter().zip(["none", "one pass", "two passes"]) {
        out += &format!(
            "| {name} | {:.2e} | {:.2e} | {:.2} | {:.2} | {} | {:.3} | {:.2} | {:.2} |\n",
            order.mean,
            order.max,
            order.total,
            100.0 * order.relative_l2,
            order.neighbour_distance,
            order.bytes as f64 / pairs,
            table.ratio_to_matrix(order),
            table.ratio_to_form_factors(order)
        );
    }
    let direction = |from: f64, to: f64| if to < from { "falls" } else { "rises" };
    if let [_, one, two] = &table.orders[..] {
        out += &format!(
            "\nFrom the first pass to the second our mean {}, our largest error {}.\n",
            direction(one.mean, two.mean),
            direction(one.max, two.max)
        );
    }
    out
}
