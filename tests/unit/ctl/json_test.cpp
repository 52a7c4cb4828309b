#include "client/ctl/json.h"

#include "evod/v1/commands.pb.h"

#include <gtest/gtest.h>

#include <limits>

namespace evod::ctl {
namespace {

namespace v1 = evod::v1;

TEST(Json, WritesExactIntegersAsNumbers) {
    v1::Response response;
    response.set_request_id((std::uint64_t{1} << 53) - 1);
    response.set_applied_tick(std::uint64_t{1} << 53);
    auto& world = *response.mutable_world();
    world.set_name("12");
    world.set_seed(std::numeric_limits<std::uint64_t>::max());
    world.set_tick(60);
    world.add_gene_names("quote \" and \\");
    world.add_gene_names("7");
    const std::string text = to_json(response, false);
    for (const char* part :
         {R"("request_id":9007199254740991,)", R"("applied_tick":"9007199254740992")", R"("name":"12")",
          R"("seed":"18446744073709551615")", R"("tick":60)", R"("quote \" and \\","7")"}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
    }
}

TEST(Json, WritesNumbersInNestedRepeatedMessages) {
    v1::Statistics statistics;
    for (const std::uint64_t generation : {4, 5}) {
        statistics.add_last()->set_generation(generation);
    }
    const std::string text = to_json(statistics, false);
    EXPECT_NE(text.find(R"("generation":4,)"), std::string::npos) << text;
    EXPECT_NE(text.find(R"("generation":5,)"), std::string::npos) << text;
}

} // namespace
} // namespace evod::ctl
