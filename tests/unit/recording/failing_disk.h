// Failing disk: an SQLite VFS whose N-th write, sync or truncation fails, or all from the N-th on.
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>

namespace evod::recording {

enum class Failure {
    InputOutput,
    Full,
    Torn, // half of the data is written, then the write fails
    Gone, // neither it nor anything later happens, as if the program had been killed before it
};

inline void PrintTo(Failure how, std::ostream* out) {
    constexpr const char* names[] = {"InputOutput", "Full", "Torn", "Gone"};
    *out << names[static_cast<int>(how)];
}

/// The name for RunFile::Options::vfs. The first call registers the VFS.
const char* failing_disk();

/// Lets the operation number `count` from now on fail, and with Gone all later ones; 0: none.
void fail_operation(std::uint64_t count, Failure how);

/// Calls `call` once, on the thread of the operation, before the operation number `count` from now on.
void call_before_operation(std::uint64_t count, std::function<void()> call);

/// Whether the operation has failed.
bool has_failed();

} // namespace evod::recording
