#include "server/protocol/for_each_world.h"

#include "server/protocol/request_rules.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::protocol {
namespace {

v1::Request for_each(const std::string& class_name = "bio") {
    v1::Request request;
    request.set_request_id(7);
    request.set_client_key("key");
    request.mutable_for_each_world()->set_class_(class_name);
    return request;
}

TEST(ForEachWorld, EachActionBecomesTheRequestForOneWorld) {
    const auto* actions = v1::ForEachWorld::descriptor()->FindOneofByName("action");
    ASSERT_GT(actions->field_count(), 0);
    for (int i = 0; i < actions->field_count(); ++i) {
        v1::Request request = for_each();
        auto& each = *request.mutable_for_each_world();
        each.GetReflection()->MutableMessage(&each, actions->field(i));
        const v1::Request one = request_for(request, "bio_ann");
        EXPECT_EQ(name_of(one), actions->field(i)->name());
        EXPECT_EQ(world_of(one), "bio_ann");
        EXPECT_EQ(one.request_id(), 7u);
        EXPECT_EQ(one.client_key(), "key");
        ASSERT_NE(rules_of(one), nullptr);
        EXPECT_TRUE(rules_of(one)->by_owner()) << "otherwise the teacher could not send it";
    }
}

TEST(ForEachWorld, TheActionKeepsItsFields) {
    v1::Request request = for_each();
    request.mutable_for_each_world()->mutable_run()->set_generations(5);
    EXPECT_EQ(request_for(request, "bio_ann").run().generations(), 5u);
    EXPECT_TRUE(acts_on_forks(request));
    request.mutable_for_each_world()->mutable_reset_world()->set_seed(3);
    EXPECT_EQ(request_for(request, "bio_ann").reset_world().seed(), 3u);
    EXPECT_FALSE(acts_on_forks(request));
}

TEST(ForEachWorld, FaultsHaveThePathInTheRequest) {
    v1::Request request = for_each();
    EXPECT_EQ(refusal_of_action(request)->violations.at(0).field, "for_each_world.action");
    request.mutable_for_each_world()->mutable_run()->set_generations(0);
    EXPECT_EQ(refusal_of_action(request)->violations.at(0).field, "for_each_world.run.generations");
    request.mutable_for_each_world()->mutable_run()->set_generations(1);
    EXPECT_FALSE(refusal_of_action(request));
    request.set_client_key("");
    EXPECT_EQ(refusal_of_action(request)->violations.at(0).field, "client_key");
    EXPECT_EQ(refusal_of_action(for_each(""))->violations.at(0).field, "for_each_world.class");
}

TEST(ForEachWorld, AnActionNamesNoWorld) {
    v1::Request request = for_each();
    request.mutable_for_each_world()->mutable_pause()->set_world("other");
    EXPECT_EQ(refusal_of_action(request)->violations.at(0).field, "for_each_world.pause.world");
}

TEST(ForEachWorld, TheKeyOfOneWorldIsNoKeyOfAClient) {
    const std::string longest(64, 'k');
    EXPECT_EQ(key_of_batch(key_for(longest, "bio_ann")), longest);
    EXPECT_EQ(key_of_batch(key_for("", "bio_ann")), "");
    EXPECT_NE(key_for("key", "bio_ann"), key_for("key", "bio_ben"));
    EXPECT_FALSE(key_of_batch(longest));
    EXPECT_FALSE(key_of_batch(std::string(64, ' ')));
}

} // namespace
} // namespace evod::protocol
