// Exhaustion: ends a client program with one line and an exit status if memory or threads run out on any of its
// threads. Without this, the C++ library would abort the program. The server has a handler of its own, in
// server/commands/termination.
//
// Threads      call once, in main.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

namespace evod::command_line {

/// Whether the exception says that the system has given no memory or no thread.
inline bool is_exhaustion(const std::exception_ptr& thrown) {
    try {
        if (thrown) {
            std::rethrow_exception(thrown);
        }
    } catch (const std::bad_alloc&) {
        return true;
    } catch (const std::system_error& error) {
        return error.code() == std::errc::resource_unavailable_try_again ||
               error.code() == std::errc::not_enough_memory;
    } catch (...) {
        return false;
    }
    return false;
}

/// line    printed on standard error; ends with a line end. It must exist as long as the program.
/// status  the exit status.
template <std::size_t length>
void end_when_exhausted(const char (&line)[length], int status) {
    static std::string_view text;
    static int exit_status;
    static const std::terminate_handler abort_with_reason = std::get_terminate();
    text = {line, length - 1};
    exit_status = status;
    std::set_terminate([] {
        if (!is_exhaustion(std::current_exception())) {
            abort_with_reason();
        }
        (void)!::write(STDERR_FILENO, text.data(), text.size()); // needs no memory
        std::_Exit(exit_status);
    });
}

} // namespace evod::command_line
