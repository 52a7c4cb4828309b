// Build: the commit, compiler and build type of this program.
#pragma once

#include <string>

namespace evod::run_file {

/// "3f2a91c0d4e5 by GNU 12.2.0 for x86_64, Release": the commit where it is known, with a + if files were changed
/// since; the compiler and its version; the processor; the type of build.
std::string build_text();

} // namespace evod::run_file
