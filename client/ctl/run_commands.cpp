// Commands that control worlds: create, fork, delete, reset, seek, start, run, pause, resume, step, until, speed.
#include "client/ctl/caller.h"
#include "client/ctl/pace.h"
#include "client/ctl/registry.h"
#include "client/ctl/screen.h"
#include "client/ctl/text.h"
#include "client/ctl/world_template.h"
#include "proto/command_line/command.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <utility>

namespace evod::ctl {

namespace {

void print_world(const Common& common, const v1::Response& response) {
    print(common, response, [&] { return sentence(response.world()) + "\n"; });
}

// ---- create, delete, reset -------------------------------------------------------------------------------------

struct CreateOptions {
    std::string name, experiment, population;
    std::vector<std::string> words;
    std::optional<std::uint64_t> seed;
};

/// The world that a command names by a value, by --world, or by both if they agree. A value replaces EVOD_WORLD.
///
/// value    "NAME" or "WORLD", as the help names it.
/// returns  empty: no world was named.
std::string world_of(const Common& common, const std::string& value, const std::string& given) {
    const char* const of_environment = std::getenv("EVOD_WORLD");
    const bool by_option = !common.world.empty() && (of_environment == nullptr || common.world != of_environment);
    if (by_option && !given.empty() && given != common.world) {
        throw Stop{ExitCode::Usage,
                   value + " and --world name two worlds: got " + given + " and " + common.world + ", allowed one"};
    }
    return given.empty() ? common.world : given;
}

std::string required_world_of(const Common& common, const std::string& value, const std::string& given) {
    std::string world = world_of(common, value, given);
    if (world.empty()) {
        throw Stop{ExitCode::Usage, value + ": got nothing, a value is required"};
    }
    return world;
}

void create(const Common& common, const CreateOptions& options) {
    const std::string name = required_world_of(common, "NAME", options.name);
    Caller caller{common};
    v1::Request request;
    auto& command = *request.mutable_create_world();
    command.set_name(name);
    if (!options.experiment.empty()) {
        add_experiment(options.experiment, command);
    }
    if (!options.population.empty()) {
        add_population(options.population, command);
    }
    if (!options.words.empty()) {
        const auto assignments = caller.registry().assignments(options.words);
        if (!assignments) {
            stop_for(assignments.error());
        }
        command.mutable_parameters()->Assign(assignments->begin(), assignments->end());
    }
    if (options.seed) {
        command.set_seed(*options.seed);
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] {
        return "created " + response.world().name() + ": seed " + std::to_string(response.world().seed()) + ", " +
               std::to_string(response.world().island_count()) +
               (response.world().island_count() == 1 ? " island" : " islands") + ", " + state_of(response.world()) +
               "\n";
    });
}

void remove(const Common& common, const std::string& given) {
    const std::string name = required_world_of(common, "WORLD", given);
    Caller caller{common};
    v1::Request request;
    request.mutable_delete_world()->set_world(name);
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] { return "deleted " + name + "\n"; });
}

void reset(const Common& common, std::optional<std::uint64_t> seed) {
    Caller caller{common};
    v1::Request request;
    request.mutable_reset_world()->set_world(common.world.empty() ? caller.world("").name() : common.world);
    if (seed) {
        request.mutable_reset_world()->set_seed(*seed);
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] {
        return "reset " + response.world().name() + ": seed " + std::to_string(response.world().seed()) +
               ", generation 1, " + state_of(response.world()) + "\n";
    });
}

struct ForkOptions {
    std::string origin, name;
    std::optional<std::uint64_t> at_generation;
};

void fork(const Common& common, const ForkOptions& options) {
    const std::string origin = world_of(common, "WORLD", options.origin);
    Caller caller{common};
    v1::Request request;
    auto& command = *request.mutable_fork_world();
    command.set_world(origin);
    command.set_name(options.name);
    if (options.at_generation) {
        command.set_at_generation(*options.at_generation);
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] {
        const bool kept = caller.welcome().durability() != v1::DURABILITY_NONE;
        return "forked " + response.world().name() + ": " + sentence(response.world()) + "\n" +
               (kept ? ""
                     : "it is not recorded, and ends with this server; `evod fork` creates a world from a run file\n");
    });
}

struct SeekOptions {
    std::optional<std::uint64_t> generation, tick;
};

void seek(const Common& common, const SeekOptions& options) {
    Caller caller{common};
    v1::Request request;
    auto& command = *request.mutable_seek();
    command.set_world(common.world);
    command.mutable_to(); // an empty moment means the last tick
    if (options.generation) {
        command.mutable_to()->set_generation(*options.generation);
    }
    if (options.tick) {
        command.mutable_to()->set_tick(*options.tick);
    }
    print_world(common, caller.call(std::move(request)));
}

void shut_down(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_shut_down();
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] { return std::string{"the server shuts down\n"}; });
}

// ---- running ---------------------------------------------------------------------------------------------------

/// The end of the generations that a world runs.
struct Goal {
    Durations durations;
    double simulated_s; // simulated seconds of the run when the goal is reached, at most
    double whole_s;     // simulated seconds from the beginning to the goal
};

/// Prints progress on stderr. On a terminal it overwrites a single line; otherwise it prints one line per generation.
class Progress {
  public:
    explicit Progress(std::optional<Goal> goal) : goal_{goal} {}
    ~Progress() {
        if (live_ && shown_) {
            std::cerr << '\n';
        }
    }
    void show(const v1::GenerationFinished& finished) {
        double best = 0, mean = 0;
        for (const auto& island : finished.statistics()) {
            best = island.island() == 0 ? island.fitness_best() : std::max(best, island.fitness_best());
            mean += island.fitness_mean() / finished.statistics_size();
        }
        if (finished.statistics_size() > 0) {
            last_ = "generation " + std::to_string(finished.statistics(0).generation()) + ": best " +
                    fitness_text(best) + ", mean " + fitness_text(mean);
            if (!live_) {
                std::cerr << visible(last_) << std::endl;
            } else if (!goal_) {
                print_live(last_);
            }
        }
    }
    /// Shows on a terminal how near the goal is. Prints that the world waits for fitness if it does so for long.
    void show(const v1::WorldInfo& world) {
        const std::uint64_t awaited = world.awaited_fitness().generation(); // 0: none
        if (awaited != 0 && awaited == awaited_ && std::exchange(awaited_reported_, awaited) != awaited) {
            std::cerr << (live_ && shown_ ? "\n" : "") << visible(world.name()) << " waits for fitness from a client: "
                      << core::to_text(world.awaited_fitness(), world.island_count()) << " in generation " << awaited
                      << std::endl;
            shown_ = false;
        }
        awaited_ = awaited;
        if (live_ && goal_ && goal_->whole_s > 0) {
            const double left_s = std::max(0.0, goal_->simulated_s - world.simulated_s());
            print_live(progress_text(1 - left_s / goal_->whole_s, real_s(world, goal_->durations, left_s)) +
                       (last_.empty() ? "" : "; " + last_));
        }
    }

    /// Prints the state of the storage if it differs from the state printed before.
    void show(const v1::Storage& storage) {
        const std::string trouble = core::to_text(storage);
        if (trouble != trouble_) {
            std::cerr << (live_ && shown_ ? "\n" : "")
                      << (trouble.empty() ? "run files can be written again" : visible(trouble)) << '\n'
                      << std::flush;
            shown_ = false;
        }
        trouble_ = trouble;
    }

  private:
    void print_live(const std::string& line) {
        std::cerr << "\r\033[K" << clip_lines(visible(line), terminal_size().columns - 1) << std::flush;
        shown_ = true;
    }

    const std::optional<Goal> goal_;
    const bool live_ = ::isatty(STDERR_FILENO) == 1;
    bool shown_ = false;
    std::string last_, trouble_; // last_: the generation that ended last
    // The generation that waited for fitness at the last poll, and the one about which this was printed; 0: none.
    std::uint64_t awaited_ = 0, awaited_reported_ = 0;
};

/// Waits until `reached(world)` returns true or the world stops running. Prints each generation when it ends.
///
/// goal     for the progress; nullopt: unknown.
/// returns  the final state of the world.
template <class Reached>
v1::WorldInfo wait_for(Caller& caller, const v1::WorldInfo& begun, const Reached& reached,
                       std::optional<Goal> goal = {}) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds poll_interval{500}; // polls the world too, because events may be lost
    catch_interrupts();
    Progress progress{goal};
    for (auto look_at = Clock::now();;) {
        if (interrupted()) {
            throw Stop{ExitCode::Refused, "stopped waiting; the world continues to run"};
        }
        if (Clock::now() >= look_at) {
            v1::WorldInfo world = caller.world(begun.name());
            if (world.run_id() != begun.run_id()) {
                throw Stop{ExitCode::Refused, begun.name() + " was reset before the run was over"};
            }
            progress.show(world.storage());
            progress.show(world);
            if (reached(world) || world.state() != v1::RUN_STATE_RUNNING) {
                for (const auto& event : caller.connection().take_events()) {
                    if (event.world() == begun.name() && event.has_generation_finished()) {
                        progress.show(event.generation_finished());
                    }
                }
                return world;
            }
            look_at = Clock::now() + poll_interval;
        }
        if (const auto event = caller.connection().wait_event(std::chrono::milliseconds{100});
            event && event->world() == begun.name()) {
            if (event->has_generation_finished()) {
                progress.show(event->generation_finished());
            } else {
                look_at = Clock::now();
            }
        }
    }
}

/// Throws Stop if the world stopped before it reached its goal.
void require_reached(bool reached, const v1::WorldInfo& world) {
    if (!reached) {
        throw Stop{ExitCode::Refused, "stopped before its goal: " + sentence(world)};
    }
}

Durations durations_of(Caller& caller, const std::string& world) {
    v1::Request request;
    request.mutable_get_parameters()->set_world(world);
    const v1::Response response = caller.call(std::move(request));
    Durations durations{};
    for (const auto& parameter : response.parameters().parameters()) {
        if (parameter.name() == "generation_s") {
            durations.generation_s = parameter.value().real();
        } else if (parameter.name() == "tick_s") {
            durations.tick_s = parameter.value().real();
        }
    }
    return durations;
}

/// Prints how long the world will need; returns its goal.
std::optional<Goal> announce(Caller& caller, const v1::WorldInfo& world, std::optional<std::uint64_t> generations) {
    const Durations durations = durations_of(caller, world.name());
    std::cerr << visible(plan_text(world, durations, generations)) << '\n';
    if (!generations) {
        return std::nullopt;
    }
    const double left_s = simulated_s_left(world, durations, *generations);
    return Goal{.durations = durations, .simulated_s = world.simulated_s() + left_s, .whole_s = left_s};
}

void run(const Common& common, std::optional<std::uint64_t> generations, bool wait) {
    Caller caller{common};
    v1::Request request;
    request.mutable_run()->set_world(common.world);
    if (generations) {
        request.mutable_run()->set_generations(*generations);
    }
    if (wait) {
        caller.connection().subscribe(v1::SubscribeEvents{});
    }
    v1::Response response = caller.call(std::move(request));
    if (wait) {
        const auto goal = announce(caller, response.world(), generations);
        const v1::WorldInfo world = wait_for(
            caller, response.world(), [](const v1::WorldInfo&) { return false; }, goal);
        *response.mutable_world() = world;
        print_world(common, response);
        // When a world has run all requested generations, it has no goal any more. A world that was paused before, or a
        // replay at its end, still has its goal.
        require_reached(!generations || !world.has_run_until_generation() || world.state() == v1::RUN_STATE_TERMINATED,
                        world);
    } else {
        print_world(common, response);
    }
}

/// Pauses the world, so that it stays paused after a step. A running world would continue when the lease of the step
/// ends.
v1::WorldInfo pause_world(const Common& common, Caller& caller) {
    v1::Request request;
    request.mutable_pause()->set_world(common.world);
    return caller.call(std::move(request)).world();
}

void until(const Common& common, Caller& caller, std::uint64_t tick, bool wait) {
    v1::Request request;
    request.mutable_run_until_tick()->set_world(common.world);
    request.mutable_run_until_tick()->set_tick(tick);
    if (wait) {
        caller.connection().subscribe(v1::SubscribeEvents{});
    }
    v1::Response response = caller.call(std::move(request));
    const auto reached = [&](const v1::WorldInfo& world) { return world.tick() >= tick; };
    if (wait && !reached(response.world())) {
        const v1::WorldInfo world = wait_for(caller, response.world(), reached);
        *response.mutable_world() = world;
    }
    print_world(common, response);
    require_reached(!wait || reached(response.world()) || response.world().state() == v1::RUN_STATE_TERMINATED,
                    response.world());
}

/// Runs the world until a tick. If the run has already passed this tick, throws Stop and leaves the world unchanged.
void run_until(const Common& common, Caller& caller, std::uint64_t tick, bool wait) {
    const auto require_ahead = [tick](std::uint64_t now) {
        if (tick < now) {
            throw Stop{ExitCode::Refused, "until: the run is at tick " + std::to_string(now) + " already; got " +
                                              std::to_string(tick) + ", allowed " + std::to_string(now) + " or more"};
        }
    };
    const v1::WorldInfo before = caller.world(common.world);
    require_ahead(before.tick());
    const std::uint64_t paused_at = pause_world(common, caller).tick();
    if (tick < paused_at && before.state() == v1::RUN_STATE_RUNNING) {
        v1::Request request;
        request.mutable_resume()->set_world(common.world);
        caller.call(std::move(request));
    }
    require_ahead(paused_at);
    until(common, caller, tick, wait);
}

void step(const Common& common, std::uint64_t ticks, bool wait) {
    Caller caller{common};
    // The request contains the tick at which to stop, so that a request that is sent twice has the same effect as one.
    until(common, caller, pause_world(common, caller).tick() + ticks, wait);
}

void pause(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_pause()->set_world(common.world);
    print_world(common, caller.call(std::move(request)));
}

void resume(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_resume()->set_world(common.world);
    print_world(common, caller.call(std::move(request)));
}

void set_speed(const Common& common, const std::string& word) {
    const v1::Speed speed = parse_speed(word);
    Caller caller{common};
    v1::Request request;
    request.mutable_set_speed()->set_world(common.world);
    *request.mutable_set_speed()->mutable_speed() = speed;
    print_world(common, caller.call(std::move(request)));
}

void add_world_commands(command_line::Command& app, const Common& common) {
    const char* const group = "Worlds";
    auto& create_command = app.add_command("create", "Create a world; `run` starts it").group(group);
    auto& options = create_command.keep(CreateOptions{});
    create_command.add_option("NAME", &options.name,
                              "Name of the world: 1 to 64 characters of a-z A-Z 0-9 _ -; default: that of --world");
    create_command
        .add_option("--seed", &options.seed,
                    "Seed; default: the seed in the --experiment file, otherwise a random seed")
        .check(whole_number);
    create_command.add_option("--set", &options.words,
                              "Parameters as NAME=VALUE; all other parameters keep their defaults");
    create_command.add_option("--experiment", &options.experiment,
                              "JSON file of parameters and optionally a seed; --set and --seed override it");
    create_command.add_option("--population", &options.population,
                              "CSV file with the first population, from `evod export --what population`");
    create_command.footer("Examples:\n  evoctl create lesson --experiment experiments/classic.json --seed 7\n"
                          "  evoctl create big --set population_size=10000 scale_with_population=true");
    create_command.action([&] { create(common, options); });

    auto& delete_command = app.add_command("delete", "Remove a world and its history").group(group);
    auto& name = delete_command.keep(std::string{});
    delete_command.add_option("WORLD", &name, "Name of the world; default: the world of --world");
    delete_command.action([&] { remove(common, name); });

    auto& fork_command =
        app.add_command("fork", "Create a copy of a world at a generation or at the current tick; `run` starts it")
            .group(group);
    auto& fork_options = fork_command.keep(ForkOptions{});
    fork_command.add_option("WORLD", &fork_options.origin, "Name of the original world; default: the world of --world");
    fork_command
        .add_option("--name", &fork_options.name, "Name of the new world: 1 to 64 characters of a-z A-Z 0-9 _ -")
        .required();
    fork_command
        .add_option("--at-generation", &fork_options.at_generation,
                    "Start at the first tick of this generation; default: the current tick")
        .check(at_least_one);
    fork_command.footer("Example, a paired experiment with the same random numbers:\n  evoctl fork lesson "
                        "--at-generation 20 --name calm\n"
                        "  evoctl --world calm set mutation_chance=0.01");
    fork_command.action([&] { fork(common, fork_options); });

    auto& seek_command =
        app.add_command("seek", "Move a replay (see `evod replay`) to another tick; default: its last tick")
            .group(group);
    auto& seek_options = seek_command.keep(SeekOptions{});
    seek_command
        .add_option("--generation", &seek_options.generation,
                    "Generation to move to: its first tick, or the tick given by --tick")
        .check(whole_number);
    seek_command
        .add_option("--tick", &seek_options.tick,
                    "Tick to move to, counted from the start of --generation or of the run")
        .check(whole_number);
    seek_command.action([&] { seek(common, seek_options); });

    auto& reset_command =
        app.add_command("reset", "Start again at generation 1, with the current parameters").group(group);
    auto& seed = reset_command.keep(std::optional<std::uint64_t>{});
    reset_command.add_option("--seed", &seed, "Seed of the new run; default: the same seed").check(whole_number);
    reset_command.action([&] { reset(common, seed); });
}

} // namespace

void add_run_commands(command_line::Command& app, const Common& common) {
    add_world_commands(app, common);
    const char* const group = "Run";
    app.add_command("start", "Run one generation").group(group).action([&] { run(common, 1, false); });

    auto& run_command = app.add_command("run", "Run N more generations, or until paused").group(group);
    auto& generations = run_command.keep(std::optional<std::uint64_t>{});
    auto& run_wait = run_command.keep(false);
    run_command
        .add_option("N", &generations,
                    "Number of generations; default: until the world is paused or meets a termination criterion")
        .check(at_least_one);
    run_command.add_flag("--wait", &run_wait,
                         "Return when the generations have ended; Ctrl-C stops waiting, not the run");
    run_command.footer("Examples:\n  evoctl run 100 --wait && evoctl history --csv > fitness.csv\n"
                       "  evoctl run --world lesson");
    run_command.action([&] { run(common, generations, run_wait); });

    app.add_command("shutdown", "Stop the server, as SIGTERM does").group("Worlds").action([&] { shut_down(common); });
    app.add_command("pause", "Pause a world").group(group).action([&] { pause(common); });
    app.add_command("resume", "Continue after a pause").group(group).action([&] { resume(common); });

    auto& step_command = app.add_command("step", "Run N ticks, then pause; returns after the last tick").group(group);
    auto& ticks = step_command.keep(std::uint64_t{1});
    auto& no_wait = step_command.keep(false);
    step_command.add_option("N", &ticks, "Number of ticks; default: 1").check([](const std::string& word) {
        const std::string fault = at_least_one(word);
        return fault.empty() || !word.starts_with('-')
                   ? fault
                   : fault + "; a run does not go back: evod replay and the time line of the page show earlier moments";
    });
    step_command.add_flag("--no-wait", &no_wait, "Return immediately");
    step_command.action([&] { step(common, ticks, !no_wait); });

    auto& until_command = app.add_command("until", "Run to tick TICK, then pause").group(group);
    auto& tick = until_command.keep(std::uint64_t{0});
    auto& until_wait = until_command.keep(false);
    until_command.add_option("TICK", &tick, "Ticks since the run began").required().check(whole_number);
    until_command.add_flag("--wait", &until_wait, "Return when the tick is reached");
    until_command.action([&] {
        Caller caller{common};
        run_until(common, caller, tick, until_wait);
    });

    auto& speed_command = app.add_command("speed", "Set the speed of a world").group(group);
    auto& word = speed_command.keep(std::string{});
    speed_command.add_option("SPEED", &word, "Simulated seconds per second of real time, 0.001 to 10000, or max")
        .required();
    speed_command.footer("Examples:\n  evoctl speed 2\n  evoctl speed 1/4\n  evoctl speed max");
    speed_command.action([&] { set_speed(common, word); });
}

} // namespace evod::ctl
