// Instructions: which of the processor's vector instructions the loops over many bodies use.
//
// The loops are compiled twice from one source (see evod_kernels in the top CMakeLists.txt). Both copies compute the
// same bits; the wider one is faster.
#pragma once

namespace evod::base {

enum class Instructions : unsigned char { Baseline, Avx2 };

/// The instructions in use: initially the widest that this processor has.
Instructions instructions();

/// The widest that this processor has.
Instructions widest_instructions();

/// For tests and measurements. No kernel may be running at the time, and the processor must have these instructions.
void use_instructions(Instructions instructions);

/// Returns the copy of a kernel for the instructions in use.
template <class Kernel>
const Kernel& chosen(const Kernel& baseline, const Kernel& avx2) {
    return instructions() == Instructions::Avx2 ? avx2 : baseline;
}

} // namespace evod::base
