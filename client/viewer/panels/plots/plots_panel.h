// PlotsPanel: plots the statistics of a run, generation by generation, while it runs. It compares them with another
// world or an earlier run, and saves them to files.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/panels/plots/figures.h"
#include "client/viewer/panels/plots/run_history.h"
#include "client/viewer/world/population_poll.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class PlotsPanel : public Panel {
  public:
    std::string_view title() const override { return "Plots"; }
    Size first_size() const override { return {560, 460}; }
    void build(Context& context) override;

  private:
    static constexpr std::chrono::seconds population_interval{1}; // between requests for the living organisms

    void update(Context& context);
    void poll_worlds(const Context& context);

    /// Builds one row: the compared history, the running mean, the island and the zoom.
    void build_choices();
    void build_islands();
    void build_comparison();
    void build_smoothing();
    void build_quantity(Context& context, Quantity quantity);
    /// Builds the plot and, for one gene, the histogram. They fill the panel above the row of build_export().
    void build_plots(Context& context);
    void build_group_choice(const GeneGroups& groups);
    /// quantity  the begin of the choice that selects several genes: "means of".
    void build_gene_choice(Context& context, const std::string& quantity);
    /// Computes the histogram of the chosen gene.
    void update_histogram(Context& context);
    void build_export();
    void compare_with_file(const std::string& path);

    std::string file_name(const std::string& what) const;
    void save_csv();
    void save_png();
    Subject subject() const;

    const RunHistory* own_ = nullptr;         // of the viewed world; set by build()
    std::unique_ptr<RunHistory> other_world_; // another world to compare with; null: none
    std::optional<HistoryTable> file_;        // an earlier run to compare with
    std::string other_name_;                  // name of the compared history
    std::string compared_;                    // the chosen entry of the drop-down "compare"
    PopulationPoll population_{population_interval};

    std::vector<evod::v1::WorldInfo> worlds_;
    Poll worlds_poll_;
    bool worlds_stale_ = true;
    std::vector<std::string> files_; // CSV files in the working folder

    Quantity quantity_ = Quantity::Fitness;
    HistoryTable::Island island_;
    evod::v1::GeneGroup group_ = evod::v1::GENE_GROUP_BODY;
    std::vector<std::string> genes_; // plotted together if no gene is chosen
    struct GenesOf {
        Quantity quantity{};
        evod::v1::GeneGroup group{};
        HistoryTable::Island island{};
        std::uint64_t revision = 0;
        std::size_t count = 0, most = 0;
        bool operator==(const GenesOf&) const = default;
    } genes_of_;
    std::string gene_;
    std::size_t window_ = running_mean_default; // generations of the running mean; 1: none
    bool living_only_ = true;
    PlotView view_, histogram_view_;
    Figure figure_, histogram_;
    struct HistogramOf {
        std::string gene;
        PopulationPoll::Of of;
        std::uint64_t whole_count = 0;
        bool living_only = false;
        bool operator==(const HistogramOf&) const = default;
    } histogram_of_;
    std::string population_note_; // why the histogram includes dead organisms

    std::array<char, 256> path_{}; // path of the file to compare with
    std::array<int, 2> image_pixels_{1200, 700};
    std::string message_; // result of the last file operation
    bool message_is_error_ = false;
};

} // namespace evod::viewer
