// Instructions: which of a processor's vector instructions the loops over many bodies use.
//
// Those loops are compiled twice from one source (see evod_kernels in the top CMakeLists.txt) and compute the same bits
// either way; the wider are faster.
#pragma once

namespace evod::base {

enum class Instructions : unsigned char { Baseline, Avx2 };

/// What is in use; at first the widest that this processor has.
Instructions instructions();

/// The widest that this processor has.
Instructions widest_instructions();

/// For tests and measurements. Nothing may be being computed meanwhile, and the processor must have them.
void use_instructions(Instructions instructions);

/// Of the two copies of a kernel the one to call.
template <class Kernel>
const Kernel& chosen(const Kernel& baseline, const Kernel& avx2) {
    return instructions() == Instructions::Avx2 ? avx2 : baseline;
}

} // namespace evod::base
