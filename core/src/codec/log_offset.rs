//! Log/offset quantisation of numbers in (0, 1] to 8 bits.
