#include "server/commands/curves_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>

namespace evod::commands {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<Curve> two_curves() {
    return {{"world", {{1, 10, 5, 15}, {2, 20, 15, 25}, {3, 40, 35, 45}}}, {"other", {{1, 10, 8, 12}, {3, 5, 3, 7}}}};
}

/// Every element is closed in order, and what stands in it is text without markup.
bool is_well_formed(const std::string& svg) {
    static const std::regex tag{"<(/?)([a-z]+)((?: [a-zA-Z0-9:-]+=\"[^\"<>]*\")*)(/?)>"};
    std::string rest = svg.substr(svg.find("?>") + 2);
    std::vector<std::string> open;
    std::smatch found;
    while (std::regex_search(rest, found, tag)) {
        const std::string before = found.prefix();
        if (before.find_first_of("<>") != std::string::npos) {
            return false;
        }
        if (found[1].length() > 0) {
            if (open.empty() || open.back() != found[2]) {
                return false;
            }
            open.pop_back();
        } else if (found[4].length() == 0) {
            open.push_back(found[2]);
        }
        rest = found.suffix();
    }
    return open.empty() && rest.find_first_of("<>") == std::string::npos;
}

TEST(CurvesPicture, IsWellFormedWhateverItSays) {
    std::vector<Curve> curves = two_curves();
    curves[1].name = "<a & \"b\">";
    const std::string svg =
        curves_picture({.title = "R & <D>", .subtitle = "x\ny", .x_label = "a>b", .y_label = "c\"d"}, curves);
    EXPECT_TRUE(svg.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "));
    EXPECT_TRUE(is_well_formed(svg)) << svg;
    EXPECT_THAT(svg, HasSubstr("&lt;a &amp; &quot;b&quot;&gt;"));
    EXPECT_THAT(svg, HasSubstr(">R &amp; &lt;D&gt;</title>"));
    EXPECT_FALSE(is_well_formed(svg + "</svg>"));
}

TEST(CurvesPicture, PutsEveryPointWhereItBelongs) {
    // x: 1 to 3 over 76 … 684 px. y: 3 to 45 and a twenty-fifth more at either end over 476 … 74 px, so 40 is at
    // 476 − (40 − 1.32)/45.36 · 402 = 133.2 and 10 at 399.07.
    const std::string svg = curves_picture({}, two_curves());
    EXPECT_THAT(svg, HasSubstr("<polyline points=\"76,399.07 380,310.45 684,133.2\" fill=\"none\""));
    // The band goes along the upper bounds and back along the lower.
    EXPECT_THAT(svg, HasSubstr("<polygon points=\"76,354.76 380,266.14 684,88.89 684,177.51 380,354.76 76,443.39\""));
    // The first is drawn last, so that it lies above, and is in the legend first.
    EXPECT_LT(svg.find("stroke=\"#d55e00\""), svg.find("stroke=\"#0072b2\""));
    EXPECT_LT(svg.find(">world</text>"), svg.find(">other</text>"));
}

TEST(CurvesPicture, OfOneFlatCurveHasAnAxis) {
    const std::string svg = curves_picture({}, std::vector<Curve>{{"flat", {{1, 7, 7, 7}, {2, 7, 7, 7}}}});
    EXPECT_TRUE(is_well_formed(svg));
    EXPECT_THAT(svg, HasSubstr("<polyline points=\"76,275 684,275\""));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, HasSubstr(">7</text>"));
}

TEST(CurvesPicture, TellsThirtyCurvesApart) {
    std::vector<Curve> curves;
    for (int i = 0; i < 30; ++i) {
        curves.push_back({"c" + std::to_string(i), {{1, 1.0 * i, 1.0 * i, 1.0 * i}, {2, 3, 3, 3}}});
    }
    const std::string svg = curves_picture({}, curves);
    std::vector<std::string> styles;
    const std::regex style{
        "<polyline [^>]* stroke=\"(#[0-9a-f]+)\" stroke-width=\"[0-9.]+\"( stroke-dasharray=\"[^\"]+\")?/>"};
    for (std::sregex_iterator i{svg.begin(), svg.end(), style}, end; i != end; ++i) {
        styles.push_back((*i)[1].str() + (*i)[2].str());
    }
    ASSERT_EQ(styles.size(), 30u);
    std::ranges::sort(styles);
    EXPECT_EQ(std::ranges::adjacent_find(styles), styles.end());
}

TEST(AxisTicks, AreRoundAndWithinTheAxis) {
    EXPECT_THAT(axis_ticks(1, 60, 9), ElementsAre(10, 20, 30, 40, 50, 60));
    EXPECT_THAT(axis_ticks(71.3, 204, 9), ElementsAre(80, 100, 120, 140, 160, 180, 200));
    EXPECT_THAT(axis_ticks(-3, 1, 5), ElementsAre(-3, -2, -1, 0, 1));
    EXPECT_THAT(axis_ticks(0, 1, 3), ElementsAre(0, DoubleNear(0.5, 1e-12), DoubleNear(1, 1e-12)));
    EXPECT_THAT(axis_ticks(0.1, 0.3, 3),
                ElementsAre(DoubleNear(0.1, 1e-12), DoubleNear(0.2, 1e-12), DoubleNear(0.3, 1e-12)));
    EXPECT_THAT(axis_ticks(-2e6, 3e6, 6), ElementsAre(-2e6, -1e6, 0, 1e6, 2e6, 3e6));
    EXPECT_THAT(axis_ticks(5, 5, 9), ElementsAre(5));
    for (const double width : {1e-6, 0.37, 1.0, 7.7, 123456.0}) {
        for (const double begin : {-1e3, -0.1, 0.0, 55.5}) {
            const std::vector<double> ticks = axis_ticks(begin, begin + width, 9);
            EXPECT_GE(ticks.size(), 2u) << begin << ' ' << width;
            EXPECT_LE(ticks.size(), 9u) << begin << ' ' << width;
            EXPECT_GE(ticks.front(), begin - width * 1e-6);
            EXPECT_LE(ticks.back(), begin + width * (1 + 1e-6));
        }
    }
}

} // namespace
} // namespace evod::commands
