#include "server/experiments/lesson_texts.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::experiments {
namespace {

using testing::HasSubstr;

TEST(LessonTexts, OfAHandoutAreSafeAndHaveSpaceForPredictions) {
    Lesson lesson;
    lesson.title = "A < B";
    lesson.needs = "C";
    lesson.goals = {"D & E"};
    LessonStep step;
    step.title = "F";
    step.text = "One *two* **three** `four`.\n\n- <five>\n- six\n\nSeven";
    step.run = 9;
    step.predict = Prediction{.id = "x", .ask = "G?"};
    lesson.steps.push_back(step);
    step.predict = Prediction{.id = "y", .ask = "H?", .kind = Prediction::Kind::Curve};
    step.predict->x.label = "generation";
    lesson.steps.push_back(step);
    const std::string html = handout_of(lesson, "de");
    EXPECT_THAT(html, HasSubstr("<h1>A &lt; B</h1>"));
    EXPECT_THAT(html, HasSubstr("<li>D &amp; E</li>"));
    EXPECT_THAT(html, HasSubstr("<p>One <em>two</em> <strong>three</strong> <code>four</code>.</p>\n"
                                "<ul>\n<li>&lt;five&gt;</li>\n<li>six</li>\n</ul>\n<p>Seven</p>"));
    EXPECT_THAT(html, HasSubstr("Meine Vorhersage: </p>\n<p class=\"write\">"));
    EXPECT_THAT(html, HasSubstr("Lass die Welt laufen: 9 Generationen"));
    EXPECT_THAT(html, HasSubstr(">generation</text>"));
    EXPECT_THAT(handout_of(lesson, "en"), HasSubstr("My prediction"));
}

TEST(LessonTexts, OfAReportNameAFileThatCannotBeRead) {
    std::ostringstream out;
    EXPECT_THAT(to_text(write_report("/nonexistent/x.evod", out).error()), HasSubstr("/nonexistent/x.evod"));
    EXPECT_EQ(out.str(), "");
}

} // namespace
} // namespace evod::experiments
