// Commands that only read: status, worlds, stats, history, organism, best, describe.
#include "client/core/change_text.h"
#include "client/core/history_csv.h"
#include "client/ctl/caller.h"
#include "client/ctl/text.h"
#include "proto/codec/gene_texts.h"
#include "proto/command_line/command.h"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace evod::ctl {

namespace {

using Align = Table::Align;

v1::WorldList worlds_of(Caller& caller) {
    v1::Request request;
    request.mutable_list_worlds();
    return caller.call(std::move(request)).worlds();
}

void status(const Common& common) {
    Caller caller{common};
    v1::WorldList worlds = worlds_of(caller);
    if (!common.world.empty()) {
        v1::WorldList only;
        *only.add_worlds() = caller.world(common.world); // throws Stop if there is no world with this name
        worlds = std::move(only);
    }
    print(common, worlds, [&] {
        std::vector<Table::Column> columns{{"WORLD"},
                                           {"STATE"},
                                           {"SPEED", Align::Right},
                                           {"GENERATION", Align::Right},
                                           {"TICK", Align::Right},
                                           {"SIMULATED", Align::Right},
                                           {"TICKS/S", Align::Right},
                                           {"ISLANDS", Align::Right},
                                           {"SEED", Align::Right}};
        const bool owned = std::ranges::any_of(
            worlds.worlds(), [](const v1::WorldInfo& world) { return !(world.owner() + world.class_()).empty(); });
        if (owned) {
            columns.insert(columns.end(), {{"CLASS"}, {"OWNER"}});
        }
        Table table{columns};
        std::map<std::string, std::vector<std::string>> rows; // by name
        std::string reasons;
        for (const auto& world : worlds.worlds()) {
            rows[world.name()] = {world.name(),
                                  colored_state_of(world),
                                  speed_of(world),
                                  std::to_string(world.generation()),
                                  std::to_string(world.tick()),
                                  duration(world.simulated_s()),
                                  fixed(world.ticks_per_s(), 0),
                                  std::to_string(world.island_count()),
                                  std::to_string(world.seed())};
            if (owned) {
                rows[world.name()].insert(rows[world.name()].end(), {world.class_(), world.owner()});
            }
        }
        for (const auto& world : worlds.damaged()) {
            rows[world.name()] = {world.name(), in_color("damaged", Color::Red)};
            rows[world.name()].resize(columns.size(), "-");
            reasons += in_color(world.name() + " does not run: " + world.reason(), Color::Yellow) + "\n";
        }
        for (const auto& [name, row] : rows) {
            table.add(row);
        }
        std::string text = "evod " + caller.welcome().server_version() + " at " +
                           core::to_text(*core::parse_endpoint(common.server)) + "\n";
        const bool only_replays =
            !worlds.worlds().empty() && std::ranges::all_of(worlds.worlds(), &v1::WorldInfo::has_replay);
        if (only_replays) {
            text += "it shows a stored run, which it does not change\n";
        }
        for (const std::string& line : {only_replays ? std::string{} : durability_warning(caller.welcome()),
                                        core::to_text(caller.welcome().storage())}) {
            text += line.empty() ? "" : in_color(line, Color::Yellow) + "\n";
        }
        return text + reasons + (rows.empty() ? "no worlds: create one with `evoctl create NAME`\n" : table.to_text());
    });
}

void list_worlds(const Common& common) {
    Caller caller{common};
    const v1::WorldList worlds = worlds_of(caller);
    print(common, worlds, [&] {
        std::set<std::string> names;
        for (const auto& world : worlds.worlds()) {
            names.insert(world.name());
        }
        for (const auto& world : worlds.damaged()) {
            names.insert(world.name());
            std::cerr << visible(world.name() + " does not run: " + world.reason()) << '\n';
        }
        std::string text;
        for (const std::string& name : names) {
            text += name + "\n";
        }
        return text;
    });
}

std::string gene_text(const google::protobuf::RepeatedPtrField<v1::GeneStatistics>& genes, const v1::WorldInfo& world) {
    Table table{{{"GENE"},
                 {"MEAN", Align::Right},
                 {"DEVIATION", Align::Right},
                 {"MIN", Align::Right},
                 {"MAX", Align::Right},
                 {"CHANGE", Align::Right},
                 {"SELECTION", Align::Right},
                 {"TRANSMISSION", Align::Right},
                 {"MIGRATION", Align::Right}}};
    for (int i = 0; i < genes.size(); ++i) {
        const auto& gene = genes[i];
        const auto moved = [&gene](double by) { return gene.has_account() ? fixed(by, 2) : std::string{"-"}; };
        table.add({i < world.gene_names_size() ? world.gene_names(i) : std::to_string(i), fixed(gene.mean(), 1),
                   fixed(gene.deviation(), 1), fixed(gene.min(), 1), fixed(gene.max(), 1),
                   moved(gene.account().change()), moved(gene.account().selection()),
                   moved(gene.account().transmission()), moved(gene.account().migration())});
    }
    return table.to_text();
}

/// Returns a row for each generation and island. Without bodies, no organism lives or dies: the columns for that are
/// missing. Only colonies have the last columns.
std::string generation_text(const google::protobuf::RepeatedPtrField<v1::GenerationStatistics>& generations) {
    const core::ColonyColumns with = core::colony_columns_of(generations);
    const bool bodies = std::ranges::any_of(generations, [](const v1::GenerationStatistics& g) {
        return g.alive_count() + g.starved_count() + g.poisoned_count() > 0;
    });
    std::vector<Table::Column> columns;
    for (const char* const title : {"GENERATION", "ISLAND", "BEST", "MEAN", "MEDIAN", "WORST", "DIVERSITY"}) {
        columns.push_back({title, Align::Right});
    }
    for (const char* const title : {"ALIVE", "STARVED", "POISONED", "LENGTH"}) {
        if (bodies) {
            columns.push_back({title, Align::Right});
        }
    }
    for (const char* const title : {"BORN", "OLD", "EATEN"}) {
        if (with.colony) {
            columns.push_back({title, Align::Right});
        }
    }
    if (with.predators) {
        columns.push_back({"PREDATORS", Align::Right});
    }
    Table table{std::move(columns)};
    for (const v1::GenerationStatistics& g : generations) {
        std::vector<std::string> row{std::to_string(g.generation()),   std::to_string(g.island()),
                                     fitness_text(g.fitness_best()),   fitness_text(g.fitness_mean()),
                                     fitness_text(g.fitness_median()), fitness_text(g.fitness_worst()),
                                     fixed(g.diversity(), 3)};
        if (bodies) {
            row.insert(row.end(), {std::to_string(g.alive_count()) + "/" + std::to_string(g.organism_count()),
                                   std::to_string(g.starved_count()), std::to_string(g.poisoned_count()),
                                   duration(g.simulated_s())});
        }
        if (with.colony) {
            row.insert(row.end(), {std::to_string(g.colony().born_count()), std::to_string(g.colony().old_count()),
                                   std::to_string(g.colony().eaten_count())});
        }
        if (with.predators) {
            row.push_back(std::to_string(g.predators().alive_count()));
        }
        table.add(std::move(row));
    }
    return table.to_text();
}

/// Returns a row for each island. Only colonies have the last columns.
std::string live_text(const google::protobuf::RepeatedPtrField<v1::LiveStatistics>& islands) {
    std::vector<Table::Column> columns;
    for (const char* const title : {"ISLAND", "ALIVE", "HEALTH", "STARVED", "POISONED", "FOOD EATEN", "POISON EATEN"}) {
        columns.push_back({title, Align::Right});
    }
    const bool colony = std::ranges::any_of(islands, [](const v1::LiveStatistics& of) {
        return of.born_count() + of.old_count() + of.eaten_count() + of.predator_count() > 0;
    });
    for (const char* const title : {"BORN", "OLD", "EATEN", "PREDATORS"}) {
        if (colony) {
            columns.push_back({title, Align::Right});
        }
    }
    Table table{std::move(columns)};
    for (const v1::LiveStatistics& of : islands) {
        std::vector<std::string> row{std::to_string(of.island()),
                                     std::to_string(of.alive_count()) + "/" + std::to_string(of.organism_count()),
                                     fixed(of.health_mean(), 1),
                                     std::to_string(of.starved_count()),
                                     std::to_string(of.poisoned_count()),
                                     std::to_string(of.food_eaten()),
                                     std::to_string(of.poison_eaten())};
        if (colony) {
            row.insert(row.end(), {std::to_string(of.born_count()), std::to_string(of.old_count()),
                                   std::to_string(of.eaten_count()), std::to_string(of.predator_count())});
        }
        table.add(std::move(row));
    }
    return table.to_text();
}

/// Options that select a moment of a run by generation and tick; by default the current moment.
struct MomentOptions {
    std::optional<std::uint64_t> generation, tick;
    bool is_replay() const { return generation || tick; }
};

void add_options(command_line::Command& command, MomentOptions& options) {
    command
        .add_option("--at-generation", &options.generation, "Show this generation at its first tick, or at --at-tick")
        .check(at_least_one);
    command
        .add_option("--at-tick", &options.tick,
                    "Show the state after this tick, counted from the start of --at-generation or of the run")
        .check(whole_number);
}

/// Returns the name of the world. For an earlier moment, opens a replay at that moment and returns the name of the
/// replay, which ends with this call of evoctl.
std::string world_at(Caller& caller, const Common& common, const MomentOptions& options) {
    if (!options.is_replay()) {
        return common.world;
    }
    v1::Request request;
    auto& replay = *request.mutable_open_replay();
    replay.set_world(common.world);
    if (options.generation) {
        replay.mutable_at()->set_generation(*options.generation);
    }
    if (options.tick) {
        replay.mutable_at()->set_tick(*options.tick);
    }
    return caller.call(std::move(request)).world().name();
}

/// Describes the moment that a replay shows: "default as it was: generation 4, tick 9000 (2:30 min)".
std::string replay_sentence(const v1::WorldInfo& world) {
    return world.replay().replay_of() + " as it was: generation " + std::to_string(world.generation()) + ", tick " +
           std::to_string(world.tick()) + " (" + duration(world.simulated_s()) + ")";
}

void statistics(const Common& common, const MomentOptions& moment) {
    Caller caller{common};
    v1::Request request;
    request.mutable_get_statistics()->set_world(world_at(caller, common, moment));
    const v1::Statistics statistics = caller.call(std::move(request)).statistics();
    print(common, statistics, [&] {
        std::string text = (moment.is_replay() ? replay_sentence : sentence)(statistics.world()) + "\n";
        if (const std::string trouble = core::to_text(statistics.world().storage()); !trouble.empty()) {
            text += trouble + "\n";
        }
        if (statistics.live_size() > 0) {
            text += (moment.is_replay() ? "\nthen\n" : "\nnow\n") + live_text(statistics.live());
        }
        if (statistics.last_size() > 0) {
            text += (moment.is_replay() ? "\nthe last generation before\n" : "\nthe last generation\n") +
                    generation_text(statistics.last());
            for (const auto& island : statistics.last()) {
                text += "\ngenes of its island " + std::to_string(island.island()) + "\n" +
                        gene_text(island.genes(), statistics.world());
                if (island.has_predators()) {
                    text += "\ngenes of the predators of its island " + std::to_string(island.island()) + "\n" +
                            gene_text(island.predators().genes(), statistics.world());
                }
            }
        }
        return text;
    });
}

// ---- history ---------------------------------------------------------------------------------------------------

struct HistoryOptions {
    bool csv = false;
    std::optional<std::uint64_t> from, to;
    std::optional<std::uint32_t> island;
};

v1::History history_of(Caller& caller, const Common& common, const HistoryOptions& options) {
    v1::GetHistory wanted;
    wanted.set_world(common.world);
    if (options.from) {
        wanted.set_first_generation(*options.from);
    }
    if (options.to) {
        wanted.set_last_generation(*options.to);
    }
    if (options.island) {
        wanted.set_island(*options.island);
    }
    return caller.history(std::move(wanted));
}

std::string csv_of(const v1::History& history, const v1::WorldInfo& world) {
    const core::ColonyColumns with = core::colony_columns_of(history.generations());
    std::string text = core::history_heading({world.gene_names().begin(), world.gene_names().end()}, with);
    for (const auto& generation : history.generations()) {
        text += core::history_line(core::history_numbers(generation, with));
    }
    return text;
}

void history(const Common& common, const HistoryOptions& options) {
    if (options.from && options.to && *options.from > *options.to) {
        throw Stop{ExitCode::Usage,
                   "--from " + std::to_string(*options.from) + " is after --to " + std::to_string(*options.to)};
    }
    Caller caller{common};
    const v1::History all = history_of(caller, common, options);
    print(common, all, [&] {
        if (options.csv) {
            return csv_of(all, caller.world(common.world));
        }
        std::string text = all.generations().empty()
                               ? std::string{"no such generation has ended, or its statistics were purged\n"}
                               : generation_text(all.generations());
        for (const v1::AppliedChange& change : all.changes()) {
            text += core::to_text(change) + "\n";
        }
        return text;
    });
}

// ---- organism, best, describe ----------------------------------------------------------------------------------

struct OrganismOptions {
    std::uint32_t id = 0, island = 0;
    MomentOptions moment;
};

/// What an organism is about to do: "seeks food at 120.0, 40.0 px".
std::string choice_text(const v1::OrganismInfo& info) {
    const std::string target = " at " + fixed(info.target_x_px(), 1) + ", " + fixed(info.target_y_px(), 1) + " px";
    switch (info.choice()) {
    case v1::CHOICE_WANDER:
        return "wanders";
    case v1::CHOICE_SEEK:
        return (info.species() == v1::SPECIES_PREDATOR ? "hunts prey" : "seeks food") + target;
    case v1::CHOICE_FLEE:
        return (info.flees_predator() ? "flees from the predator" : "flees from poison") + target;
    case v1::CHOICE_STEER:
        return "steers with its neural network";
    default:
        return "";
    }
}

/// The activations of the network, a line per layer: "  inputs: food_bearing 0.21, food_proximity 0.40".
std::string brain_text(const v1::Brain& brain) {
    const auto layer = [](const std::string& title, const auto& values, const auto& name) {
        std::string text = "  " + title + ": ";
        for (int i = 0; i < values.size(); ++i) {
            text += (i == 0 ? "" : ", ") + name(i) + " " + fixed(double{values.Get(i)}, 3);
        }
        return text + "\n";
    };
    const auto named = [](const auto& names) {
        return [&names](int i) { return i < names.size() ? names.Get(i) : std::to_string(i); };
    };
    return layer("inputs", brain.inputs(), named(brain.input_names())) +
           layer("hidden", brain.hidden(), [](int i) { return "hidden" + std::to_string(i + 1); }) +
           layer("outputs", brain.outputs(), named(brain.output_names()));
}

/// Returns what only organisms of colonies have: the species; with births number, age and children.
std::string colony_text(const v1::OrganismInfo& info) {
    std::string text;
    if (info.species() == v1::SPECIES_PREDATOR) {
        text += "  a predator" +
                (info.handling_s() > 0 ? ", hunts again in " + fixed(info.handling_s(), 1) + " s" : std::string{}) +
                "\n";
    }
    if (info.has_number()) {
        text += "  number " + std::to_string(info.number()) + ", age " + duration(info.age_s()) + ", " +
                std::to_string(info.children()) + (info.children() == 1 ? " child\n" : " children\n");
    }
    return text;
}

void organism(const Common& common, const OrganismOptions& options) {
    Caller caller{common};
    const std::string name = world_at(caller, common, options.moment);
    v1::Request request;
    request.mutable_get_organism()->set_world(name);
    request.mutable_get_organism()->set_organism(options.id);
    request.mutable_get_organism()->set_island(options.island);
    const v1::OrganismInfo info = caller.call(std::move(request)).organism();
    print(common, info, [&] {
        const v1::WorldInfo world = caller.world(name);
        std::string text = (options.moment.is_replay() ? replay_sentence(world) + "\n" : "") + "organism " +
                           std::to_string(info.id()) + " of island " + std::to_string(info.island()) + ", generation " +
                           std::to_string(info.generation()) + ": ";
        if (info.alive()) {
            text += "alive, health " + fixed(info.health(), 1);
        } else {
            text += info.cause_of_death() == v1::CAUSE_OF_DEATH_REMOVED    ? "removed"
                    : info.cause_of_death() == v1::CAUSE_OF_DEATH_POISONED ? "poisoned"
                    : info.cause_of_death() == v1::CAUSE_OF_DEATH_EATEN    ? "eaten"
                    : info.cause_of_death() == v1::CAUSE_OF_DEATH_OLD      ? "died of old age"
                                                                           : "starved";
        }
        const bool predator = info.species() == v1::SPECIES_PREDATOR;
        text += ", lived " + duration(info.lived_s()) + "\n  ate " + std::to_string(info.food_eaten()) +
                (predator ? " prey" : " food and " + std::to_string(info.poison_eaten()) + " poison") + "\n" +
                colony_text(info);
        if (info.alive()) {
            text += "  at " + fixed(info.x_px(), 1) + ", " + fixed(info.y_px(), 1) + " px, moving " +
                    fixed(info.velocity_x_px_s(), 1) + ", " + fixed(info.velocity_y_px_s(), 1) + " px/s";
            if (info.has_heading()) {
                constexpr double degrees_per_radian = 57.29577951308232;
                text += ", heading " + fixed(info.heading() * degrees_per_radian, 1) + "°";
            }
            text += "\n";
            if (const std::string choice = choice_text(info); !choice.empty()) {
                text += "  next tick: " + choice + "\n";
            }
        }
        if (info.has_brain()) {
            text += brain_text(info.brain());
        }
        if (info.has_placed_tick()) {
            text += (info.parents_size() > 0 ? "  born after tick " : "  placed after tick ") +
                    std::to_string(info.placed_tick()) + " of its generation\n";
        }
        text += "  radius " + fixed(info.radius_px(), 2) + " px, mass " + fixed(info.mass_kg(), 2) + " kg\n";
        if (info.parents_size() > 0) {
            text += info.has_placed_tick() ? "  parents in this generation:"
                    : info.has_number()    ? "  its id in the generation before:"
                                           : "  parents in the generation before:";
            for (const std::uint32_t parent : info.parents()) {
                text += " " + std::to_string(parent);
            }
            text += "\n";
        }
        const codec::GeneTexts texts{world};
        Table genes{{{"  GENE"}, {"VALUE", Align::Right}}};
        for (int i = 0; i < info.genes_size(); ++i) {
            genes.add({"  " + (i < world.gene_names_size() ? world.gene_names(i) : std::to_string(i)),
                       texts.text_of(static_cast<std::size_t>(i), info.genes(i), fixed(info.genes(i), 2))});
        }
        return text + genes.to_text();
    });
}

/// Shows the organism with the best fitness of all ended generations, the first one of several.
void best(const Common& common, const HistoryOptions& options) {
    Caller caller{common};
    const v1::History all = history_of(caller, common, options);
    const auto& rows = all.generations();
    const auto top =
        std::ranges::max_element(rows, {}, [](const v1::GenerationStatistics& row) { return row.fitness_best(); });
    if (top == rows.end()) {
        throw Stop{ExitCode::Refused, "no such generation has ended, or its statistics were purged"};
    }
    v1::Request request;
    auto& wanted = *request.mutable_get_organism();
    wanted.set_world(world_at(caller, common, {.generation = top->generation(), .tick = std::nullopt}));
    wanted.set_organism(top->best_organism());
    wanted.set_island(top->island());
    const std::string replay = wanted.world();
    const v1::OrganismInfo info = caller.call(std::move(request)).organism();
    print(common, info, [&] {
        const v1::WorldInfo world = caller.world(replay);
        const codec::GeneTexts texts{world};
        Table genes{{{"GENE"}, {"VALUE", Align::Right}}};
        for (int i = 0; i < info.genes_size(); ++i) {
            genes.add(
                {i < world.gene_names_size() ? world.gene_names(i) : std::to_string(i),
                 texts.text_of(static_cast<std::size_t>(i), info.genes(i), text::rounded(double{info.genes(i)}, 6))});
        }
        return "fitness " + fitness_text(top->fitness_best()) + ": organism " + std::to_string(info.id()) +
               " of island " + std::to_string(info.island()) + ", generation " + std::to_string(info.generation()) +
               "\n" + genes.to_text();
    });
}

void describe(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_describe();
    const v1::Description description = caller.call(std::move(request)).description();
    print(common, description, [&] {
        const v1::Welcome& welcome = caller.welcome();
        std::string text = "evod " + welcome.server_version() + ", protocol version " +
                           std::to_string(welcome.protocol_version()) + ", instance " + welcome.instance_id() +
                           "\nfeatures:";
        for (const std::string& feature : welcome.features()) {
            text += " " + feature;
        }
        text += "\n" + std::to_string(description.parameters_size()) +
                " parameters: see `evoctl params`\nthe protocol's own description: " +
                std::to_string(description.file_descriptor_set().size()) + " bytes, in --json\n\n";
        Table limits{{{"LIMIT"}, {"VALUE", Align::Right}}};
        const auto* descriptor = v1::Limits::descriptor();
        for (int i = 0; i < descriptor->field_count(); ++i) {
            std::string value;
            google::protobuf::TextFormat::PrintFieldValueToString(description.limits(), descriptor->field(i), -1,
                                                                  &value);
            limits.add({descriptor->field(i)->name(), value});
        }
        return text + limits.to_text();
    });
}

} // namespace

void add_query_commands(command_line::Command& app, const Common& common) {
    const char* const group = "Look";
    app.add_command("status", "Show a summary of the server and its worlds").group(group).action([&] {
        status(common);
    });
    app.add_command("worlds", "List the names of all worlds, one per line").group(group).action([&] {
        list_worlds(common);
    });

    auto& stats =
        app.add_command("stats", "Show statistics of a world: its current state and its last generation").group(group);
    auto& moment = stats.keep(MomentOptions{});
    add_options(stats, moment);
    stats.footer("Examples:\n  evoctl stats\n  evoctl stats --at-generation 12 --at-tick 600");
    stats.action([&] { statistics(common, moment); });

    auto& history_command =
        app.add_command("history", "Show the statistics of ended generations, and the changes of parameters")
            .group(group);
    auto& options = history_command.keep(HistoryOptions{});
    history_command.add_flag("--csv", &options.csv, "Comma-separated values, with every column and the genes");
    history_command.add_option("--from", &options.from, "First generation; default: the oldest available generation")
        .check(whole_number);
    history_command.add_option("--to", &options.to, "Last generation; default: the last generation that has ended")
        .check(whole_number);
    history_command.add_option("--island", &options.island, "Show only this island, numbered from 0")
        .check(index_number);
    history_command.footer("Examples:\n  evoctl history --from 10 --to 20\n  evoctl history --csv > fitness.csv");
    history_command.action([&] { history(common, options); });

    auto& command = app.add_command("organism", "Show an organism: its genes, life and parents").group(group);
    auto& wanted = command.keep(OrganismOptions{});
    command.add_option("ID", &wanted.id, "Number of the organism in its generation, from 0, in order of birth")
        .required()
        .check(index_number);
    command.add_option("--island", &wanted.island, "Island, numbered from 0").check(index_number);
    add_options(command, wanted.moment);
    command.footer("Examples:\n  evoctl organism 12\n  evoctl organism 12 --at-generation 3 --at-tick 600");
    command.action([&] { organism(common, wanted); });

    auto& best_command =
        app.add_command("best", "Show the organism with the best fitness of all ended generations, and its genes")
            .group(group);
    auto& among = best_command.keep(HistoryOptions{});
    best_command.add_option("--from", &among.from, "First generation; default: the oldest available generation")
        .check(whole_number);
    best_command.add_option("--to", &among.to, "Last generation; default: the last generation that has ended")
        .check(whole_number);
    best_command.add_option("--island", &among.island, "Only this island, numbered from 0").check(index_number);
    best_command.footer("Examples:\n  evoctl best\n  evoctl best --from 10 --to 20 --island 1");
    best_command.action([&] { best(common, among); });

    app.add_command("describe", "Show the server's version, features and limits").group(group).action([&] {
        describe(common);
    });
}

} // namespace evod::ctl
