#include "server/protocol/public_text.h"

#include "server/protocol/refusals.h"
#include "server/protocol/worlds.h"

#include <gtest/gtest.h>

namespace evod::protocol {
namespace {

TEST(PublicText, NamesFilesWithoutTheirFolder) {
    hide_folder("/srv/the lab/");
    hide_folder("/srv/the lab/inner");
    hide_folder("runs");
    EXPECT_EQ(public_text("/srv/the lab/w.evod is damaged; enter evod verify /srv/the lab/w.evod"),
              "w.evod is damaged; enter evod verify w.evod");
    EXPECT_EQ(public_text("\"/srv/the lab//w.evod-wal\": no such file"), "\"w.evod-wal\": no such file");
    EXPECT_EQ(public_text("/srv/the lab/inner/w.evod"), "w.evod");
    EXPECT_EQ(public_text("cannot list /srv/the lab: denied"), "cannot list the data folder: denied");
    EXPECT_EQ(public_text("cannot list /srv/the lab/"), "cannot list the data folder");
    EXPECT_EQ(public_text("runs/w.evod exists already"), "w.evod exists already");
}

TEST(PublicText, KeepsWhatIsNotOfAHiddenFolder) {
    hide_folder("/srv/the lab");
    hide_folder("runs");
    hide_folder("/");
    hide_folder("");
    for (const char* const text : {"runs cannot be written", "/srv/the laboratory/w.evod", "/x/srv/the lab/w",
                                   "reruns/w.evod", "/ is a folder", "allowed 0 to 1", ""}) {
        EXPECT_EQ(public_text(text), text);
    }
}

TEST(PublicText, IsWhatClientsRead) {
    hide_folder("/srv/data");
    const std::string text = "/srv/data/w.evod is damaged";
    EXPECT_EQ(to_proto(refusal(base::RefusalCode::DataLoss, text)).message(), "w.evod is damaged");
    EXPECT_EQ(to_proto(simulation::Storage{simulation::StorageState::Failing, text}).reason(), "w.evod is damaged");
    EXPECT_EQ(to_proto(simulation::DamagedWorld{.name = "w", .run_id = {}, .reason = text}).reason(),
              "w.evod is damaged");
}

} // namespace
} // namespace evod::protocol
