// Failing disk: SQLite's usual way to the disk, but for one write, sync or truncation that fails, or all from one on.
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>

namespace evod::recording {

enum class Failure {
    InputOutput,
    Full,
    Torn, // half of a write is made, then it fails
    Gone, // it is not made and nothing after it either, as if the program had been killed before it
};

inline void PrintTo(Failure how, std::ostream* out) {
    constexpr const char* names[] = {"InputOutput", "Full", "Torn", "Gone"};
    *out << names[static_cast<int>(how)];
}

/// The name to hand to RunFile::Options::vfs. Registers it when first asked.
const char* failing_disk();

/// The number `count` operation from now on fails, and no other unless the disk is Gone; 0: none does.
void fail_operation(std::uint64_t count, Failure how);

/// Calls this once, on the thread that asks for it, before the number `count` operation from now on.
void call_before_operation(std::uint64_t count, std::function<void()> call);

/// Whether the operation that was to fail has.
bool has_failed();

} // namespace evod::recording
