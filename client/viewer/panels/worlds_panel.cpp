#include "client/viewer/panels/worlds_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

void cell(const std::string& text) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
}

/// Returns the statistics of this island; null if the list does not contain them.
template <class Statistics>
const Statistics* of_island(const google::protobuf::RepeatedPtrField<Statistics>& all, std::uint32_t island) {
    const auto found = std::ranges::find(all, island, &Statistics::island);
    return found == all.end() ? nullptr : &*found;
}

} // namespace

void WorldsPanel::build(Context& context) {
    ViewedWorld& world = context.world;
    if (world.feed.place_number() != place_number_) {
        place_number_ = world.feed.place_number();
        statistics_.Clear();
    }
    if (context.just_shown) {
        refresh();
    }
    process_events(world);
    poll(world, context.now);
    if (!list_poll_.problem().empty()) {
        widgets::small_text(list_poll_.problem(), palette::warning);
    }
    build_worlds(world);
    if (!world.server.may_create()) {
        widgets::small_text(no_creation_text, palette::stopped);
    }
    build_islands(world);
}

void WorldsPanel::refresh() {
    list_poll_.make_due();
    statistics_poll_.make_due();
}

void WorldsPanel::poll(ViewedWorld& world, Clock::time_point now) {
    if (list_poll_.due(world, now)) {
        evod::v1::Request request;
        request.mutable_list_worlds();
        list_poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                worlds_.assign(response->worlds().worlds().begin(), response->worlds().worlds().end());
                damaged_.assign(response->worlds().damaged().begin(), response->worlds().damaged().end());
            }
        });
    }
    if (statistics_poll_.due(world, now)) {
        evod::v1::Request request;
        request.mutable_get_statistics()->set_world(world.feed.world());
        statistics_poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                statistics_ = response->statistics();
            } // after an error, keep the last statistics
        });
    }
}

void WorldsPanel::process_events(const ViewedWorld& world) {
    using Kind = evod::v1::Event::KindCase;
    for (const evod::v1::Event& event : world.feed.events()) {
        switch (event.kind_case()) {
        case Kind::kRunControlChanged:
        case Kind::kRunTerminated:
        case Kind::kWorldCreated:
        case Kind::kWorldReset:
        case Kind::kWorldDeleted:
        case Kind::kWorldDamaged:
        case Kind::kEventsDropped:
            refresh();
            break;
        default: // polling shows the progress of running worlds
            break;
        }
    }
}

void WorldsPanel::build_worlds(ViewedWorld& world) {
    constexpr ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH |
                                      ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_ScrollY;
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const auto row_count = static_cast<float>(worlds_.size() + damaged_.size());
    const float height = std::min(line * (row_count + 1.5f), ImGui::GetContentRegionAvail().y * 0.6f);
    if (!ImGui::BeginTable("worlds", 5, flags, {0, height})) {
        return;
    }
    for (const char* heading : {"World", "State", "Generation", "Tick", "Speed"}) {
        ImGui::TableSetupColumn(heading);
    }
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableHeadersRow();
    std::optional<std::string> chosen;
    const auto begin_row = [&](const std::string& name) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        if (ImGui::Selectable(name.c_str(), name == world.feed.name(), ImGuiSelectableFlags_SpanAllColumns)) {
            chosen = name;
        }
        widgets::mark(name);
    };
    for (const evod::v1::WorldInfo& listed : worlds_) {
        begin_row(listed.name());
        cell(state_word(listed.state(), listed.storage(), listed.has_awaited_fitness()));
        cell(with_separators(listed.generation()));
        cell(with_separators(listed.tick()));
        cell(speed_text(listed.speed()) + (listed.slowed() ? " (slower)" : ""));
    }
    for (const evod::v1::DamagedWorld& listed : damaged_) { // the island's place shows the reason
        begin_row(listed.name());
        cell("damaged");
    }
    ImGui::EndTable();
    if (chosen && *chosen != world.feed.name()) {
        world.show(*chosen, 0);
    }
}

void WorldsPanel::build_islands(ViewedWorld& world) {
    const auto count = static_cast<int>(statistics_.world().island_count());
    if (count == 0) {
        return;
    }
    widgets::small_text("Islands of " + statistics_.world().name());
    constexpr ImGuiTableFlags flags =
        ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchSame | ImGuiTableFlags_ScrollY;
    if (!ImGui::BeginTable("islands", 4, flags)) {
        return;
    }
    for (const char* heading : {"Island", "Alive", "Mean health", "Last best fitness"}) {
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
            if (ImGui::Selectable(name.c_str(), static_cast<std::uint32_t>(i) == world.feed.island(),
                                  ImGuiSelectableFlags_SpanAllColumns)) {
                chosen = static_cast<std::uint32_t>(i);
            }
            widgets::mark(name);
            // Live statistics are absent if fitness depends only on the chromosome. Statistics of the last generation
            // are absent in generation 1.
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
                ImGui::TextUnformatted(shown_fitness(last->fitness_best()).c_str());
            }
        }
    }
    ImGui::EndTable();
    if (chosen) {
        world.feed.choose_island(*chosen);
    }
}

} // namespace evod::viewer
