#include "client/viewer/panels/worlds_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/watch/readout.h"

#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

void cell(const std::string& text) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
}

/// Null: there are none of this island.
template <class Statistics>
const Statistics* of_island(const google::protobuf::RepeatedPtrField<Statistics>& all, std::uint32_t island) {
    const auto found = std::ranges::find(all, island, &Statistics::island);
    return found == all.end() ? nullptr : &*found;
}

} // namespace

void WorldsPanel::build(Context& context) {
    Watch& watch = context.watch;
    if (watch.place_number() != place_number_) {
        place_number_ = watch.place_number();
        statistics_.Clear();
    }
    if (context.shown_anew) {
        look_again();
    }
    hear(watch);
    ask(watch, context.now);
    if (!list_inquiry_.trouble().empty()) {
        widgets::say(list_inquiry_.trouble(), palette::warning);
    }
    build_worlds(watch);
    build_islands(watch);
}

void WorldsPanel::look_again() {
    list_inquiry_.hurry();
    statistics_inquiry_.hurry();
}

void WorldsPanel::ask(Watch& watch, Clock::time_point now) {
    if (list_inquiry_.due(watch, now)) {
        evod::v1::Request request;
        request.mutable_list_worlds();
        list_inquiry_.ask(watch, std::move(request), now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                worlds_.assign(response->worlds().worlds().begin(), response->worlds().worlds().end());
            }
        });
    }
    if (statistics_inquiry_.due(watch, now)) {
        evod::v1::Request request;
        request.mutable_get_statistics()->set_world(watch.world());
        statistics_inquiry_.ask(watch, std::move(request), now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                statistics_ = response->statistics();
            } // a world that is not there has no islands; that it is not, the list tells
        });
    }
}

void WorldsPanel::hear(const Watch& watch) {
    using Kind = evod::v1::Event::KindCase;
    for (const evod::v1::Event& event : watch.events()) {
        switch (event.kind_case()) {
        case Kind::kRunControlChanged:
        case Kind::kRunTerminated:
        case Kind::kWorldCreated:
        case Kind::kWorldReset:
        case Kind::kWorldDeleted:
        case Kind::kEventsDropped:
            look_again();
            break;
        default: // a world that runs is looked at anew all the time
            break;
        }
    }
}

void WorldsPanel::build_worlds(Watch& watch) {
    constexpr ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH |
                                      ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_ScrollY;
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float height =
        std::min(line * (static_cast<float>(worlds_.size()) + 1.5f), ImGui::GetContentRegionAvail().y * 0.6f);
    if (!ImGui::BeginTable("worlds", 5, flags, {0, height})) {
        return;
    }
    for (const char* heading : {"World", "State", "Generation", "Tick", "Speed"}) {
        ImGui::TableSetupColumn(heading);
    }
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableHeadersRow();
    std::optional<std::string> chosen;
    for (const evod::v1::WorldInfo& world : worlds_) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        if (ImGui::Selectable(world.name().c_str(), world.name() == watch.name(),
                              ImGuiSelectableFlags_SpanAllColumns)) {
            chosen = world.name();
        }
        widgets::mark(world.name());
        cell(state_word(world.state(), world.storage()));
        cell(with_separators(world.generation()));
        cell(with_separators(world.tick()));
        cell(shown_speed(world.speed()) + (world.slowed() ? " (slower)" : ""));
    }
    ImGui::EndTable();
    if (chosen && *chosen != watch.name()) {
        watch.look_at(*chosen, 0);
    }
}

void WorldsPanel::build_islands(Watch& watch) {
    const auto count = static_cast<int>(statistics_.world().island_count());
    if (count == 0) {
        return;
    }
    widgets::say("Islands of " + statistics_.world().name());
    constexpr ImGuiTableFlags flags =
        ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchSame | ImGuiTableFlags_ScrollY;
    if (!ImGui::BeginTable("islands", 4, flags)) {
        return;
    }
    for (const char* heading : {"Island", "Alive", "Mean health", "Best before"}) {
        ImGui::TableSetupColumn(heading);
    }
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableHeadersRow();
    std::optional<std::uint32_t> chosen;
    ImGuiListClipper clipper;
    clipper.Begin(count);
    while (clipper.Step()) {
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            const std::string name = "island " + std::to_string(i);
            if (ImGui::Selectable(name.c_str(), static_cast<std::uint32_t>(i) == watch.island(),
                                  ImGuiSelectableFlags_SpanAllColumns)) {
                chosen = static_cast<std::uint32_t>(i);
            }
            widgets::mark(name);
            // Absent where the fitness is a function of the chromosome alone, and in the first generation.
            const auto island = static_cast<std::uint32_t>(i);
            if (const auto* live = of_island(statistics_.live(), island)) {
                cell(with_separators(live->alive_count()) + " of " + with_separators(live->organism_count()));
                cell(shown_tenths(live->health_mean()));
            } else {
                ImGui::TableNextColumn();
                ImGui::TableNextColumn();
            }
            ImGui::TableNextColumn();
            if (const auto* last = of_island(statistics_.last(), island)) {
                ImGui::TextUnformatted(shown_tenths(last->fitness_best()).c_str());
            }
        }
    }
    ImGui::EndTable();
    if (chosen) {
        watch.choose_island(*chosen);
    }
}

} // namespace evod::viewer
