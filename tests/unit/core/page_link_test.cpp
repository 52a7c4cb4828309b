#include "client/core/page_link.h"

#include <gtest/gtest.h>

namespace evod::core {
namespace {

evod::v1::Welcome welcome(std::uint32_t port, const std::string& host = "") {
    evod::v1::Welcome welcome;
    welcome.set_page_port(port);
    welcome.set_page_host(host);
    return welcome;
}

TEST(PageLink, NamesTheHostOfTheServerOrOfTheClient) {
    EXPECT_EQ(page_of(welcome(7745), {.host = "lab", .port = 7744}, false), "http://lab:7745/");
    EXPECT_EQ(page_of(welcome(7745), {.host = "::1", .port = 7744}, true), "https://[::1]:7745/");
    EXPECT_EQ(page_of(welcome(80, "192.0.2.1"), {.host = "lab"}, false), "http://192.0.2.1:80/");
    EXPECT_EQ(page_of(welcome(0), {.host = "lab"}, false), "");
}

TEST(PageLink, NamesOnlyHosts) {
    for (const char* host : {"\x1b]8;;x\x07", "a/b", "a@b", "lab?", "\u202elab", "a b"}) {
        EXPECT_EQ(page_of(welcome(7745, host), {.host = "lab"}, false), "") << host;
    }
    for (const char* text : {"\x1b[2J", "a b", "a#b", "\u202ea"}) {
        EXPECT_FALSE(fits_into_url(text)) << text;
    }
    EXPECT_TRUE(fits_into_url("default@1"));
}

TEST(PageLink, SaysIfThePageIsAtAnotherHost) {
    EXPECT_EQ(other_page_host(welcome(7745), {.host = "lab"}), "");
    EXPECT_EQ(other_page_host(welcome(7745, "lab"), {.host = "lab"}), "");
    EXPECT_EQ(other_page_host(welcome(7745, "127.0.0.1"), {.host = "localhost"}), "");
    EXPECT_EQ(other_page_host(welcome(7745, "127.0.0.1"), {.host = "lab"}), "127.0.0.1");
    EXPECT_EQ(other_page_host(welcome(7745, "127.example.org"), {.host = "localhost"}), "127.example.org");
    EXPECT_EQ(other_page_host(welcome(7745, "192.0.2.1"), {.host = "lab"}), "192.0.2.1");
}

TEST(PageLink, ContainsAMoment) {
    const std::string page = "http://lab:7745/";
    EXPECT_EQ(link_of(page, {.world = "default"}), page + "#world=default");
    EXPECT_EQ(link_of(page, {.world = "a", .generation = 12, .tick = 600, .island = 1, .organism = 7}),
              page + "#world=a&generation=12&tick=600&island=1&organism=7");
    EXPECT_EQ(link_of(page, {.world = "a", .generation = 12}), page + "#world=a&generation=12&tick=0");
    EXPECT_EQ(link_of(page, {.world = "a", .organism = 0}), page + "#world=a&island=0&organism=0");
}

TEST(PageLink, ReportsLinksThatLeadToThisMachineOnly) {
    for (const char* link : {"http://localhost:7745/#join=A", "https://127.0.0.1/", "http://[::1]:7745/#join=A"}) {
        EXPECT_TRUE(is_of_this_machine(link)) << link;
    }
    for (const char* link : {"http://lab:7745/#join=localhost", "https://127.example/", "http://[::2]/", "", "x"}) {
        EXPECT_FALSE(is_of_this_machine(link)) << link;
    }
}

TEST(PageLink, OfAReplayNamesItsOriginal) {
    evod::v1::WorldInfo world;
    world.set_name("default");
    world.set_generation(3);
    world.set_generation_tick(40);
    world.set_tick(5000);
    EXPECT_EQ(link_of("", moment_of(world)), "#world=default&generation=3&tick=40");
    world.set_name("default.replay");
    world.mutable_replay()->set_replay_of("default");
    EXPECT_EQ(moment_of(world).world, "default");
    world.mutable_replay()->set_replay_of(""); // evod replay
    EXPECT_EQ(moment_of(world).world, "default.replay");
}

} // namespace
} // namespace evod::core
