// Each case ends a process of its own, because the flag stays set.
#include "server/commands/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace evod::commands {
namespace {

/// Ends the process with status 7 if the flag was set by the signal, and not before.
void end_after(int signal) {
    catch_interrupts();
    const bool before = interrupted();
    std::raise(signal);
    std::_Exit(interrupted() && !before ? 7 : 1);
}

TEST(InterruptDeathTest, BothSignalsSetTheFlag) {
    EXPECT_EXIT(end_after(SIGINT), testing::ExitedWithCode(7), "");
    EXPECT_EXIT(end_after(SIGTERM), testing::ExitedWithCode(7), "");
}

TEST(InterruptDeathTest, ASecondSignalDoesNotEndTheProgram) {
    EXPECT_EXIT(
        {
            catch_interrupts();
            std::raise(SIGINT);
            end_after(SIGINT);
        },
        testing::ExitedWithCode(1), "");
}

TEST(Interrupt, NothingIsInterruptedWithoutASignal) {
    EXPECT_FALSE(interrupted());
}

} // namespace
} // namespace evod::commands
