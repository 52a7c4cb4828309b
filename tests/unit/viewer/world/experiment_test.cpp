#include "client/viewer/world/experiment.h"

#include "tests/unit/viewer/world/viewed_world_fixture.h"

#include <memory>

namespace evod::viewer {
namespace {

struct ExperimentTest : ViewedWorldTest {
    /// Whether organisms have bodies in a world with these parameters.
    bool has_bodies(const std::string& fitness, bool external_bodies) {
        auto owned = std::make_unique<ViewedWorld>(wanted());
        ViewedWorld& world = *owned;
        core::FakeSession session = begin(world);
        until(world, [&] { return session.unread_bytes() > 0; });
        answer_statistics(session, session.read_request());
        until(world, [&] { return world.all_answered(); });
        Experiment experiment;
        EXPECT_TRUE(experiment.has_bodies()) << "until the parameters are known";
        until(world, [&] {
            experiment.update(world, Poll::Clock::now());
            return session.unread_bytes() > 0;
        });
        const evod::v1::Request request = session.read_request();
        EXPECT_TRUE(request.has_get_parameters()) << request.DebugString();
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        evod::v1::ParameterSet& set = *message.mutable_response()->mutable_parameters();
        set.set_summary("They live.");
        evod::v1::ParameterState& first = *set.add_parameters();
        first.set_name("fitness");
        first.mutable_value()->set_choice(fitness);
        evod::v1::ParameterState& second = *set.add_parameters();
        second.set_name("external_bodies");
        second.mutable_value()->set_flag(external_bodies);
        session.send(message);
        until(world, [&] { return !experiment.text().empty(); });
        owned.reset(); // before the session ends, or else it connects again, and the next session is that one
        return experiment.has_bodies();
    }
};

TEST_F(ExperimentTest, KnowsWhetherOrganismsHaveBodies) {
    EXPECT_TRUE(has_bodies("life", false));
    EXPECT_TRUE(has_bodies("external", true));
    EXPECT_FALSE(has_bodies("external", false));
    EXPECT_FALSE(has_bodies("gene_sum", true));
}

} // namespace
} // namespace evod::viewer
