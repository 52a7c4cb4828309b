#include "client/viewer/panels/plots/plots_panel.h"

#include "client/viewer/drawing/png.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace evod::viewer {

namespace {

constexpr float plot_height_min = 100;                           // pixels
constexpr int image_pixels_min = 200, image_pixels_max = 10'000; // allowed width and height of a saved image

struct Tab {
    const char* name;
    Quantity quantity;
};
constexpr std::size_t windows[] = {1, 5, 10, 20, 50, 100}; // generations of a running mean; 1: none
std::string window_name(std::size_t window) {
    return window == 1 ? "each generation" : running_mean_name(window);
}

constexpr Tab tabs[] = {{"Fitness", Quantity::Fitness},     {"Genes", Quantity::Genes},
                        {"Selection", Quantity::Selection}, {"Diversity", Quantity::Diversity},
                        {"Survivors", Quantity::Survivors}, {"Deaths", Quantity::Deaths}};

/// Builds a field for the width or height of a saved image.
void build_pixels(const char* label, const char* name, int& pixels) {
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 4);
    ImGui::InputInt(label, &pixels, 0);
    if (ImGui::IsItemDeactivatedAfterEdit()) {
        pixels = std::clamp(pixels, image_pixels_min, image_pixels_max);
    }
    widgets::mark_field(name, pixels);
    widgets::explain(std::string{"The "} + name + ", " + with_separators(image_pixels_min) + " to " +
                     with_separators(image_pixels_max) + " pixels.");
}

/// The names of the CSV files in the working folder, sorted.
std::vector<std::string> csv_files() {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator{".", error}) {
        if (entry.path().extension() == ".csv") {
            names.push_back(entry.path().filename().string());
        }
    }
    std::ranges::sort(names);
    return names;
}

std::vector<float> gene_of(const Population& population, std::size_t gene, std::span<const std::uint32_t> ids) {
    std::vector<float> numbers;
    for (const std::uint32_t id : ids) {
        numbers.push_back(population.gene(gene)[id]);
    }
    return numbers;
}

} // namespace

// ---- data ------------------------------------------------------------------------------------------------------

void PlotsPanel::poll_worlds(const Context& context) {
    if (!worlds_poll_.due(context.world, context.now) || !(worlds_stale_ || worlds_poll_.pending())) {
        return;
    }
    worlds_stale_ = false;
    evod::v1::Request request;
    request.mutable_list_worlds();
    worlds_poll_.send(context.world, std::move(request), context.now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            worlds_.assign(response->worlds().worlds().begin(), response->worlds().worlds().end());
        } else {
            worlds_stale_ = true;
        }
    });
}

void PlotsPanel::update(Context& context) {
    own_ = context.history;
    worlds_stale_ = worlds_stale_ || context.just_shown;
    for (const evod::v1::Event& event : context.world.feed.events()) {
        worlds_stale_ = worlds_stale_ || event.has_world_created() || event.has_world_deleted() ||
                        event.has_world_damaged() || event.has_world_reset() || event.has_events_dropped();
    }
    poll_worlds(context);
    if (other_world_) {
        other_world_->update_other(context.world, context.now);
    }
}

Subject PlotsPanel::subject() const {
    const History& history = own_->history();
    return {history.table(), island_, history.world().empty() ? "this world" : history.world(), history.changes(),
            genes_};
}

// ---- widgets ---------------------------------------------------------------------------------------------------

void PlotsPanel::build(Context& context) {
    update(context);
    ImGui::PushFont(&context.gui.label());
    build_choices();
    if (!own_->problem().empty()) {
        widgets::small_text(own_->problem(), palette::warning);
    }
    if (other_world_ && !other_world_->problem().empty()) {
        widgets::small_text(other_name_ + ": " + other_world_->problem(), palette::warning);
    }
    const float scale = context.gui.scale();
    // Narrow tabs, so that all of them fit into the sidebar.
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {3 * scale, 4 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemInnerSpacing, {2 * scale, 4 * scale});
    const bool tab_bar = ImGui::BeginTabBar("quantities");
    ImGui::PopStyleVar(2);
    if (tab_bar) {
        for (const Tab& tab : tabs) {
            ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {3 * scale, 4 * scale});
            const bool open = ImGui::BeginTabItem(tab.name);
            ImGui::PopStyleVar();
            widgets::mark(tab.name);
            if (open) {
                build_quantity(context, tab.quantity);
                ImGui::EndTabItem();
            }
        }
        ImGui::EndTabBar();
    }
    build_export();
    ImGui::PopFont();
}

void PlotsPanel::build_choices() {
    const std::uint32_t count = own_->history().table().island_count();
    if (island_ && *island_ >= std::max(count, 1u)) {
        island_.reset();
    }
    build_comparison();
    ImGui::SameLine();
    build_smoothing();
    if (count > 1) {
        build_islands();
    }
}

void PlotsPanel::build_islands() {
    const auto named = [](HistoryTable::Island island) {
        return island ? "island " + std::to_string(*island) : std::string{"all islands"};
    };
    ImGui::SetNextItemWidth(-1);
    if (widgets::begin_drop_down("##island", named(island_).c_str(), "island")) {
        for (std::uint32_t i = 0; i <= own_->history().table().island_count(); ++i) {
            const HistoryTable::Island island = i == 0 ? HistoryTable::Island{} : i - 1;
            if (widgets::choice("island", named(island), island == island_)) {
                island_ = island;
            }
        }
        ImGui::EndCombo();
    }
}

void PlotsPanel::build_smoothing() {
    ImGui::SetNextItemWidth(-1);
    if (widgets::begin_drop_down("##smooth", window_name(window_).c_str(), "running mean")) {
        for (const std::size_t window : windows) {
            if (widgets::choice("running mean", window_name(window), window == window_)) {
                window_ = window;
            }
        }
        ImGui::EndCombo();
    }
    widgets::explain("Running mean: each point is the mean of that generation and the ones before it. Pale lines show "
                     "each generation.");
}

void PlotsPanel::compare_with_file(const std::string& path) {
    auto loaded = load_history(path);
    message_is_error_ = !loaded;
    if (!loaded) {
        message_ = loaded.error().what;
        return;
    }
    if (loaded->empty()) {
        message_is_error_ = true;
        message_ = path + " has a header but no generation";
        return;
    }
    message_.clear();
    file_ = std::move(*loaded);
    other_world_.reset();
    other_name_ = std::filesystem::path{path}.stem().string();
    compared_ = "file " + path;
}

void PlotsPanel::build_comparison() {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("compare with");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.5f);
    const bool compares = other_world_ || file_;
    if (widgets::begin_drop_down("##compare", compares ? compared_.c_str() : "nothing", "compare")) {
        if (ImGui::IsWindowAppearing()) {
            files_ = csv_files();
            worlds_stale_ = true;
        }
        if (widgets::choice("compare", "nothing", !compares)) {
            other_world_.reset();
            file_.reset();
        }
        for (const evod::v1::WorldInfo& world : worlds_) {
            if (world.name() == own_->history().world()) {
                continue;
            }
            if (widgets::choice("compare", "world " + world.name(),
                                other_world_ && world.name() == other_world_->history().world())) {
                other_world_ = std::make_unique<RunHistory>();
                other_world_->set_run(world);
                file_.reset();
                other_name_ = world.name();
                compared_ = "world " + other_name_;
            }
        }
        for (const std::string& name : files_) {
            if (widgets::choice("compare", "file " + name, false)) {
                compare_with_file(name);
            }
        }
        ImGui::Separator();
        ImGui::SetNextItemWidth(-1);
        const bool entered = ImGui::InputTextWithHint("##path", "path of another CSV file, then Enter", path_.data(),
                                                      path_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
        widgets::mark_field("path of another CSV file", path_.data());
        if (entered) {
            compare_with_file(path_.data());
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndCombo();
    }
}

void PlotsPanel::build_quantity(Context& context, Quantity quantity) {
    quantity_ = quantity;
    if (quantity == Quantity::Genes) {
        build_gene_choice(context, "means of");
        update_histogram(context);
    } else if (quantity == Quantity::Selection) {
        build_gene_choice(context, "selection of");
    }
    const auto* other_table = other_world_ ? &other_world_->history().table() : file_ ? &*file_ : nullptr;
    std::optional<Subject> other;
    if (other_table != nullptr) {
        other.emplace(Subject{*other_table, island_, other_name_,
                              other_world_ ? other_world_->history().changes() : std::span<const Mark>{}});
    }
    figure_ = figure_of(quantity, subject(), other ? &*other : nullptr, gene_, window_);
    build_plots(context);
}

void PlotsPanel::build_plots(Context& context) {
    const float line = ImGui::GetFrameHeightWithSpacing();
    float below = line;
    if (!message_.empty()) {
        below += ImGui::CalcTextSize(message_.c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y +
                 ImGui::GetStyle().ItemSpacing.y;
    }
    const float height = ImGui::GetContentRegionAvail().y - below;
    const HistoryTable& table = own_->history().table();
    const std::string known = table.empty() ? own_->history().complete() ? "No generation has ended yet" : "…"
                                            : with_separators(table.column(std::nullopt, "generation").size()) +
                                                  " generations, up to " + with_separators(table.last_generation());
    if (quantity_ != Quantity::Genes || gene_.empty()) {
        plot_widget("history", figure_.plot, view_, std::max(height, plot_height_min));
        widgets::mark(known);
        return;
    }
    // Below the first plot: a row of widgets and the histogram, each with its spacing.
    const float rest = height - line - ImGui::GetStyle().ItemSpacing.y;
    plot_widget("history", figure_.plot, view_, std::max(rest * 0.55f, plot_height_min));
    widgets::mark(known);
    widgets::checkbox("living only", living_only_);
    ImGui::SameLine();
    const Population* population = population_.complete();
    if (const std::string problem = population_.problem(); !problem.empty()) {
        widgets::small_text(problem, palette::warning);
    } else if (population == nullptr) {
        widgets::small_text("…");
    } else {
        widgets::small_text("generation " + with_separators(population->generation()) + ", island " +
                            std::to_string(island_.value_or(context.world.feed.island())) + population_note_);
    }
    plot_widget("histogram", histogram_.plot, histogram_view_, std::max(rest * 0.45f, plot_height_min));
}

/// Builds the drop-down of the gene groups of a world that has several.
void PlotsPanel::build_group_choice(const GeneGroups& groups) {
    const std::vector<evod::v1::GeneGroup> distinct = distinct_groups(groups);
    if (std::ranges::find(distinct, group_) == distinct.end()) {
        group_ = distinct.front();
    }
    const auto named = [](evod::v1::GeneGroup group) { return "genes: " + std::string{name_of(group)}; };
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
    if (widgets::begin_drop_down("##group", named(group_).c_str(), "group")) {
        for (const evod::v1::GeneGroup group : distinct) {
            if (widgets::choice("group", named(group), group == group_) && group != group_) {
                group_ = group;
                gene_.clear();
                view_ = {};
            }
        }
        ImGui::EndCombo();
    }
    ImGui::SameLine();
}

void PlotsPanel::build_gene_choice(Context& context, const std::string& quantity) {
    std::vector<std::string> names = own_->history().table().gene_names();
    const GeneGroups& groups = context.world.feed.gene_groups();
    const bool grouped = groups.size() == names.size() && distinct_groups(groups).size() > 1;
    if (grouped) {
        build_group_choice(groups);
        const GeneRange range = genes_of(groups, group_);
        const auto first = names.begin() + static_cast<std::ptrdiff_t>(range.first);
        names = {first, first + static_cast<std::ptrdiff_t>(range.count)};
    }
    const bool low = ImGui::GetContentRegionAvail().y < 24 * ImGui::GetFontSize(); // no room for a long legend
    const std::size_t most = low ? genes_in_plot_max / 2 : genes_in_plot_max;
    const GenesOf of{quantity_, group_, island_, own_->history().revision(), names.size(), most};
    if (of != genes_of_) { // update only after a change, because histories may be long
        genes_of_ = of;
        genes_ = most_changed(quantity_, subject(), names, most);
    }
    if (std::ranges::find(names, gene_) == names.end()) {
        gene_.clear();
    }
    const std::string all =
        quantity + (genes_.size() < names.size() ? " the " + std::to_string(genes_.size()) + " most changed"
                    : grouped                    ? " all of the group"
                                                 : " all genes");
    ImGui::SetNextItemWidth(-1);
    if (widgets::begin_drop_down("##gene", gene_.empty() ? all.c_str() : gene_.c_str(), "gene")) {
        if (widgets::choice("gene", all, gene_.empty())) {
            gene_.clear();
        }
        for (const std::string& name : names) {
            if (widgets::choice("gene", name, name == gene_)) {
                gene_ = name;
                histogram_view_ = {};
            }
        }
        ImGui::EndCombo();
    }
}

void PlotsPanel::update_histogram(Context& context) {
    if (gene_.empty()) {
        return;
    }
    const History& history = own_->history();
    const auto& names = history.table().gene_names();
    const PopulationPoll::Of whose{history.world(), history.run_id(), island_.value_or(context.world.feed.island()),
                                   names.size()};
    population_.update(context.world, whose, !history.run_id().empty(), context.now);
    const HistogramOf of{gene_, whose, population_.complete_count(), living_only_};
    if (of == histogram_of_) { // update only after a change, because populations may be large
        return;
    }
    histogram_of_ = of;
    const Population* population = population_.complete();
    population_note_.clear();
    histogram_ = histogram_of(gene_, {});
    const auto index = static_cast<std::size_t>(std::ranges::find(names, gene_) - names.begin());
    if (population == nullptr || index >= population->gene_count()) {
        return;
    }
    if (living_only_) {
        const codec::ReceivedSnapshot* snapshot = context.world.feed.snapshot_of(whose.island);
        const bool of_this_run = snapshot != nullptr && snapshot->about.run_id() == whose.run_id;
        const auto ids = living(*population, of_this_run ? snapshot : nullptr);
        if (ids && !ids->empty()) {
            histogram_ = histogram_of(gene_, gene_of(*population, index, *ids));
            return;
        }
        population_note_ =
            ids ? ": no organism is alive, all are shown" : ": unknown which organisms live, all are shown";
    }
    const std::span<const float> of_all = population->gene(index);
    histogram_ = histogram_of(gene_, {of_all.begin(), of_all.end()});
}

// ---- files -----------------------------------------------------------------------------------------------------

/// The name of a file to save, which contains the content and the run:
/// "evoview-default-3f2a9c01-fitness-generation-120".
std::string PlotsPanel::file_name(const std::string& what) const {
    const History& history = own_->history();
    return "evoview-" + history.world() + "-" + history.run_id().substr(0, 8) + "-" + what + "-generation-" +
           std::to_string(history.table().last_generation());
}

void PlotsPanel::save_csv() {
    const std::string path = std::filesystem::absolute(file_name("history") + ".csv").string();
    message_is_error_ = false;
    try {
        write_file(path, own_->history().table().to_csv());
        message_ = "Saved " + path;
    } catch (const std::runtime_error& error) {
        message_ = error.what();
        message_is_error_ = true;
    }
}

void PlotsPanel::save_png() {
    const auto save = [this](const Figure& figure, const PlotView& view, const std::string& what) {
        Plot plot = figure.plot;
        plot.title += " – " + own_->history().world() + (island_ ? ", island " + std::to_string(*island_) : "") +
                      ", run " + own_->history().run_id().substr(0, 8);
        const std::string path = std::filesystem::absolute(file_name(what) + ".png").string();
        const auto pixels = [this](std::size_t i) {
            return static_cast<unsigned>(std::clamp(image_pixels_[i], image_pixels_min, image_pixels_max));
        };
        write_file(path, png_of(image_of(plot, view, pixels(0), pixels(1))));
        return path;
    };
    try {
        std::string what;
        for (const Tab& tab : tabs) {
            if (tab.quantity == quantity_) {
                what = tab.name;
                what[0] = static_cast<char>(what[0] + ('a' - 'A'));
            }
        }
        if (!gene_.empty() && quantity_ == Quantity::Genes) {
            what = gene_;
        } else if (!gene_.empty() && quantity_ == Quantity::Selection) {
            what = gene_ + "-selection";
        }
        message_ = "Saved " + save(figure_, view_, what);
        if (quantity_ == Quantity::Genes && !gene_.empty() && !histogram_.plot.series.empty()) {
            message_ += " and " + save(histogram_, histogram_view_, gene_ + "-histogram");
        }
        message_is_error_ = false;
    } catch (const std::runtime_error& error) {
        message_ = error.what();
        message_is_error_ = true;
    }
}

void PlotsPanel::build_export() {
    if (widgets::button("Fit")) {
        view_ = histogram_view_ = {};
    }
    ImGui::SameLine();
    if (widgets::button("Save CSV")) {
        save_csv();
    }
    ImGui::SameLine();
    if (widgets::button("Save PNG")) {
        save_png();
    }
    ImGui::SameLine();
    build_pixels("##width", "image width", image_pixels_[0]);
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextUnformatted("×");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    build_pixels("pixels", "image height", image_pixels_[1]);
    if (!message_.empty()) {
        widgets::small_text(message_, message_is_error_ ? palette::warning : palette::text_quiet);
    }
}

} // namespace evod::viewer
