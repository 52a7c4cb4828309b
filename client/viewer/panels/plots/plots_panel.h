// Plots: how a run went, generation by generation, as it goes on; beside another world or an earlier run, and to files.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/panels/plots/figures.h"
#include "client/viewer/panels/plots/history.h"
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
    static constexpr std::chrono::milliseconds ask_again{100};   // a world may breed faster than anybody looks
    static constexpr std::chrono::seconds look_at_population{1}; // who lives

    struct TrackedHistory {
        History history;
        Poll poll{ask_again};
    };

    void listen(Context& context);
    void ask_history(const Context& context, TrackedHistory& tracked);
    void ask_worlds(const Context& context);

    void build_choices();
    void build_comparison();
    void build_quantity(Context& context, Quantity quantity);
    /// all  what is said where no gene is chosen.
    void build_gene_choice(const char* all);
    /// Of the gene that is chosen.
    void update_histogram(Context& context);
    void build_export();
    void compare_with_file(const std::string& path);

    std::string file_name(const std::string& what) const;
    void save_csv();
    void save_png();
    Subject subject() const;

    TrackedHistory own_;
    std::unique_ptr<TrackedHistory> other_world_; // null: another world is not compared
    std::optional<HistoryTable> file_;            // an earlier run that is compared
    std::string other_name_;                      // of what is compared
    PopulationPoll population_{look_at_population};

    std::vector<evod::v1::WorldInfo> worlds_;
    Poll worlds_poll_;
    bool worlds_stale_ = true;
    std::vector<std::string> files_; // CSV files of the working folder

    std::uint64_t heard_place_ = 0; // of which events were heard
    int heard_in_frame_ = -1;       // of Dear ImGui
    std::uint64_t connected_count_ = 0;

    Quantity quantity_ = Quantity::Fitness;
    HistoryTable::Island island_;
    std::string gene_;
    bool only_the_living_ = true;
    PlotView view_, histogram_view_;
    Figure figure_, histogram_;
    struct HistogramOf {
        std::string gene;
        PopulationPoll::Of of;
        std::uint64_t whole_count = 0;
        bool only_the_living = false;
        bool operator==(const HistogramOf&) const = default;
    } histogram_of_;
    std::string shown_of_population_; // where it is not the living that are wanted

    std::array<char, 256> path_{}; // of a file to compare with
    std::array<int, 2> picture_pixels_{1200, 700};
    std::string told_; // what became of the last file
    bool told_trouble_ = false;
};

} // namespace evod::viewer
