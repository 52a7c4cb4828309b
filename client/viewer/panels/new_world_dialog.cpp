#include "client/viewer/panels/new_world_dialog.h"

#include "client/viewer/drawing/imgui_keys.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/world/freezer.h"
#include "client/viewer/world/presets.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

namespace evod::viewer {

namespace {

constexpr const char* title = "New world";
constexpr const char* from_seed = "drawn from the seed";
constexpr float width = 640, field_left = 150, field_width = 260; // pixels at scale 1

/// Shows a sentence below a radio button, indented like the text of the button.
void build_description(std::string_view text) {
    const float indent = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::Indent(indent);
    widgets::small_text(text);
    ImGui::Unindent(indent);
}

/// Writes the label of the field that follows in the same line.
void begin_field(const char* label, float scale) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(label);
    ImGui::SameLine(field_left * scale);
    ImGui::SetNextItemWidth(field_width * scale);
}

} // namespace

void NewWorldDialog::open(bool beside, std::string population) {
    opening_ = true;
    beside_ = beside;
    population_ = std::move(population);
}

void NewWorldDialog::begin(Panel::Context& context) {
    answers_ = std::make_shared<Answers>();
    name_edited_ = false;
    wanted_.seed.clear();
    choose(preset_ ? preset_ : 0);
    ViewedWorld& world = context.world;
    request_names(world);
    if (!world.feed.control().known()) {
        return;
    }
    evod::v1::Request request;
    request.mutable_get_parameters()->set_world(world.feed.name());
    world.server.send(std::move(request),
                      [weak = std::weak_ptr{answers_}](const core::Result<evod::v1::Response>& response) {
                          if (const auto answers = weak.lock(); answers && response && core::accepted(*response)) {
                              answers->shown_json = experiment_json(response->parameters());
                          }
                      });
}

void NewWorldDialog::request_names(ViewedWorld& world) {
    evod::v1::Request request;
    request.mutable_list_worlds();
    world.server.send(std::move(request),
                      [weak = std::weak_ptr{answers_}](const core::Result<evod::v1::Response>& response) {
                          if (const auto answers = weak.lock(); answers && response && core::accepted(*response)) {
                              for (const evod::v1::WorldInfo& listed : response->worlds().worlds()) {
                                  answers->names.push_back(listed.name());
                              }
                              for (const evod::v1::DamagedWorld& listed : response->worlds().damaged()) {
                                  answers->names.push_back(listed.name());
                              }
                          }
                      });
}

void NewWorldDialog::choose(std::optional<std::size_t> preset) {
    preset_ = preset;
    wanted_.experiment_json = preset ? std::string{presets()[*preset].json} : answers_->shown_json;
}

void NewWorldDialog::build(Panel::Context& context) {
    if (std::exchange(opening_, false)) {
        begin(context);
        ImGui::OpenPopup(title);
    }
    const float scale = context.gui.scale();
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowSize({std::min(width * scale, window.x), 0});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {window.x, window.y});
    ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {20 * scale, 14 * scale});
    const bool shown = ImGui::BeginPopupModal(
        title, nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    ImGui::PopStyleVar();
    if (!shown) {
        return;
    }
    context.gui.widget_positions().begin_panel(title);
    ImGui::PushFont(&context.gui.title());
    ImGui::TextUnformatted(title);
    ImGui::PopFont();
    build_experiments(context.world, scale);
    ImGui::Separator();
    build_fields(context);
    ImGui::Separator();
    build_end(context);
    context.gui.widget_positions().begin_panel({});
    ImGui::EndPopup();
}

void NewWorldDialog::build_experiments(const ViewedWorld& world, float scale) {
    const auto choice = [&](const std::string& label, std::string_view description, std::optional<std::size_t> preset) {
        if (ImGui::RadioButton(label.c_str(), preset_ == preset)) {
            choose(preset);
        }
        widgets::mark(label);
        build_description(description);
    };
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {8 * scale, 2 * scale});
    for (std::size_t i = 0; i < presets().size(); ++i) {
        choice(std::string{presets()[i].name}, presets()[i].description, i);
    }
    ImGui::BeginDisabled(answers_->shown_json.empty());
    choice("same as " + world.feed.name(), "The parameters and the schedule that this world has now.", std::nullopt);
    ImGui::EndDisabled();
    ImGui::PopStyleVar();
}

void NewWorldDialog::build_fields(const Panel::Context& context) {
    const float scale = context.gui.scale();
    if (!name_edited_) {
        const std::string base = preset_ ? std::string{presets()[*preset_].name} : context.world.feed.name();
        wanted_.name = unused_name(base, answers_->names);
    }
    begin_field("name", scale);
    name_edited_ = ImGui::InputText("##name", &wanted_.name) || name_edited_;
    widgets::mark_field("name", wanted_.name);
    begin_field("seed", scale);
    ImGui::InputTextWithHint("##seed", "empty: chosen at random", &wanted_.seed, ImGuiInputTextFlags_CharsDecimal);
    widgets::mark_field("seed", wanted_.seed);
    widgets::explain("Determines everything that is random. Two worlds with equal seeds and parameters are equal.");
    build_population(context);
    const bool as_text = ImGui::TreeNode("Parameters as text");
    widgets::mark("Parameters as text");
    widgets::explain("The text of the experiment. A parameter that it does not name has its default value.");
    if (as_text) {
        ImGui::InputTextMultiline("##text", &wanted_.experiment_json, {-1, 7 * ImGui::GetTextLineHeight()});
        widgets::mark("text");
        ImGui::TreePop();
    }
}

void NewWorldDialog::build_population(const Panel::Context& context) {
    context.freezer->update(context.now);
    constexpr const char* label = "first population";
    begin_field(label, context.gui.scale());
    if (widgets::begin_drop_down("##population", population_.empty() ? from_seed : population_.c_str(), label)) {
        if (widgets::choice(label, from_seed, population_.empty())) {
            population_.clear();
        }
        for (const Frozen& file : context.freezer->files()) {
            if (file.problem.empty() && widgets::choice(label, file.name, file.name == population_)) {
                population_ = file.name;
            }
        }
        ImGui::EndCombo();
    }
    if (const Frozen* file = population_.empty() ? nullptr : context.freezer->find(population_)) {
        ImGui::SameLine();
        ImGui::TextDisabled("%s", file->content_text().c_str());
        widgets::small_text("population_size and island_count follow from the population.");
    }
}

void NewWorldDialog::build_end(Panel::Context& context) {
    widgets::checkbox("show it beside this world", beside_);
    if (!answers_->problem.empty()) {
        widgets::small_text(answers_->problem, palette::warning);
        widgets::mark("The new world is refused");
    }
    const bool may = context.world.server.may_create();
    if (!may) {
        widgets::small_text(no_creation_text, palette::stopped);
    }
    ImGui::BeginDisabled(!may || answers_->sent);
    const ImVec2 size{90 * context.gui.scale(), 0};
    if (ImGui::Button("Create", size)) {
        send(context);
    }
    widgets::mark("Create");
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool escape = !ImGui::IsAnyItemActive() && is_key_pressed(ImGuiKey_Escape);
    const bool cancelled = ImGui::Button("Cancel", size);
    widgets::mark("Cancel");
    if (cancelled || escape || answers_->created) {
        ImGui::CloseCurrentPopup();
    }
}

void NewWorldDialog::send(Panel::Context& context) {
    const Frozen* file = population_.empty() ? nullptr : context.freezer->find(population_);
    if (!population_.empty() && file == nullptr) {
        answers_->problem = "first population: the file " + population_ + " no longer exists";
        return;
    }
    wanted_.population = file != nullptr ? file->population : codec::Population{};
    auto request = create_request(wanted_);
    answers_->problem = request ? "" : request.error().what;
    if (!request) {
        return;
    }
    answers_->sent = true;
    context.world.create(*std::move(request), beside_, [weak = std::weak_ptr{answers_}](const std::string& refusal) {
        if (const auto answers = weak.lock()) {
            answers->sent = false;
            answers->problem = refusal;
            answers->created = refusal.empty();
        }
    });
}

} // namespace evod::viewer
