#include "server/commands/plot_program.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::commands {
namespace {

TEST(PlotProgram, ItsFailureIsARefusal) {
    const recording::TemporaryFolder folder;
    testing::internal::CaptureStderr();
    const auto drawn = draw_curves(folder.path() + "/none.csv", "title", "subtitle", "y", folder.path() + "/plot.svg");
    const std::string errors = testing::internal::GetCapturedStderr();
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, base::RefusalCode::FailedPrecondition);
    EXPECT_THAT(drawn.error().message, testing::HasSubstr("plot_compare"));
    EXPECT_NE(errors, "") << "the script prints its own error";
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

} // namespace
} // namespace evod::commands
