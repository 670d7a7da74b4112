//: use kernel::words
//: use sampling::discrete

fn discrete_count(i: u32) -> u32 { return constants[i]; }

fn kernel_discrete_pick_in() {
    let pick = discrete_pick_in(constant_count, word());
    put_word(pick.index);
    put(pick.pmf);
    put_word(pick.remainder);
}

fn kernel_discrete_pmf_in() { put(discrete_pmf_in(constant_count, word())); }

fn kernel_discrete_even_word() {
    let index = word();
    let shift = word();
    put_word(discrete_even_word(index, shift, word()));
}
