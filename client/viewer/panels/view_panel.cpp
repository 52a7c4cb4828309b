#include "client/viewer/panels/view_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/scene/legend.h"

#include <imgui.h>

#include <string>

namespace evod::viewer {

namespace {

void build_colouring(Sight& sight) {
    Sight::Shown& shown = sight.shown;
    const auto& genes = sight.gene_names();
    const auto name = [&](ColourBy by, std::size_t gene) -> std::string {
        switch (by) {
        case ColourBy::Gene:
            return gene < genes.size() ? "gene " + genes[gene] : "gene";
        case ColourBy::Health:
            return "health";
        case ColourBy::Lineage:
            return "lineage (who of the first generation they come of)";
        default:
            return "nothing";
        }
    };
    const auto choose = [&](ColourBy by, std::size_t gene) {
        const bool chosen = shown.colour_by == by && (by != ColourBy::Gene || shown.gene == gene);
        if (ImGui::Selectable(name(by, gene).c_str(), chosen)) {
            shown.colour_by = by;
            shown.gene = gene;
        }
    };
    if (ImGui::BeginCombo("colour by (C)", name(shown.colour_by, shown.gene).c_str())) {
        choose(ColourBy::Nothing, shown.gene);
        choose(ColourBy::Health, shown.gene);
        choose(ColourBy::Lineage, shown.gene);
        for (std::size_t gene = 0; gene < genes.size(); ++gene) {
            choose(ColourBy::Gene, gene);
        }
        ImGui::EndCombo();
    }
    if (ImGui::BeginCombo("palette", std::string{palette::name_of(shown.ramp)}.c_str())) {
        for (const palette::Ramp ramp : palette::ramps) {
            if (ImGui::Selectable(std::string{palette::name_of(ramp)}.c_str(), shown.ramp == ramp)) {
                shown.ramp = ramp;
            }
        }
        ImGui::EndCombo();
    }
}

} // namespace

void ViewPanel::build(Context& context) {
    Sight& sight = context.sight;
    build_colouring(sight);
    ImGui::Separator();
    ImGui::Checkbox("perception radii of food and poison (V)", &sight.shown.radii);
    ImGui::Checkbox("forces, and what they act on (G)", &sight.shown.forces);
    ImGui::Checkbox("trails of the last 3 simulated seconds (T)", &sight.shown.trails);
    ImGui::Separator();
    ImGui::Checkbox("densities where organisms are too small", &sight.shown.density);
    ImGui::Checkbox("minimap where not all is seen", &sight.shown.minimap);
    ImGui::Separator();
    bool following = sight.following();
    if (context.watch.selected() || following) {
        if (ImGui::Checkbox("keep the selected organism in the middle (L)", &following)) {
            sight.toggle_following(context.watch);
        }
    } else {
        widgets::say("A click on an organism selects it.", palette::text);
    }
    if (!sight.trouble().empty()) {
        ImGui::Separator();
        widgets::say(sight.trouble() + ".", palette::text);
    }
}

} // namespace evod::viewer
