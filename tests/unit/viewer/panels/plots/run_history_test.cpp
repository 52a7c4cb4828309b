#include "client/viewer/panels/plots/run_history.h"

#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using RunHistoriesTest = ViewedWorldTest;

TEST_F(RunHistoriesTest, KeepTheHistoriesOfTwoWorlds) {
    ViewedWorld left{wanted()}, right{wanted()}, third{wanted()};
    const auto run_of = [](const char* name) {
        v1::WorldInfo world;
        world.set_name(name);
        world.set_run_id(name);
        return world;
    };
    RunHistories histories;
    histories.of(left).set_run(run_of("a"));
    histories.of(right).set_run(run_of("b"));
    EXPECT_EQ(histories.of(left).history().world(), "a") << "the focus moved and came back";
    EXPECT_EQ(histories.of(right).history().world(), "b");
    histories.of(third).set_run(run_of("c"));
    EXPECT_EQ(histories.of(right).history().world(), "b") << "it had the focus later than the left world";
    EXPECT_EQ(histories.of(left).history().world(), "") << "requested again";
}

} // namespace
} // namespace evod::viewer
