// Commands that follow a world: watch, events.
#include "client/core/client_types.h"
#include "client/ctl/caller.h"
#include "client/ctl/screen.h"
#include "client/ctl/text.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <cstdio>
#include <deque>
#include <iostream>
#include <optional>

namespace evod::ctl {

namespace {

using Clock = std::chrono::steady_clock;

/// The statistics of one generation, combined over all islands.
struct GenerationLine {
    std::uint64_t generation = 0;
    double fitness_best = 0, fitness_mean = 0, diversity = 0;
    std::uint64_t alive_count = 0, organism_count = 0, starved_count = 0, poisoned_count = 0;
};

GenerationLine line_of(const google::protobuf::RepeatedPtrField<v1::GenerationStatistics>& islands) {
    GenerationLine line;
    for (const auto& island : islands) {
        line.fitness_best =
            line.organism_count == 0 ? island.fitness_best() : std::max(line.fitness_best, island.fitness_best());
        line.generation = island.generation();
        line.fitness_mean += island.fitness_mean() / islands.size();
        line.diversity += island.diversity() / islands.size();
        line.alive_count += island.alive_count();
        line.organism_count += island.organism_count();
        line.starved_count += island.starved_count();
        line.poisoned_count += island.poisoned_count();
    }
    return line;
}

std::string life_of(const GenerationLine& line) {
    return ", alive " + std::to_string(line.alive_count) + "/" + std::to_string(line.organism_count) + ", starved " +
           std::to_string(line.starved_count) + ", poisoned " + std::to_string(line.poisoned_count);
}

/// Without bodies, no organism lives or dies, and the text does not mention it.
std::string text_of(const GenerationLine& line) {
    return "generation " + std::to_string(line.generation) + ": best " + fitness_text(line.fitness_best) + ", mean " +
           fitness_text(line.fitness_mean) + ", diversity " + fixed(line.diversity, 3) +
           (line.alive_count + line.starved_count + line.poisoned_count > 0 ? life_of(line) : "");
}

// ---- watch -----------------------------------------------------------------------------------------------------

class WatchDisplay {
  public:
    WatchDisplay(const Common& common, std::optional<std::uint64_t> generations)
        : common_{common}
        , generations_{generations}
        , caller_{common}
        , redraw_{on_terminal() && !common.json && !generations} {} // --generations prints a line per generation

    void run() {
        catch_interrupts();
        world_ = caller_.world(common_.world);
        v1::SubscribeEvents events;
        events.set_world(world_.name());
        const core::SubscriptionHandle subscription = caller_.connection().subscribe(events);
        (void)caller_.connection().wait_subscribed(subscription);
        caller_.require_subscribed(subscription);
        if (redraw_) {
            load_past();
        } else {
            print_storage(caller_.storage());
        }
        while (!interrupted() && !ended_) {
            if (redraw_ && Clock::now() >= draw_at_) {
                look();
                draw();
                draw_at_ = Clock::now() + std::chrono::milliseconds{500};
            }
            if (const auto event = caller_.connection().wait_event(std::chrono::milliseconds{100})) {
                take(*event);
            }
            reporter_.report(caller_.connection(), live_text_);
            caller_.require_subscribed(subscription); // after a reconnection the world may be gone
        }
        if (redraw_ && !ended_) {
            draw();
        }
        if (ended_ && generations_ && seen_ < *generations_) {
            throw Stop{ExitCode::Refused,
                       "only " + std::to_string(seen_) + " of " + std::to_string(*generations_) + " generations ended"};
        }
    }

  private:
    /// Loads the generations before the first event, so that the sparkline does not start empty.
    void load_past() {
        if (world_.generation() < 2) {
            return;
        }
        v1::Request request;
        auto& history = *request.mutable_get_history();
        history.set_world(world_.name());
        history.set_first_generation(world_.generation() > width + 1 ? world_.generation() - width : 1);
        const auto response = caller_.connection().request(std::move(request), caller_.timeout());
        if (!response || !core::accepted(*response)) {
            return; // evoctl can continue: only the earlier generations are missing
        }
        const auto& generations = response->history().generations();
        for (int first = 0; first < generations.size();) {
            google::protobuf::RepeatedPtrField<v1::GenerationStatistics> islands;
            const std::uint64_t generation = generations[first].generation();
            for (; first < generations.size() && generations[first].generation() == generation; ++first) {
                *islands.Add() = generations[first];
            }
            lines_.push_back(line_of(islands));
        }
    }

    /// Prints the state of the storage on stderr, because programs read stdout. It explains why no generation ends.
    void print_storage(const v1::Storage& storage) {
        const std::string trouble = core::to_text(storage);
        if (!redraw_ && trouble != trouble_) {
            std::cerr << (trouble.empty() ? "run files can be written again" : visible(trouble)) << '\n';
        }
        trouble_ = trouble;
    }

    void take(const v1::Event& event) {
        if (event.has_storage_changed()) {
            print_storage(event.storage_changed().storage());
            draw_at_ = {};
        } else if (event.has_events_dropped() && !redraw_) {
            print_storage(caller_.storage());
        } else if (event.has_generation_finished()) {
            lines_.push_back(line_of(event.generation_finished().statistics()));
            if (lines_.size() > width) {
                lines_.pop_front();
            }
            if (common_.json) {
                std::cout << to_json(event.generation_finished(), false) << std::flush;
            } else if (!redraw_) {
                std::cout << visible(text_of(lines_.back())) << std::endl;
            }
            ++seen_;
            if (generations_ && seen_ >= *generations_) {
                end("");
            }
        } else if (event.has_run_terminated()) {
            look();
            end(world_.name() + ": " + core::to_text(event));
        } else if (event.has_world_deleted()) {
            end(core::to_text(event));
        } else if (event.has_world_damaged()) {
            throw Stop{ExitCode::Refused, core::to_text(event)};
        } else if (event.has_world_reset()) {
            lines_.clear();
        }
    }

    void end(const std::string& why) {
        if (redraw_) {
            look();
            draw();
        }
        if (!why.empty()) {
            live_text_.leave();
            std::cerr << visible(why) << '\n';
        }
        ended_ = true;
    }

    void look() {
        v1::Request request;
        request.mutable_get_statistics()->set_world(world_.name());
        const auto response = caller_.connection().request(std::move(request), std::chrono::milliseconds{1000});
        if (response && core::accepted(*response)) {
            statistics_ = response->statistics();
            world_ = statistics_.world();
        }
    }

    void draw() {
        std::string text = sentence(world_) + ", " + fixed(world_.ticks_per_s(), 0) + " ticks/s\n";
        const std::string trouble = core::to_text(world_.storage());
        text += (trouble.empty() ? "" : trouble + "\n") + "\n";
        std::uint64_t alive = 0, born = 0, starved = 0, poisoned = 0;
        double health = 0;
        for (const auto& island : statistics_.live()) {
            alive += island.alive_count();
            born += island.organism_count();
            starved += island.starved_count();
            poisoned += island.poisoned_count();
            health += island.health_mean() * island.alive_count();
        }
        if (born > 0) {
            text += "now   alive " + std::to_string(alive) + "/" + std::to_string(born) + ", mean health " +
                    fixed(alive > 0 ? health / static_cast<double>(alive) : 0, 1) + ", starved " +
                    std::to_string(starved) + ", poisoned " + std::to_string(poisoned) + "\n";
        }
        if (!lines_.empty()) {
            std::vector<double> best, mean;
            for (const GenerationLine& line : lines_) {
                best.push_back(line.fitness_best);
                mean.push_back(line.fitness_mean);
            }
            // Leaves space for the number after the sparkline. If the line is too long, the sparkline omits its oldest
            // generations.
            constexpr std::size_t figures = 18;
            const std::size_t columns = terminal_size().columns;
            const std::size_t shown = std::min(width, columns > figures ? columns - figures : 1);
            text += "last  " + text_of(lines_.back()) + "\n\nbest  " + sparkline(best, shown) + "  " +
                    fitness_text(best.back()) + "\nmean  " + sparkline(mean, shown) + "  " + fitness_text(mean.back()) +
                    "\n";
        } else {
            text += "no generation has ended yet\n";
        }
        for (const auto& island : statistics_.last()) {
            if (island.island() == 0) {
                text += "\n" + genes(island);
            }
        }
        text += "\nCtrl-C stops watching\n";
        live_text_.draw(text);
    }

    std::string genes(const v1::GenerationStatistics& island) const {
        Table table{{{statistics_.last_size() > 1 ? "gene on island 0" : "gene"},
                     {"mean", Table::Align::Right},
                     {"deviation", Table::Align::Right}}};
        for (int i = 0; i < std::min(island.genes_size(), world_.gene_names_size()); ++i) {
            table.add({world_.gene_names(i), fixed(island.genes(i).mean(), 1), fixed(island.genes(i).deviation(), 1)});
        }
        return table.to_text();
    }

    static constexpr std::size_t width = 60; // maximal number of generations in a sparkline

    const Common& common_;
    const std::optional<std::uint64_t> generations_;
    Caller caller_;
    const bool redraw_;
    v1::WorldInfo world_;
    v1::Statistics statistics_;
    std::deque<GenerationLine> lines_; // the newest generations, at most `width`
    std::uint64_t seen_ = 0;           // number of generations that ended while this command ran
    LiveText live_text_;
    ConnectionReporter reporter_;
    std::string trouble_; // the problem of the storage that was printed last; empty: none
    Clock::time_point draw_at_{};
    bool ended_ = false;
};

// ---- events ----------------------------------------------------------------------------------------------------

std::string line_of(const v1::Event& event) {
    return (event.world().empty() ? "server" : event.world() + " tick " + std::to_string(event.tick())) + ": " +
           core::to_text(event);
}

void follow_events(const Common& common, std::optional<std::uint64_t> count) {
    Caller caller{common};
    v1::SubscribeEvents subscription;
    if (!common.world.empty()) {
        subscription.set_world(common.world);
    }
    catch_interrupts();
    const core::SubscriptionHandle handle = caller.connection().subscribe(subscription);
    if (const auto answer = caller.connection().wait_subscribed(handle, caller.timeout()); !answer) {
        throw Stop{ExitCode::NoConnection, answer.error().what};
    }
    caller.require_subscribed(handle);
    if (const std::string trouble = core::to_text(caller.storage()); !trouble.empty()) {
        std::cerr << visible(trouble) << '\n'; // the problem began before this command
    }
    ConnectionReporter reporter;
    LiveText none;
    std::uint64_t seen = 0;
    for (bool gone = false; !gone && !interrupted() && (!count || seen < *count);) {
        if (const auto event = caller.connection().wait_event(std::chrono::milliseconds{100})) {
            std::cout << (common.json ? to_json(*event, false) : visible(line_of(*event)) + "\n") << std::flush;
            ++seen;
            gone = subscription.has_world() && (event->has_world_deleted() || event->has_world_damaged());
        }
        reporter.report(caller.connection(), none);
        caller.require_subscribed(handle); // after a reconnection the world may be gone
    }
    if (count && seen < *count && !interrupted()) {
        throw Stop{ExitCode::Refused, "only " + std::to_string(seen) + " of " + std::to_string(*count) +
                                          " events arrived, then the world was deleted or damaged"};
    }
}

} // namespace

void add_watch_commands(command_line::Command& app, const Common& common) {
    const char* const group = "Follow";
    auto& watch =
        app.add_command("watch", "Show live statistics; if the output is not a terminal, print one line per generation")
            .group(group);
    auto& generations = watch.keep(std::optional<std::uint64_t>{});
    watch
        .add_option("--generations", &generations,
                    "Print one line per generation for this many generations, then exit; default: until Ctrl-C")
        .check(at_least_one);
    watch.footer("Examples:\n  evoctl watch\n  evoctl watch --generations 100 > fitness.txt");
    watch.action([&] { WatchDisplay{common, generations}.run(); });

    auto& events = app.add_command("events", "Print every event of one world or of all, one per line").group(group);
    auto& count = events.keep(std::optional<std::uint64_t>{});
    events
        .add_option("--count", &count,
                    "Exit after this many events; default: until Ctrl-C, or until the world is deleted or damaged")
        .check(at_least_one);
    events.footer("Examples:\n  evoctl events --world lesson\n  evoctl events --json | jq .parameters_changed");
    events.action([&] { follow_events(common, count); });
}

} // namespace evod::ctl
