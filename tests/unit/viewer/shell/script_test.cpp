#include "client/viewer/shell/script.h"

#include <gmock/gmock.h>

#include <deque>
#include <fstream>
#include <iterator>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using Kind = MarkedWidget::Kind;
using testing::HasSubstr;
using testing::Not;

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
    std::vector<const MarkedWidget*> find(const std::string& name) const override {
        std::vector<const MarkedWidget*> found;
        for (const MarkedWidget& widget : widgets) {
            if (widget.name == name || widget.full_name() == name) {
                found.push_back(&widget);
            }
        }
        return found;
    }
    std::string absence(const std::string& name) const override { return name == "Play" ? "Play is in the page" : ""; }
    void reveal(const std::string& widget) override { done.push_back("reveal " + widget); }
    unsigned hovered() const override { return under_mouse; }
    bool covered() const override { return false; }
    std::optional<std::string> typed_text() const override { return field; }
    std::string key_problem() const override { return problem; }
    std::optional<Point> locate(const Script::IslandPlace& place) const override {
        return place.organism == 12u ? std::optional{Point{7, 8}} : std::nullopt;
    }
    std::optional<std::uint32_t> selected() const override { return organism; }
    const ViewedWorld* world() const override { return nullptr; }
    std::string save(const std::string& path) override {
        done.push_back("save " + path);
        return writable ? "" : "could not write " + path;
    }
    void close() override { done.push_back("close"); }

    MarkedWidget& add(const std::string& name, Point centre, MarkedWidget::Kind kind = MarkedWidget::Kind::Other) {
        under_mouse = static_cast<unsigned>(widgets.size()) + 1;
        widgets.push_back({.kind = kind, .name = name, .place = {centre.x, centre.y, 0, 0}, .id = under_mouse});
        return widgets.back();
    }

    std::deque<MarkedWidget> widgets;
    unsigned under_mouse = 0;
    std::optional<std::string> field; // the text of the field with the keyboard focus
    std::string problem;
    std::optional<std::uint32_t> organism;
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
    EXPECT_EQ(fault("actions -1"), "1: word 2: got \"-1\", allowed a whole number");
    EXPECT_THAT(fault("drag fast at 0,0"), HasSubstr("The panel Freezer is in the browser page"));
    EXPECT_THAT(fault("click right/at 0.5,0.5"), HasSubstr("two worlds side by side are in the browser page"));
    EXPECT_EQ(fault("click organism x"), "1: word 3: got \"x\", allowed a whole number");
    for (const char* place : {"0.5", "0.5,", "1.1,0", "0,-0.1", "nan,0"}) {
        EXPECT_THAT(fault(std::string{"click at "} + place), HasSubstr("allowed two numbers from 0 to 1")) << place;
    }
}

TEST_F(ScriptTest, SendsKeysWithTheirModifiersAndSignsAsText) {
    auto script = Script::parse("key F4\nkey Ctrl+A\nkey +").value();
    EXPECT_EQ(advance(script, 6), "");
    using Key = sf::Keyboard;
    const auto name = [](Key::Key key) { return std::to_string(key); };
    EXPECT_THAT(actor.done,
                ElementsAre("press " + name(Key::F4), "release " + name(Key::F4),
                            "press " + name(Key::LControl) + " control", "press " + name(Key::A) + " control",
                            "release " + name(Key::A), "release " + name(Key::LControl), "text 43"));
    EXPECT_TRUE(script.done());
}

TEST_F(ScriptTest, AKeyWithoutEffectFails) {
    auto script = Script::parse("key F11").value();
    actor.problem = "This key shows no panel";
    EXPECT_EQ(advance(script, 2), "1: key F11: This key shows no panel");
}

TEST_F(ScriptTest, AWidgetOfThePageFailsAtOnce) {
    for (const std::string line : {"click Play", "set Play 1", "menu Play", "wait widget Play", "wait gone Play"}) {
        auto script = Script::parse(line).value();
        EXPECT_EQ(advance(script, 1), "1: " + line + ": Play is in the page");
    }
    actor.add("Play", {1, 2});
    auto script = Script::parse("wait widget Play").value();
    EXPECT_EQ(advance(script, 1), "") << "a widget with this name is on the screen";
}

TEST_F(ScriptTest, AClickWaitsForItsWidgetAndMovesThereFirst) {
    auto script = Script::parse("click \"Run generations\"").value();
    EXPECT_EQ(advance(script, 3), "");
    EXPECT_TRUE(actor.done.empty());
    actor.add("Run generations", {30, 40});
    EXPECT_EQ(advance(script, 1), "");
    EXPECT_THAT(actor.done, ElementsAre("to 30 40"));
    EXPECT_EQ(advance(script, 1), "");
    EXPECT_THAT(actor.done, ElementsAre("to 30 40", "to 30 40", "down", "up"));
}

TEST_F(ScriptTest, ATimeoutNamesTheLineAndTheReason) {
    auto script = Script::parse("timeout 5\n\nclick Apply").value();
    EXPECT_EQ(advance(script, 1), "");
    now += std::chrono::seconds{5};
    EXPECT_EQ(advance(script, 1), "");
    now += std::chrono::seconds{1};
    EXPECT_EQ(advance(script, 1), "3: click Apply: not done within 5 s: no widget \"Apply\" is on the screen");
}

/// Plays one line until its time limit has passed. Returns the error.
std::string expire(Actor& actor, const std::string& line) {
    auto script = Script::parse("timeout 5\n" + line).value();
    for (int s = 0; s < 20; ++s) {
        if (const auto advanced = script.advance(actor, Script::Clock::time_point{std::chrono::seconds{s}});
            !advanced) {
            return advanced.error().what;
        }
    }
    return "";
}

TEST_F(ScriptTest, ADisabledWidgetFailsWithItsNote) {
    MarkedWidget& apply = actor.add("Apply", {1, 2});
    apply.enabled = false;
    apply.note = "There are no edits";
    EXPECT_EQ(expire(actor, "click Apply"),
              "2: click Apply: not done within 5 s: \"Apply\" is disabled: There are no edits");
    EXPECT_TRUE(actor.done.empty());
    EXPECT_EQ(expire(actor, "wait disabled Apply"), "");
    apply.enabled = true;
    EXPECT_EQ(expire(actor, "click Apply"), "");
    EXPECT_THAT(expire(actor, "wait disabled Apply"), HasSubstr("the condition does not hold"));
}

TEST_F(ScriptTest, ATextOrACoveredWidgetTakesNoClick) {
    actor.add("Revision 1", {1, 2});
    actor.under_mouse = 0;
    EXPECT_THAT(expire(actor, "click \"Revision 1\""), HasSubstr("does not react to clicks, or is covered"));
    actor.under_mouse = 7;
    EXPECT_THAT(expire(actor, "click \"Revision 1\""), HasSubstr("is covered"));
    EXPECT_THAT(actor.done, Not(testing::Contains("down")));
}

TEST_F(ScriptTest, AnAmbiguousNameListsTheFullNames) {
    actor.add("Pause", {1, 2}).panel = "Sidebar";
    actor.add("Pause", {3, 4}).panel = "left";
    EXPECT_EQ(expire(actor, "click Pause"),
              "2: click Pause: 2 widgets have the name \"Pause\": Sidebar/Pause, left/Pause");
    EXPECT_EQ(expire(actor, "click left/Pause"), "");
}

TEST_F(ScriptTest, AWidgetOutOfSightIsScrolledToOnce) {
    actor.add("seed", {1, 200}).visible = false;
    auto script = Script::parse("click seed\nactions 1").value();
    EXPECT_EQ(advance(script, 2), "");
    EXPECT_THAT(actor.done, ElementsAre("reveal seed", "reveal seed"));
    actor.widgets.front().visible = true;
    EXPECT_EQ(advance(script, 3), "2: actions 1: 2 actions were needed");
}

TEST_F(ScriptTest, TypingNeedsAFieldThatAcceptsTheText) {
    EXPECT_THAT(expire(actor, "type 12"), HasSubstr("no field has the keyboard focus"));
    actor.field = "12";
    EXPECT_EQ(expire(actor, "type 12"), "");
    EXPECT_THAT(expire(actor, "type x"), HasSubstr("the field contains \"12\""));
}

TEST_F(ScriptTest, SettingReplacesTheTextOfAField) {
    actor.add("seed", {1, 2}, Kind::Field).value = "é";
    actor.field = "é";
    auto script = Script::parse("set seed é\nactions 2").value();
    EXPECT_EQ(advance(script, 5), "");
    EXPECT_EQ(actor.done[10], "text 233") << "one character, after Ctrl+A";
    EXPECT_EQ(actor.done[11], "press " + std::to_string(sf::Keyboard::Enter));
    EXPECT_EQ(advance(script, 2), "2: actions 2: 3 actions were needed") << "a click, a text, Enter";
}

TEST_F(ScriptTest, AFieldMustEndWithTheValue) {
    MarkedWidget& ticks = actor.add("ticks", {1, 2}, Kind::Field);
    EXPECT_THAT(expire(actor, "set ticks 7"), HasSubstr("\"ticks\" is not a field"));
    actor.field = "7";
    EXPECT_THAT(expire(actor, "set ticks 7x"), HasSubstr("does not accept this text; it contains \"7\""));
    ticks.value = "1";
    EXPECT_THAT(expire(actor, "set ticks 7"), HasSubstr("\"ticks\" is \"1\""));
    ticks.value = "7.0";
    EXPECT_EQ(expire(actor, "set ticks 7"), "") << "equal numbers";
}

TEST_F(ScriptTest, SettingACheckBoxClicksOnlyToChangeIt) {
    actor.add("TLS", {1, 2}, Kind::CheckBox).value = "on";
    EXPECT_EQ(expire(actor, "set TLS on"), "");
    EXPECT_THAT(actor.done, ElementsAre("to 1 2"));
    EXPECT_THAT(expire(actor, "set TLS off"), HasSubstr("\"TLS\" is \"on\"")) << "the click did not switch it";
    EXPECT_THAT(actor.done, testing::Contains("down"));
    EXPECT_THAT(expire(actor, "set TLS yes"), HasSubstr("got \"yes\", allowed on, off"));
}

TEST_F(ScriptTest, SettingADropDownOpensItAndChooses) {
    MarkedWidget& selection = actor.add("selection", {1, 2}, Kind::DropDown);
    auto script = Script::parse("timeout 5\nset selection tournament\nactions 2\nquit").value();
    EXPECT_EQ(advance(script, 4), "");
    EXPECT_THAT(actor.done, ElementsAre("to 1 2", "to 1 2", "down", "up")) << "waits for its choices";
    actor.done.clear();
    selection.choices = {"roulette", "tournament"};
    actor.add("selection: tournament", {1, 40});
    EXPECT_EQ(advance(script, 2), "");
    actor.widgets.clear(); // a choice may remove the drop-down
    EXPECT_EQ(advance(script, 4), "");
    EXPECT_THAT(actor.done, ElementsAre("to 1 40", "to 1 40", "down", "up", "close"));
}

TEST_F(ScriptTest, AMissingChoiceEndsWithTheChoices) {
    actor.add("selection", {1, 2}, Kind::DropDown).choices = {"roulette", "tournament"};
    EXPECT_EQ(expire(actor, "set selection turnament"), "2: set selection turnament: not done within 5 s: "
                                                        "\"selection\" offers roulette, tournament");
}

TEST_F(ScriptTest, AClickOnAnOrganismMustSelectIt) {
    actor.organism = 12;
    EXPECT_EQ(expire(actor, "click organism 12"), "");
    EXPECT_THAT(actor.done, ElementsAre("to 7 8", "to 7 8", "down", "up"));
    actor.organism = 9;
    EXPECT_THAT(expire(actor, "click organism 12"), HasSubstr("the click has selected organism 9"));
    EXPECT_THAT(expire(actor, "click organism 3"), HasSubstr("organism 3 is not on the screen"));
    EXPECT_THAT(expire(actor, "click at 0.4,0.6"), HasSubstr("this place is not on the screen"));
}

TEST_F(ScriptTest, AFailedScreenshotEndsTheScript) {
    actor.writable = false;
    auto script = Script::parse("screenshot /no/such/out.png").value();
    EXPECT_EQ(advance(script, 1), "1: screenshot /no/such/out.png: could not write /no/such/out.png");
}

TEST_F(ScriptTest, WaitsForWidgetsToAppearAndDisappear) {
    actor.add("Apply", {1, 1});
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
