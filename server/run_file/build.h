// Build: the commit, compiler and build type of this program.
#pragma once

#include <string>

namespace evod::run_file {

/// The commit, the compiler with its version, the processor and the build type, as one text:
/// "3f2a91c0d4e5 by GNU 12.2.0 for x86_64, Release". The commit is missing if it is unknown. A + after the commit means
/// that files were changed since.
std::string build_text();

} // namespace evod::run_file
