// Instructions: selects the processor's vector instructions for the loops over many bodies.
//
// The loops are compiled several times from one source (see evod_kernels in the top CMakeLists.txt). All copies compute
// the same bits; the wider ones are faster.
#pragma once

#include <span>
#include <string_view>

namespace evod::base {

/// In ascending order of width. A processor that has one of them has all before it.
enum class Instructions : unsigned char { Baseline, Avx2, Avx512 };

std::string_view name_of(Instructions instructions);

/// Returns the instructions in use: initially the widest.
Instructions instructions();

/// Returns the widest vector instructions that this processor executes at full speed. AVX-512 counts only where it does
/// not reduce the clock of the processor.
Instructions widest_instructions();

/// Returns the names of all instructions up to widest_instructions(), in ascending order of width.
std::span<const std::string_view> available_instructions();

/// Selects the instructions to use, of those available. Returns false and changes nothing if the name is another one.
/// No kernel may be running during the call.
bool use_instructions(std::string_view name);

/// Returns the copy of a kernel for the instructions in use.
template <class Kernel>
const Kernel& chosen(const Kernel& baseline, const Kernel& avx2, const Kernel& avx512) {
    const Kernel* const copies[] = {&baseline, &avx2, &avx512};
    return *copies[static_cast<unsigned char>(instructions())];
}

} // namespace evod::base
