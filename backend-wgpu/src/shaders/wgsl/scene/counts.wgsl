// Cumulative counts lie in the scene's arena, or among the words of a job, at the word to which `counts_at` is set before one is picked.

var<private> counts_at: u32;

//: if JOB_COUNTS
// Added to `counts_at` for counts of the job.
const COUNTS_OF_JOB: u32 = 0x80000000u;

fn discrete_count(i: u32) -> u32 {
    if counts_at >= COUNTS_OF_JOB { return job_word(counts_at - COUNTS_OF_JOB + i); }
    return scene_word(counts_at + i);
}
//: else
fn discrete_count(i: u32) -> u32 { return scene_word(counts_at + i); }
//: end
