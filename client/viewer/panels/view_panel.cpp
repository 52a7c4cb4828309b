#include "client/viewer/panels/view_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/island/legend.h"

#include <imgui.h>

#include <array>
#include <string>
#include <string_view>

namespace evod::viewer {

namespace {

/// Builds a drop-down for one of the values with these names.
template <class Value, std::size_t Count>
bool choose(const char* label, const std::array<std::string_view, Count>& names, Value& value) {
    bool changed = false;
    if (widgets::begin_drop_down(label, std::string{names[static_cast<std::size_t>(value)]}.c_str())) {
        for (std::size_t i = 0; i < Count; ++i) {
            const bool chosen = static_cast<std::size_t>(value) == i;
            if (widgets::choice(label, std::string{names[i]}, chosen) && !chosen) {
                value = static_cast<Value>(i);
                changed = true;
            }
        }
        ImGui::EndCombo();
    }
    return changed;
}

void build_look(ViewOptions& options) {
    Look look = options.look;
    if (choose("skin", skin_names, look.skin)) {
        options = default_options(look);
    }
    if (look.skin == Skin::Vivid) {
        choose("background", background_names, options.look.background);
    }
}

void build_colouring(IslandView& island_view) {
    ViewOptions& shown = island_view.options;
    const auto& genes = island_view.gene_names();
    const auto name = [&](ColourBy by, std::size_t gene) -> std::string {
        switch (by) {
        case ColourBy::Gene:
            return gene < genes.size() ? "gene " + genes[gene] : "gene";
        case ColourBy::Health:
            return "health";
        default:
            return shown.look.skin == Skin::Vivid ? "nothing (shade: health)" : "nothing";
        }
    };
    constexpr const char* colouring = "colour by (C)";
    const auto choose = [&](ColourBy by, std::size_t gene) {
        const bool chosen = shown.colour_by == by && (by != ColourBy::Gene || shown.gene == gene);
        if (widgets::choice(colouring, name(by, gene), chosen)) {
            shown.colour_by = by;
            shown.gene = gene;
        }
    };
    if (widgets::begin_drop_down(colouring, name(shown.colour_by, shown.gene).c_str())) {
        choose(ColourBy::Nothing, shown.gene);
        choose(ColourBy::Health, shown.gene);
        for (std::size_t gene = 0; gene < genes.size(); ++gene) {
            choose(ColourBy::Gene, gene);
        }
        ImGui::EndCombo();
    }
    if (widgets::begin_drop_down("palette", std::string{palette::name_of(shown.ramp)}.c_str())) {
        for (const palette::Ramp ramp : palette::ramps) {
            if (widgets::choice("palette", std::string{palette::name_of(ramp)}, shown.ramp == ramp)) {
                shown.ramp = ramp;
            }
        }
        ImGui::EndCombo();
    }
}

} // namespace

void ViewPanel::build(Context& context) {
    IslandView& island_view = context.island_view;
    build_look(island_view.options);
    build_colouring(island_view);
    ImGui::Separator();
    widgets::checkbox("trails of the last 3 simulated seconds (T)", island_view.options.trails);
    widgets::checkbox("flashes of meals and deaths", island_view.options.flashes);
    ImGui::Separator();
    choose("perception radii (V)", which_names, island_view.options.radii);
    choose("forces (G)", which_names, island_view.options.forces);
    ImGui::Separator();
    widgets::checkbox("density map where organisms are too many", island_view.options.density);
    widgets::checkbox("minimap while zoomed in", island_view.options.minimap);
    ImGui::Separator();
    bool following = context.island_data.followed().has_value();
    if (context.world.feed.selected() || following) {
        if (widgets::checkbox("keep the selected organism centred (L)", following)) {
            context.island_data.toggle_following(context.world.feed);
        }
    } else {
        widgets::small_text("Click an organism to select it.", palette::text);
    }
    if (!island_view.problem().empty()) {
        ImGui::Separator();
        widgets::small_text(island_view.problem() + ".", palette::text);
    }
}

} // namespace evod::viewer
