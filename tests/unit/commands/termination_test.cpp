// Each case ends a process of its own.
#include "server/commands/termination.h"

#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <new>
#include <stdexcept>
#include <system_error>

namespace evod::commands {
namespace {

constexpr int exit_out_of_memory = 3;

/// Calls a function whose exception nothing catches.
void call_uncaught(const std::function<void()>& function) noexcept {
    install_termination_handler();
    function();
}

void throw_system_error(std::errc error) {
    throw std::system_error{std::make_error_code(error), "thread"};
}

TEST(TerminationDeathTest, ExhaustedMemoryIsReported) {
    EXPECT_EXIT(call_uncaught([] { throw std::bad_alloc{}; }), testing::ExitedWithCode(exit_out_of_memory),
                "evod: out of memory\n");
}

TEST(TerminationDeathTest, ExhaustedThreadsAreReported) {
    for (const std::errc error : {std::errc::resource_unavailable_try_again, std::errc::not_enough_memory}) {
        EXPECT_EXIT(call_uncaught([error] { throw_system_error(error); }), testing::ExitedWithCode(exit_out_of_memory),
                    "evod: out of memory or threads\n");
    }
}

TEST(TerminationDeathTest, AThreadThatOneTbbCannotStartIsReported) {
    EXPECT_EXIT(call_uncaught([] { throw std::runtime_error{"pthread_create has failed: Resource unavailable"}; }),
                testing::ExitedWithCode(exit_out_of_memory), "evod: out of memory or threads\n");
}

TEST(TerminationDeathTest, AnyOtherExceptionAborts) {
    EXPECT_EXIT(call_uncaught([] { throw std::runtime_error{"a bug"}; }), testing::KilledBySignal(SIGABRT),
                "evod: a bug\n");
    EXPECT_EXIT(call_uncaught([] { throw_system_error(std::errc::io_error); }), testing::KilledBySignal(SIGABRT),
                "evod: thread");
    EXPECT_EXIT(call_uncaught([] { throw 7; }), testing::KilledBySignal(SIGABRT), "");
}

TEST(TerminationDeathTest, TerminateWithoutAnExceptionAborts) {
    EXPECT_EXIT(call_uncaught([] { std::terminate(); }), testing::KilledBySignal(SIGABRT), "");
}

} // namespace
} // namespace evod::commands
