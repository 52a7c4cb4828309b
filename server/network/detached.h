// Detached: the end of a coroutine that nothing waits for. A coroutine that ran out of memory has left its work half
// done, so std::bad_alloc leaves the loop of the network thread, and ends the program; asio::detached would hide it.
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
    } catch (...) { // NOLINT(bugprone-empty-catch): a coroutine that was cancelled
    }
};

} // namespace evod::network
