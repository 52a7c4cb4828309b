#include "client/viewer/shell/script.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <map>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Records what the script does.
struct Actor : Script::Host {
    void send(const sf::Event& event) override {
        switch (event.type) {
        case sf::Event::KeyPressed:
            done.push_back("press " + std::to_string(event.key.code) + (event.key.control ? " control" : ""));
            break;
        case sf::Event::KeyReleased:
            done.push_back("release " + std::to_string(event.key.code));
            break;
        case sf::Event::TextEntered:
            done.push_back("text " + std::to_string(event.text.unicode));
            break;
        case sf::Event::MouseMoved:
            done.push_back("to " + std::to_string(event.mouseMove.x) + " " + std::to_string(event.mouseMove.y));
            break;
        case sf::Event::MouseButtonPressed:
            done.push_back("down");
            break;
        case sf::Event::MouseButtonReleased:
            done.push_back("up");
            break;
        default:
            done.push_back("?");
        }
    }
    std::optional<Point> find(const std::string& widget) const override {
        const auto found = widgets.find(widget);
        return found == widgets.end() ? std::nullopt : std::optional{found->second};
    }
    const std::vector<std::string>* choices(const std::string& widget) const override {
        const auto found = drop_downs.find(widget);
        return found == drop_downs.end() ? nullptr : &found->second;
    }
    const ViewedWorld* world() const override { return nullptr; }
    std::string save(const std::string& path) override {
        done.push_back("save " + path);
        return writable ? "" : "could not write " + path;
    }
    void close() override { done.push_back("close"); }

    std::map<std::string, Point> widgets;
    std::map<std::string, std::vector<std::string>> drop_downs;
    bool writable = true;
    std::vector<std::string> done;
};

std::string fault(std::string_view text) {
    const auto script = Script::parse(text);
    return script ? "" : script.error().what;
}

struct ScriptTest : testing::Test {
    Script::Clock::time_point now{};
    Actor actor;
    /// Advances `times` steps. Returns the text of an error, or an empty text.
    std::string advance(Script& script, int times) {
        for (int i = 0; i < times; ++i) {
            if (const auto advanced = script.advance(actor, now); !advanced) {
                return advanced.error().what;
            }
        }
        return "";
    }
};

TEST_F(ScriptTest, ErrorsNameLineWordAndAllowedWords) {
    EXPECT_EQ(fault("\n# well\nkey Space # fine\n"), "");
    EXPECT_THAT(fault("key Space\nclik Apply"), testing::StartsWith("2: word 1: got \"clik\", allowed key, "));
    EXPECT_THAT(fault("key Spade"), testing::StartsWith("1: word 2: got \"Spade\", allowed a key"));
    EXPECT_THAT(fault("key F13"), HasSubstr("word 2"));
    EXPECT_EQ(fault("set mutation_chance"), "1: word 3 is missing: set NAME TEXT");
    EXPECT_THAT(fault("click mutation chance"),
                testing::StartsWith("1: word 3: got \"chance\", allowed no more words"));
    EXPECT_THAT(fault("wait genration 2"), HasSubstr("word 2: got \"genration\", allowed connected, "));
    EXPECT_EQ(fault("wait generation two"), "1: word 3: got \"two\", allowed a whole number");
    EXPECT_EQ(fault("wait generation"), "1: word 3 is missing: wait generation N");
    EXPECT_THAT(fault("wait state asleep"), HasSubstr("allowed waiting, running, paused, ended"));
    EXPECT_THAT(fault("wait snapshot now"), HasSubstr("word 3: got \"now\""));
    EXPECT_THAT(fault("click \"Apply"), testing::StartsWith("1: word 2: the quote is not closed"));
    EXPECT_THAT(fault("timeout 0"), HasSubstr("word 2: got \"0\", allowed more than 0"));
    EXPECT_THAT(fault("quit now"), HasSubstr("word 2"));
}

TEST_F(ScriptTest, SendsKeysWithTheirModifiersAndSignsAsText) {
    auto script = Script::parse("key F4\nkey Ctrl+A\nkey +").value();
    EXPECT_EQ(advance(script, 3), "");
    using Key = sf::Keyboard;
    const auto name = [](Key::Key key) { return std::to_string(key); };
    EXPECT_THAT(actor.done,
                ElementsAre("press " + name(Key::F4), "release " + name(Key::F4),
                            "press " + name(Key::LControl) + " control", "press " + name(Key::A) + " control",
                            "release " + name(Key::A), "release " + name(Key::LControl), "text 43"));
    EXPECT_TRUE(script.done());
}

TEST_F(ScriptTest, AClickWaitsForItsWidgetAndMovesThereFirst) {
    auto script = Script::parse("click \"Run generations\"").value();
    EXPECT_EQ(advance(script, 3), "");
    EXPECT_TRUE(actor.done.empty());
    actor.widgets["Run generations"] = {30, 40};
    EXPECT_EQ(advance(script, 1), "");
    EXPECT_THAT(actor.done, ElementsAre("to 30 40"));
    EXPECT_EQ(advance(script, 1), "");
    EXPECT_THAT(actor.done, ElementsAre("to 30 40", "down", "up"));
}

TEST_F(ScriptTest, ATimeoutNamesTheLine) {
    auto script = Script::parse("timeout 5\n\nclick Apply").value();
    EXPECT_EQ(advance(script, 1), "");
    now += std::chrono::seconds{5};
    EXPECT_EQ(advance(script, 1), "");
    now += std::chrono::seconds{1};
    EXPECT_EQ(advance(script, 1), "3: click Apply: not done within 5 s");
}

TEST_F(ScriptTest, SettingReplacesTheTextOfAField) {
    actor.widgets["seed"] = {1, 2};
    auto script = Script::parse("set seed é").value();
    for (std::size_t steps = 0; !script.done(); ++steps) {
        ASSERT_LT(steps, 5u);
        ASSERT_EQ(advance(script, 1), "");
    }
    ASSERT_EQ(actor.done.size(), 12u);
    EXPECT_EQ(actor.done[9], "text 233") << "one character, after Ctrl+A";
    EXPECT_EQ(actor.done[10], "press " + std::to_string(sf::Keyboard::Enter));
}

TEST_F(ScriptTest, SettingADropDownOpensItAndChooses) {
    actor.widgets["selection"] = {1, 2};
    actor.drop_downs["selection"] = {};
    auto script = Script::parse("timeout 5\nset selection tournament\nquit").value();
    EXPECT_EQ(advance(script, 4), "");
    EXPECT_THAT(actor.done, ElementsAre("to 1 2", "down", "up")) << "waits for its choices";
    actor.drop_downs["selection"] = {"roulette", "tournament"};
    actor.widgets["selection: tournament"] = {1, 40};
    EXPECT_EQ(advance(script, 2), "");
    actor.drop_downs.clear(); // a choice may remove the drop-down
    EXPECT_EQ(advance(script, 2), "");
    EXPECT_THAT(actor.done, ElementsAre("to 1 2", "down", "up", "to 1 40", "down", "up", "close"));
}

TEST_F(ScriptTest, AMissingChoiceEndsWithTheChoices) {
    actor.widgets["selection"] = {1, 2};
    actor.drop_downs["selection"] = {"roulette", "tournament"};
    auto script = Script::parse("timeout 5\nset selection turnament").value();
    EXPECT_EQ(advance(script, 3), "");
    now += std::chrono::seconds{6};
    EXPECT_EQ(advance(script, 1), "2: set selection turnament: not done within 5 s; "
                                  "\"selection\" offers roulette, tournament");
}

TEST_F(ScriptTest, AFailedScreenshotEndsTheScript) {
    actor.writable = false;
    auto script = Script::parse("screenshot /no/such/out.png").value();
    EXPECT_EQ(advance(script, 1), "1: screenshot /no/such/out.png: could not write /no/such/out.png");
}

TEST_F(ScriptTest, WaitsForWidgetsToAppearAndDisappear) {
    actor.widgets["Apply"] = {1, 1};
    auto script = Script::parse("wait widget Apply\nwait gone Apply\nquit").value();
    EXPECT_EQ(advance(script, 4), "");
    EXPECT_TRUE(actor.done.empty());
    actor.widgets.clear();
    EXPECT_EQ(advance(script, 2), "");
    EXPECT_THAT(actor.done, ElementsAre("close"));
}

TEST_F(ScriptTest, TheDocumentationListsEveryVerbAndCondition) {
    std::ifstream file{EVOD_SOURCE_FOLDER "/docs/VIEWER.md"};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    EXPECT_THAT(text, HasSubstr(Script::reference()));
}

} // namespace
} // namespace evod::viewer
