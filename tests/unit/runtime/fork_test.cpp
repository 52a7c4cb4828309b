#include "server/runtime/fork.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::runtime {
namespace {

using recording::change;
using testing::HasSubstr;

class ForkTest : public testing::Test {
  protected:
    ForkTest() {
        auto data = *run_file::DataFolder::open(folder.path());
        recording::StorageThread thread{{}};
        recording::RecordedRun run{data, thread};
        run.advance(70);
        run.fork(run_id);
        const simulation::World& fork = (*run.laboratory().find("fork"))->world;
        hash = fork.hash();
        run.recorder().close_all(run.laboratory());
        EXPECT_TRUE(thread.finish());
        path = data.file_of("fork");
    }
    /// The outcome that the client gets.
    base::Result<simulation::Applied> checked(const base::StateHash& expected) const {
        CommandDone done{.mail = {},
                         .outcome = simulation::Applied{.world = "fork", .tick = 70, .parameters = {}},
                         .frame = "forked",
                         .fork = ForkFile{{path, path + "-ended"}, run_id, expected}};
        SteadyClock clock;
        JobTurns turns{1, clock};
        const std::stop_token stop;
        JobTurns::Turn turn{turns, "ada", stop};
        const CommandDone answer = check_fork(std::move(done), turn);
        EXPECT_FALSE(answer.fork);
        EXPECT_EQ(answer.frame == "forked", answer.outcome.has_value());
        return answer.outcome;
    }

    const support::TemporaryFolder folder;
    const simulation::RunId run_id{3, 4};
    base::StateHash hash;
    std::string path;
};

TEST_F(ForkTest, AWholeFileIsAnswered) {
    EXPECT_TRUE(checked(hash));
}

TEST_F(ForkTest, AFileOfARunThatHasEndedIsFound) {
    std::filesystem::rename(path, path + "-ended");
    EXPECT_TRUE(checked(hash));
    EXPECT_FALSE(checked(hash + base::EntityHash{1, 2}.finish()));
    std::filesystem::remove(path + "-ended");
    EXPECT_TRUE(checked(hash)) << "another command has ended the run";
}

TEST_F(ForkTest, AnotherStateIsRefused) {
    const auto refused = checked(hash + base::EntityHash{1, 2}.finish());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::DataLoss);
    EXPECT_THAT(refused.error().message, HasSubstr("another state hash"));
}

TEST_F(ForkTest, ADamagedFileIsRefused) {
    change(path, "DELETE FROM population");
    const auto refused = checked(hash);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("delete the fork"));
}

} // namespace
} // namespace evod::runtime
