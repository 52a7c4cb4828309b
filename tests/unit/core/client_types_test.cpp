#include "client/core/client_types.h"

#include <gmock/gmock.h>

namespace evod::core {
namespace {

TEST(ClientTypes, ARefusalIsTheMessageOfTheServer) {
    v1::Status status;
    status.set_code(v1::CODE_NOT_FOUND);
    status.set_message("no such island\n  pause.island: got 9, allowed 0 to 7");
    status.add_violations()->set_field("pause.island");
    EXPECT_EQ(to_text(status), status.message());
    EXPECT_EQ(to_text(status, [](std::string_view path) { return std::string{path.substr(path.find('.') + 1)}; }),
              "no such island\n  island: got 9, allowed 0 to 7");
    status.clear_message();
    EXPECT_EQ(to_text(status), "CODE_NOT_FOUND");
}

TEST(ClientTypes, AnEventIsTheTextOfTheServer) {
    v1::Event event;
    event.mutable_events_dropped()->set_dropped_count(3);
    EXPECT_THAT(to_text(event), testing::StartsWith("events_dropped")) << "from an older server, or the client itself";
    event.set_text("3 events were dropped");
    EXPECT_EQ(to_text(event), "3 events were dropped");
}

TEST(ClientTypes, AProblemOfTheDiskIsTheTextOfTheServer) {
    v1::Storage storage;
    EXPECT_EQ(to_text(storage), "");
    storage.set_reason("the disk is full");
    EXPECT_EQ(to_text(storage), "the disk is full") << "from an older server";
    storage.set_text("worlds wait: the disk is full");
    EXPECT_EQ(to_text(storage), "worlds wait: the disk is full");
}

} // namespace
} // namespace evod::core
