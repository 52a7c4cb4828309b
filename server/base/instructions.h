// Instructions: selects the processor's vector instructions for the loops over many bodies.
//
// The loops are compiled several times from one source (see evod_kernels in the top CMakeLists.txt). All copies compute
// the same bits; on most processors the wider ones are faster.
#pragma once

#include <span>
#include <string_view>

namespace evod::base {

/// In ascending order of width. A processor that has one of them has all before it.
enum class Instructions : unsigned char { Baseline, Avx2, Avx512 };

std::string_view name_of(Instructions instructions);

/// Returns the widest vector instructions that this processor has.
Instructions widest_instructions();

/// Returns the instructions that evod uses unless others are selected: the widest, but no AVX-512 on processors that
/// may reduce their clock for it.
Instructions default_instructions();

/// Returns the names of all instructions that this processor has, in ascending order of width.
std::span<const std::string_view> available_instructions();

/// Returns the instructions in use: initially default_instructions().
Instructions instructions();

/// Selects the instructions to use. The processor must have them, and no kernel may be running during the call.
void use_instructions(Instructions instructions);
/// Selects the instructions with this name. Returns false and changes nothing if they are not available.
bool use_instructions(std::string_view name);

/// Returns the copy of a kernel for the instructions in use.
template <class Kernel>
const Kernel& chosen(const Kernel& baseline, const Kernel& avx2, const Kernel& avx512) {
    const Kernel* const copies[] = {&baseline, &avx2, &avx512};
    return *copies[static_cast<unsigned char>(instructions())];
}

} // namespace evod::base
