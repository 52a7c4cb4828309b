// Detached: the completion token of a coroutine without a caller. If the coroutine runs out of memory, its work is
// incomplete, so std::bad_alloc leaves the network thread's loop and ends the program. asio::detached would hide it.
#pragma once

#include <exception>
#include <new>

namespace evod::network {

inline constexpr auto detached = [](const std::exception_ptr& error) {
    if (!error) {
        return;
    }
    try {
        std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (...) { // NOLINT(bugprone-empty-catch): the coroutine was cancelled
    }
};

} // namespace evod::network
