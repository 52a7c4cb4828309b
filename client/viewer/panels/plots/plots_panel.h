// Plots: how a run went, generation by generation, as it goes on; beside another world or an earlier run, and to files.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/panels/plots/figures.h"
#include "client/viewer/panels/plots/history.h"
#include "client/viewer/watch/population.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class PlotsPanel : public Panel {
  public:
    std::string_view title() const override { return "Plots"; }
    void build(Context& context) override;

  private:
    using Clock = link::WorldView::Clock;

    /// Something that is asked for again and again; questions outlive a panel, and what is shown of them.
    struct Inquiry {
        bool under_way = false;
        Clock::time_point not_before{}; // the next question
        Clock::time_point asked{};
        std::string trouble; // why the last one was refused
    };
    struct TrackedHistory : Inquiry {
        History history;
    };
    struct TrackedPopulation : Inquiry {
        Population coming, whole;  // whole: the last that is
        Clock::time_point taken{}; // the whole one
    };

    void listen(Context& context);
    void ask_history(Context& context, const std::shared_ptr<TrackedHistory>& tracked);
    void ask_worlds(Context& context);
    void ask_population(Context& context, std::uint32_t island);
    template <class Tracked, class Take>
    void ask(Context& context, const std::shared_ptr<Tracked>& tracked, evod::v1::Request request, Take take);

    void build_choices();
    void build_comparison(Context& context);
    void build_quantity(Context& context, Quantity quantity);
    void build_genes(Context& context);
    void build_export();
    void compare_with_file(const std::string& path);

    std::string file_name(const std::string& what) const;
    void save_csv();
    void save_png();
    Subject subject() const;

    std::shared_ptr<TrackedHistory> own_ = std::make_shared<TrackedHistory>();
    std::shared_ptr<TrackedHistory> other_world_; // null: another world is not compared
    std::optional<HistoryTable> file_;            // an earlier run that is compared
    std::string other_name_;                      // of what is compared
    std::shared_ptr<TrackedPopulation> population_ = std::make_shared<TrackedPopulation>();
    std::string population_of_; // world, run and island

    struct Worlds : Inquiry {
        std::vector<evod::v1::WorldInfo> list;
    };
    std::shared_ptr<Worlds> worlds_ = std::make_shared<Worlds>();
    std::vector<std::string> files_; // CSV files of the working folder

    const Watch* heard_ = nullptr; // whose events were heard
    int heard_in_frame_ = -1;      // of Dear ImGui
    std::uint64_t connected_count_ = 0;

    Quantity quantity_ = Quantity::Fitness;
    HistoryTable::Island island_;
    std::string gene_;
    bool only_the_living_ = true;
    PlotView view_, histogram_view_;
    Figure figure_, histogram_;
    struct HistogramOf {
        std::string gene;
        Clock::time_point taken{};
        bool only_the_living = false;
        bool operator==(const HistogramOf&) const = default;
    } histogram_of_;

    std::array<char, 256> path_{}; // of a file to compare with
    std::array<int, 2> picture_pixels_{1200, 700};
    std::string told_; // what became of the last file
    bool told_trouble_ = false;
};

} // namespace evod::viewer
