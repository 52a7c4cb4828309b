#include "client/viewer/panels/page_panels.h"

#include <algorithm>
#include <iterator>
#include <span>

namespace evod::viewer {

namespace {

// The widgets that no other panel of evoview has. Of a name that ends in a space or a slash, the begin
// decides.
constexpr std::string_view glass_box_widgets[] = {
    "Generation", "Play the picks", "Show its picks", "birth of the selected organism",
    "the newest", "bet first",      "play each",      "hold the world",
    "steps/s",    "step",           "score",          "hits so far",
    "Step",       "Theory",         "Pick ",          "bet on ",
    "Why ",
};
constexpr std::string_view family_widgets[] = {"tree", "tree of generation ", "colour the island by lineage, too"};
constexpr std::string_view plots_widgets[] = {
    "running mean",
    "compare",
    "compare: ",
    "gene",
    "group",
    "living only",
    "Save CSV",
    "Save PNG",
    "image width",
    "image height",
    "path of another CSV file",
};

constexpr std::string_view physics_widgets[] = {
    "Bodies of this island",      "Effect of the tick length", "a spring", "damped motion", "tick, ms",
    "use the tick of this world",
};

constexpr std::string_view freezer_widgets[] = {"Freeze the population", "Thaw", "Delete the file"};
constexpr std::string_view organism_widgets[] = {"Network", "Go to parent ", "Freeze", "Organism/Freeze"};
constexpr std::string_view worlds_widgets[] = {"New …",    "New world …",        "New world/",
                                               "Delete …", "Worlds/New world …", "Worlds/Delete …"};

struct PagePanel {
    std::string_view tab;
    unsigned function_key; // of evoview; 0: evoview has this panel, too, without these widgets
    std::span<const std::string_view> widgets;
};
constexpr PagePanel page_panels[] = {
    {"Glass box", 8, glass_box_widgets}, {"Family tree", 11, family_widgets}, {"Plots", 7, plots_widgets},
    {"Physics", 9, physics_widgets},     {"Freezer", 10, freezer_widgets},    {"Organism", 0, organism_widgets},
    {"Worlds", 0, worlds_widgets},
};

bool has(const PagePanel& panel, std::string_view widget) {
    constexpr std::string_view tabs = "Tabs/";
    widget.remove_prefix(widget.starts_with(tabs) ? tabs.size() : 0);
    const bool named =
        widget == panel.tab || (widget.starts_with(panel.tab) && widget.substr(panel.tab.size()).starts_with('/'));
    return (named && panel.function_key != 0) || std::ranges::any_of(panel.widgets, [&](std::string_view name) {
               return name.ends_with(' ') || name.ends_with('/') ? widget.starts_with(name) : widget == name;
           });
}

} // namespace

std::string_view page_panel_at(unsigned function_key) {
    const auto* found = std::ranges::find(page_panels, function_key, &PagePanel::function_key);
    return found == std::end(page_panels) ? std::string_view{} : found->tab;
}

std::string_view page_panel_with(std::string_view widget) {
    const auto* found = std::ranges::find_if(page_panels, [&](const PagePanel& panel) { return has(panel, widget); });
    return found == std::end(page_panels) ? std::string_view{} : found->tab;
}

std::string way_to_page(std::string_view link) {
    return link.empty() ? "start evod with --web, open the page" : "open " + std::string{link};
}

std::string where_in_page(std::string_view panel, std::string_view link) {
    const std::string name{panel};
    return "The panel " + name + " is in the browser page: " + way_to_page(link) + " and choose " + name;
}

} // namespace evod::viewer
