#include "client/viewer/panels/freezer_panel.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/new_world_dialog.h"
#include "client/viewer/world/freezer.h"
#include "client/viewer/world/mouse_tool.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <utility>

namespace evod::viewer {

namespace {

MouseTool::Model model_of(const Frozen& organism) {
    return {organism.name, organism.population.islands[0]};
}

} // namespace

void FreezerPanel::build(Context& context) {
    Freezer& freezer = *context.freezer;
    freezer.update(context.now);
    build_freeze(context);
    if (!problem_.empty()) {
        widgets::small_text(problem_, palette::warning);
        widgets::mark("The freezer has a problem");
    }
    ImGui::Separator();
    if (!freezer.problem().empty()) {
        widgets::small_text(freezer.problem(), palette::warning);
    } else if (freezer.files().empty()) {
        widgets::small_text("Nothing is frozen yet. Freeze stores this world's population, or the selected organism in "
                            "the panel Organism (F6), to place it in any world later.");
    } else {
        build_files(context);
        build_actions(context);
    }
    widgets::small_text("Folder: " + freezer.folder().string());
}

void FreezerPanel::build_freeze(Context& context) {
    if (const auto read = std::exchange(read_, std::nullopt)) {
        if (!*read) {
            problem_ = read->error().what;
        } else {
            const WholePopulation::Genes& genes = **read;
            const std::string name =
                name_.empty() ? genes.world + "-g" + std::to_string(genes.generation) : std::exchange(name_, "");
            const auto saved = context.freezer->save(name, genes.population);
            problem_ = saved ? "" : saved.error().what;
            if (saved) {
                chosen_ = *saved;
                context.world.server.notice("Stored the population in the freezer as " + *saved);
            }
        }
    }
    ImGui::SetNextItemWidth(160 * context.gui.scale());
    ImGui::InputTextWithHint("##name", "name: world-g12", &name_);
    widgets::mark_field("name", name_);
    widgets::explain("The name of the file. Empty: the name of the world and the number of the generation.");
    ImGui::SameLine();
    ImGui::BeginDisabled(context.world.feed.snapshot() == nullptr);
    if (widgets::button("Freeze the population")) {
        population_.request(context.world, [this](const core::Result<WholePopulation::Genes>& read) { read_ = read; });
    }
    ImGui::EndDisabled();
    widgets::explain("Stores the genes of all organisms of this generation, of all islands, alive and dead.");
}

void FreezerPanel::build_files(Context& context) {
    constexpr ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH |
                                      ImGuiTableFlags_SizingStretchSame | ImGuiTableFlags_ScrollY;
    const std::vector<Frozen>& files = context.freezer->files();
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float height =
        std::min(line * (static_cast<float>(files.size()) + 1.5f), ImGui::GetContentRegionAvail().y - 4 * line);
    if (!ImGui::BeginTable("files", 2, flags, {0, std::max(height, 3 * line)})) {
        return;
    }
    for (const char* heading : {"Name", "Content"}) {
        ImGui::TableSetupColumn(heading);
    }
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableHeadersRow();
    for (std::size_t i = 0; i < files.size(); ++i) {
        const Frozen& file = files[i];
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable("##file", file.name == chosen_, ImGuiSelectableFlags_SpanAllColumns)) {
            chosen_ = file.name;
        }
        widgets::mark(file.name);
        if (!file.problem.empty()) {
            widgets::mark(file.name + " is damaged");
            widgets::explain(file.problem);
        }
        if (ImGui::IsItemActive() && ImGui::IsMouseDragging(ImGuiMouseButton_Left) && file.is_organism()) {
            context.tool->drag(model_of(file));
        } else if (ImGui::IsItemDeactivated() && context.tool->dragging()) {
            context.tool->drop();
        }
        ImGui::SameLine(0, 0);
        ImGui::TextUnformatted(file.name.c_str()); // a name may contain ##
        ImGui::TableNextColumn();
        if (file.problem.empty()) {
            ImGui::TextUnformatted(file.content_text().c_str());
        } else {
            ImGui::PushStyleColor(ImGuiCol_Text, ink(palette::warning));
            ImGui::TextUnformatted(("damaged: " + file.problem).c_str()); // in one line, like the other rows
            ImGui::PopStyleColor();
        }
        ImGui::PopID();
    }
    ImGui::EndTable();
}

void FreezerPanel::build_actions(Context& context) {
    const Frozen* file = context.freezer->find(chosen_);
    const bool usable = file != nullptr && file->problem.empty();
    const std::string problem = context.tool->problem(MouseTool::Kind::Food, context.world);
    ImGui::BeginDisabled(!usable || !file->is_organism() || !problem.empty());
    if (widgets::button("Thaw")) {
        context.tool->place(model_of(*file));
    }
    ImGui::EndDisabled();
    widgets::explain(problem.empty() ? "Then a click in the island places the organism. You can also drag it there."
                                     : problem);
    ImGui::SameLine();
    ImGui::BeginDisabled(!usable);
    if (widgets::button("New world …")) {
        context.new_world->open(false, chosen_);
    }
    ImGui::EndDisabled();
    widgets::explain("Creates a world whose first generation is this population.");
    ImGui::SameLine();
    ImGui::BeginDisabled(file == nullptr);
    if (widgets::button("Delete …")) {
        ImGui::OpenPopup("delete");
    }
    ImGui::EndDisabled();
    if (ImGui::BeginPopup("delete")) {
        ImGui::Text("Delete the file %s.csv?", chosen_.c_str());
        if (widgets::button("Delete the file")) {
            problem_ = context.freezer->remove(chosen_);
            ImGui::CloseCurrentPopup();
        }
        widgets::end_popup_with_cancel();
    }
}

} // namespace evod::viewer
