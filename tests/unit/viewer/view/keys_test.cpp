#include "client/viewer/view/keys.h"

#include <gmock/gmock.h>

#include <set>
#include <tuple>

namespace evod::viewer {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using Key = sf::Keyboard;

sf::Event::KeyEvent event_of(const KeyBinding& binding) {
    sf::Event::KeyEvent event{};
    event.code = binding.key;
    event.control = binding.control;
    event.shift = binding.shift;
    return event;
}

testing::Matcher<HelpLine> line(const std::string& keys, const std::string& text) {
    return AllOf(Field(&HelpLine::keys, keys), Field(&HelpLine::text, text));
}

TEST(Keys, EveryKeyOfTheTableReturnsItsAction) {
    std::set<std::tuple<Key::Key, char, bool, bool>> strokes;
    for (const KeyBinding& binding : key_bindings()) {
        const auto asked =
            binding.sign != 0 ? action_of_sign(static_cast<sf::Uint32>(binding.sign)) : action_of(event_of(binding));
        EXPECT_EQ(asked, binding.action) << binding.help;
        EXPECT_TRUE(strokes.emplace(binding.key, binding.sign, binding.control, binding.shift).second) << binding.help;
        EXPECT_TRUE(binding.sign != 0 || !name_of(binding.key).empty()) << "the key needs a name in the help";
    }
}

TEST(Keys, EveryActionHasAKeyAndAHelpLine) {
    std::set<Action> with_help;
    std::optional<Action> before;
    for (const KeyBinding& binding : key_bindings()) {
        if (!binding.help.empty()) {
            EXPECT_TRUE(with_help.insert(binding.action).second) << binding.help;
        } else {
            EXPECT_EQ(before, binding.action) << "it is listed in the line of the action before";
        }
        before = binding.action;
    }
    EXPECT_EQ(with_help.size(), static_cast<std::size_t>(Action::FirstPanel));
}

TEST(Keys, TheHelpListsTheKeysOfAnActionInOneLine) {
    const auto lines = help_lines();
    EXPECT_THAT(lines, Contains(line("Shift+Tab   Page Up", "previous island")));
    EXPECT_THAT(lines, Contains(line("H   F1   ?", "show or hide this help")));
}

TEST(Keys, TheHelpListsThePanelsAndTheirKeys) {
    const auto lines = help_lines(Panels{});
    EXPECT_THAT(lines, Contains(line("F2", "show the panel Worlds")));
}

} // namespace
} // namespace evod::viewer
