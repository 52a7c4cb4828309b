#include "server/parameters/choice_help.h"
#include "server/parameters/model_parameters.h"

#include <gmock/gmock.h>

namespace evod::parameters {
namespace {

TEST(ChoiceHelp, EveryChoiceOfTheRegistryHasASentence) {
    for (const ParameterDescription& description : parameter_registry()) {
        const auto* choice = std::get_if<ChoiceParameter>(&description.kind);
        for (const std::string_view name : choice == nullptr ? std::span<const std::string_view>{} : choice->names) {
            EXPECT_THAT(std::string{choice_help(description.name, name)}, testing::EndsWith("."))
                << description.name << "=" << name;
        }
    }
}

TEST(ChoiceHelp, AnUnknownChoiceHasNoSentence) {
    EXPECT_EQ(choice_help("selection", "nearer"), "");
    EXPECT_EQ(choice_help("mutation_chance", ""), "");
}

} // namespace
} // namespace evod::parameters
