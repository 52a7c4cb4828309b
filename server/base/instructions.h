// Instructions: selects the processor's vector instructions for the loops over many bodies.
//
// The loops are compiled twice from one source (see evod_kernels in the top CMakeLists.txt). Both copies compute the
// same bits; the wider one is faster.
#pragma once

namespace evod::base {

enum class Instructions : unsigned char { Baseline, Avx2 };

/// Returns the instructions in use: initially the widest that this processor has.
Instructions instructions();

/// Returns the widest vector instructions that this processor has.
Instructions widest_instructions();

/// Selects the instructions to use, for tests and measurements. The processor must have them, and no kernel may be
/// running during the call.
void use_instructions(Instructions instructions);

/// Returns the copy of a kernel for the instructions in use.
template <class Kernel>
const Kernel& chosen(const Kernel& baseline, const Kernel& avx2) {
    return instructions() == Instructions::Avx2 ? avx2 : baseline;
}

} // namespace evod::base
