//: use kernel::words
//: use medium::flight

fn kernel_flight_transmittance() {
    let sigma_t = triple();
    put3(flight_transmittance(sigma_t, float()));
}
