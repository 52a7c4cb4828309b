#include "client/viewer/panels/panels.h"

#include "client/viewer/panels/breeding_panel.h"
#include "client/viewer/panels/organism_panel.h"
#include "client/viewer/panels/physics_panel.h"
#include "client/viewer/panels/plots_panel.h"
#include "client/viewer/panels/view_panel.h"

#include <imgui.h>

#include <string>

namespace evod::viewer {

Panels::Panels() {
    places_.push_back({std::make_unique<ViewPanel>()});
    places_.push_back({std::make_unique<OrganismPanel>()});
    places_.push_back({std::make_unique<PlotsPanel>()});
    places_.push_back({std::make_unique<BreedingPanel>()});
    places_.push_back({std::make_unique<PhysicsPanel>()});
}

void Panels::toggle(std::size_t index) {
    if (index < places_.size()) {
        places_[index].shown = !places_[index].shown;
    }
}

void Panels::show(std::string_view title) {
    for (Place& place : places_) {
        place.shown = place.shown || place.panel->title() == title;
    }
}

void Panels::build(Panel::Context context) {
    for (Place& place : places_) {
        if (!place.shown) {
            continue;
        }
        const std::string title{place.panel->title()};
        ImGui::SetNextWindowSize({380, 480}, ImGuiCond_FirstUseEver);
        if (ImGui::Begin(title.c_str(), &place.shown)) {
            place.panel->build(context);
        }
        ImGui::End();
    }
}

} // namespace evod::viewer
