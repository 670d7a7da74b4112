// Cumulative counts of a scene lie in its arena, at the word to which `counts_at` is set before one is picked.

var<private> counts_at: u32;

fn discrete_count(i: u32) -> u32 { return scene_word(counts_at + i); }
