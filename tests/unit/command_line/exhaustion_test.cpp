// Exhaustion: a program without memory or threads ends with its line and status; other exceptions abort it.
#include "proto/command_line/exhaustion.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace evod::command_line {
namespace {

/// Throws on another thread, where main cannot catch it.
template <class Exception>
void throw_on_a_thread(const Exception& exception) {
    end_when_exhausted("program: out of memory or threads\n", 7);
    std::thread{[&] { throw exception; }}.join();
}

TEST(ExhaustionDeathTest, EndsWithALineAndStatus) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(throw_on_a_thread(std::bad_alloc{}), testing::ExitedWithCode(7),
                "^program: out of memory or threads\n$");
    EXPECT_EXIT(throw_on_a_thread(std::system_error{std::make_error_code(std::errc::resource_unavailable_try_again)}),
                testing::ExitedWithCode(7), "^program: out of memory or threads\n$");
}

TEST(ExhaustionDeathTest, OtherExceptionsAbort) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(throw_on_a_thread(std::runtime_error{"a fault"}), testing::KilledBySignal(SIGABRT), "");
}

} // namespace
} // namespace evod::command_line
