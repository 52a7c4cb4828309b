#include "server/commands/termination.h"

#include "server/commands/commands.h"
#include "server/log/log.h"

#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>
#include <thread>

namespace evod::commands {
namespace {

constexpr int exit_out_of_memory = 3;

/// Reserved memory. The handler frees it before writing its message, because writing needs memory.
std::unique_ptr<char[]> memory_for_last_message;

[[noreturn]] void exit_after_second_failure() {
    static constexpr char text[] = "evod: out of memory\n";
    (void)!::write(STDERR_FILENO, text, sizeof text - 1);
    std::_Exit(exit_out_of_memory);
}

[[noreturn]] void abort_with(const std::exception& error) {
    std::cerr << "evod: " << error.what() << '\n';
    std::abort();
}

/// Returns a text that names the exhausted resource. Aborts if the exception has another cause.
const char* missing_resource(std::exception_ptr thrown) {
    if (!thrown) {
        std::abort();
    }
    try {
        std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
        return "out of memory";
    } catch (const std::system_error& error) {
        if (error.code() != std::errc::resource_unavailable_try_again && error.code() != std::errc::not_enough_memory) {
            abort_with(error);
        }
        return "out of memory or threads";
    } catch (const std::exception& error) {
        // oneTBB throws std::runtime_error, without a code, if it cannot start a thread.
        if (std::string_view{error.what()}.starts_with("pthread_create has failed")) {
            return "out of memory or threads";
        }
        abort_with(error);
    } catch (...) {
        std::abort();
    }
}

[[noreturn]] void terminate() {
    static std::atomic<std::thread::id> terminating;
    std::thread::id none;
    if (!terminating.compare_exchange_strong(none, std::this_thread::get_id())) {
        while (terminating != std::this_thread::get_id()) {
            ::pause(); // another thread is ending the program
        }
        exit_after_second_failure(); // memory ran out again while this thread wrote the message below
    }
    const char* const missing = missing_resource(std::current_exception());
    memory_for_last_message.reset();
    if (is_server()) {
        log::error("{}: evod is shutting down; restart it to resume the runs", missing);
    } else {
        std::cerr << "evod: " << missing << '\n';
    }
    std::_Exit(exit_out_of_memory);
}

} // namespace

void install_termination_handler() {
    constexpr std::size_t last_message_bytes = 1 << 20;
    memory_for_last_message = std::make_unique<char[]>(last_message_bytes);
    std::set_terminate(terminate);
}

} // namespace evod::commands
