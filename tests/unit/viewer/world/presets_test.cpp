#include "client/viewer/world/presets.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <string>

namespace evod::viewer {
namespace {

TEST(Presets, AreTheExperimentFiles) {
    std::vector<std::string_view> names;
    for (const Preset& preset : presets()) {
        names.push_back(preset.name);
        std::ifstream file{EVOD_SOURCE_FOLDER "/experiments/" + std::string{preset.name} + ".json"};
        const std::string text{std::istreambuf_iterator<char>{file}, {}};
        EXPECT_EQ(preset.json, text) << preset.name;
        EXPECT_THAT(text, testing::HasSubstr("\"description\": \"" + std::string{preset.description} + "\""));
    }
    EXPECT_THAT(names,
                testing::ElementsAre("default", "annealing", "brains", "classic", "islands", "rooy", "trade_offs"));
}

} // namespace
} // namespace evod::viewer
