//: use kernel::words
//: use transport::mis

fn kernel_mis_power_heuristic() {
    let a = float();
    put(mis_power_heuristic(a, float()));
}
