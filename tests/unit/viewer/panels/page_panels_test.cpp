#include "client/viewer/panels/page_panels.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(PagePanels, HaveTheKeysThatPanelsHadInEvoview) {
    EXPECT_EQ(page_panel_at(7), "Plots");
    EXPECT_EQ(page_panel_at(8), "Glass box");
    EXPECT_EQ(page_panel_at(4), "");
}

TEST(PagePanels, AreFoundByTheirWidgets) {
    for (const char* widget :
         {"Glass box/Play", "Tabs/Glass box", "Glass box", "hold the world", "bet on 43", "Why 45?"}) {
        EXPECT_EQ(page_panel_with(widget), "Glass box") << widget;
    }
    EXPECT_EQ(page_panel_with("Tabs/Plots"), "Plots");
    EXPECT_EQ(page_panel_with("compare: world second"), "Plots");
    EXPECT_EQ(page_panel_with("tree of generation 4"), "Family tree");
    EXPECT_EQ(page_panel_with("Go to parent 12"), "Organism");
    EXPECT_EQ(page_panel_with("Organism/keep it centred (L)"), "") << "evoview has it, too";
    for (const char* widget : {"Play", "left/generation", "Glass boxes", "Step ticks", "Parameters/Apply", ""}) {
        EXPECT_EQ(page_panel_with(widget), "") << widget;
    }
}

TEST(PagePanels, LeadToThePageOrToTheOptionThatServesIt) {
    EXPECT_EQ(where_in_page("Glass box", "http://lab:7745/#world=default"),
              "The panel Glass box is in the browser page: open http://lab:7745/#world=default and choose Glass box");
    EXPECT_EQ(where_in_page("Glass box", ""),
              "The panel Glass box is in the browser page: start evod with --web, open the page and choose Glass box");
}

} // namespace
} // namespace evod::viewer
