// Detached: the completion token for a coroutine that has no caller. If the coroutine runs out of memory, its work is
// incomplete. std::bad_alloc then leaves the loop of the network thread and ends the program. asio::detached would
// swallow the exception.
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
