// evoctl breeding: prints how a generation was bred.
#include "client/ctl/caller.h"
#include "client/ctl/text.h"
#include "proto/codec/descendant.h"
#include "proto/codec/gene_texts.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <cstdio>

namespace evod::ctl {

namespace {

using Align = Table::Align;

// The timeout is long because the server may first have to simulate a purged generation again.
constexpr std::chrono::minutes answer_timeout{30};

struct BreedingOptions {
    std::optional<std::uint64_t> generation;
    std::uint32_t island = 0;
    std::uint32_t from = 0;
    int rows = 10;
};

std::string heading(const v1::Breeding& bred) {
    const auto count = [](std::uint32_t number, const char* one, const char* many) {
        return std::to_string(number) + " " + (number == 1 ? one : many);
    };
    std::string text = "generation " + std::to_string(bred.generation()) + " of island " +
                       std::to_string(bred.island()) + ": " + count(bred.contender_count(), "organism", "organisms") +
                       ", " + count(bred.pick_count(), "pick", "picks") +
                       "; the next generation: " + std::to_string(bred.elite_count()) + " elite, " +
                       count(bred.survivor_count() - bred.elite_count(), "other survivor", "other survivors") + ", " +
                       count(bred.descendant_count() - bred.survivor_count(), "child", "children") + "\n";
    std::string choices; // the values of the parameters that applied
    for (const auto& parameter : bred.parameters()) {
        if (parameter.value().has_choice() && parameter.name() != "emigrants" &&
            parameter.name() != "immigrants_replace") {
            choices += (choices.empty() ? "" : ", ") + parameter.name() + "=" + parameter.value().choice();
        }
        if (parameter.name() == "shuffle_fitness" && parameter.value().flag()) {
            choices += (choices.empty() ? "" : ", ") + parameter.name() + "=true";
        }
    }
    return text + choices + "\n";
}

/// Returns a line about the rows that are not shown: "and 15 more: --from 10".
std::string more_text(std::uint64_t first, int shown, std::uint32_t count) {
    const std::uint64_t next = first + static_cast<std::uint64_t>(shown);
    return next >= count ? "" : "and " + std::to_string(count - next) + " more: --from " + std::to_string(next) + "\n";
}

std::string contender_text(const v1::Breeding& bred, const BreedingOptions& options) {
    // If the fitness was shuffled, the organism's own fitness is printed too.
    const bool shuffled = bred.contenders_size() > 0 && bred.contenders(0).has_own_fitness();
    std::vector<Table::Column> columns{{"ORGANISM", Align::Right},
                                       {shuffled ? "SHUFFLED" : "FITNESS", Align::Right},
                                       {"RANK", Align::Right},
                                       {"WEIGHT", Align::Right},
                                       {"SLOT, TURNS"},
                                       {"EXPECTED", Align::Right},
                                       {"PICKED", Align::Right},
                                       {"CAME FROM"}};
    if (shuffled) {
        columns.insert(columns.begin() + 1, {"OWN FITNESS", Align::Right});
    }
    Table table{std::move(columns)};
    const int shown = std::min(options.rows, bred.contenders_size());
    for (int i = 0; i < shown; ++i) {
        const auto& c = bred.contenders(i);
        std::vector<std::string> cells{std::to_string(options.from + static_cast<std::uint32_t>(i)),
                                       fitness_text(c.fitness()),
                                       std::to_string(c.rank() + 1),
                                       fixed(c.weight(), 3),
                                       c.slot_end() > 0 ? fixed(c.slot_begin(), 4) + "–" + fixed(c.slot_end(), 4) : "",
                                       fixed(c.expected_copies(), 2),
                                       std::to_string(c.copies()),
                                       c.has_migrant() ? "island " + std::to_string(c.migrant().island()) +
                                                             ", organism " + std::to_string(c.migrant().organism())
                                                       : ""};
        if (shuffled) {
            cells.insert(cells.begin() + 1, fitness_text(c.own_fitness()));
        }
        table.add(std::move(cells));
    }
    return "\ncontenders\n" + table.to_text() + more_text(options.from, shown, bred.contender_count());
}

std::string pick_text(const v1::Breeding& bred, const BreedingOptions& options) {
    Table table{{{"PICK", Align::Right}, {"ORGANISM", Align::Right}, {"HOW"}}};
    const int shown = std::min(options.rows, bred.picks_size());
    for (int i = 0; i < shown; ++i) {
        const auto& pick = bred.picks(i);
        std::string how;
        if (pick.has_turns()) {
            how = "the wheel stopped at " + fixed(pick.turns(), 4) + " turns";
        } else if (pick.has_tournament()) {
            how = "won tournament " + std::to_string(pick.tournament());
            for (int k = 0; k < pick.contestants_size(); ++k) {
                how += (k == 0 ? " of " : ", ") + std::to_string(pick.contestants(k));
            }
        }
        table.add({std::to_string(options.from + static_cast<std::uint32_t>(i)), std::to_string(pick.organism()), how});
    }
    return "\npicks\n" + table.to_text() + more_text(options.from, shown, bred.pick_count());
}

std::string name_of(v1::MutationKind kind) {
    switch (kind) {
    case v1::MUTATION_KIND_CREEP:
        return "creep";
    case v1::MUTATION_KIND_RESET:
        return "reset";
    case v1::MUTATION_KIND_SCALE:
        return "scale";
    case v1::MUTATION_KIND_BIT_FLIP:
        return "bit flip";
    case v1::MUTATION_KIND_CLAMP:
        return "onto its bound";
    case v1::MUTATION_KIND_REFLECT:
        return "mirrored at its bound";
    case v1::MUTATION_KIND_REDRAW:
        return "drawn again";
    default:
        return "mutation " + std::to_string(kind);
    }
}

/// Returns how crossover and mutation changed a descendant's genes: "swap 1 2 0 3 4 5; impulse 93.21 → 97.10 creep".
std::string changes_of(const v1::Descendant& descendant, const v1::WorldInfo& world) {
    std::string text;
    if (descendant.has_order_mutation()) {
        text = descendant.order_mutation().method();
        for (const std::uint32_t gene : descendant.order_mutation().order()) {
            text += " " + std::to_string(gene);
        }
    }
    const codec::GeneTexts texts{world};
    const auto value_of = [&](std::uint32_t gene, float value) { return texts.text_of(gene, value, fixed(value, 2)); };
    for (const auto& mutation : descendant.mutations()) {
        const auto gene = static_cast<int>(mutation.gene());
        text += (text.empty() ? "" : "; ") +
                (gene < world.gene_names_size() ? world.gene_names(gene) : std::to_string(gene)) + " " +
                value_of(mutation.gene(), mutation.before()) + " → " + value_of(mutation.gene(), mutation.after()) +
                " " + name_of(mutation.kind());
    }
    return text;
}

std::string descendant_text(const v1::Breeding& bred, const v1::WorldInfo& world, const BreedingOptions& options) {
    Table table{{{"ID", Align::Right}, {"KIND"}, {"PARENTS"}, {"GENES OF"}, {"CHANGES"}}};
    const int shown = std::min(options.rows, bred.descendants_size());
    for (int i = 0; i < shown; ++i) {
        const auto& d = bred.descendants(i);
        const bool child = d.kind() == v1::DESCENDANT_KIND_CHILD;
        std::string genes_of = child ? codec::parents_of_genes(d) : "";
        if (d.crossed_genes_size() > 0) {
            genes_of += " spread";
        }
        if (d.second_share() > 0) {
            genes_of = fixed(1 - d.second_share(), 3) + " of 1 + " + fixed(d.second_share(), 3) + " of 2";
        }
        table.add({std::to_string(d.id()),
                   child                                   ? "child"
                   : d.kind() == v1::DESCENDANT_KIND_ELITE ? "elite"
                                                           : "survivor",
                   std::to_string(d.first_parent()) + (child ? ", " + std::to_string(d.second_parent()) : ""),
                   child && !d.crossed() ? genes_of + " uncrossed" : genes_of, changes_of(d, world)});
    }
    return "\ndescendants, children from " + std::to_string(bred.survivor_count()) +
           " on; GENES OF: 1 the first parent, 2 the second\n" + table.to_text() +
           more_text(options.from, shown, bred.descendant_count());
}

void breeding(const Common& common, const BreedingOptions& options) {
    Caller caller{common};
    v1::Request request;
    auto& wanted = *request.mutable_get_breeding();
    wanted.set_world(common.world);
    wanted.set_island(options.island);
    if (options.generation) {
        wanted.set_generation(*options.generation);
    }
    wanted.set_first_contender(options.from);
    wanted.set_first_pick(options.from);
    wanted.set_first_descendant(options.from);
    const v1::Breeding bred = caller.call(std::move(request), answer_timeout).breeding();
    print(common, bred, [&] {
        return heading(bred) + contender_text(bred, options) + pick_text(bred, options) +
               descendant_text(bred, caller.world(common.world), options);
    });
}

} // namespace

void add_breeding_command(command_line::Command& app, const Common& common) {
    auto& command =
        app.add_command("breeding", "Show how a generation was bred: selections, pairs, crossover and mutation")
            .group("Look");
    auto& options = command.keep(BreedingOptions{});
    command
        .add_option("--generation", &options.generation,
                    "Generation of the parents; default: the last generation that has descendants")
        .check(at_least_one);
    command.add_option("--island", &options.island, "Island, numbered from 0").check(index_number);
    command.add_option("--from", &options.from, "First row of each list, numbered from 0")
        .check(index_number)
        .show_default();
    command.add_option("--rows", &options.rows, "Rows of each list, at most 1000; with --json, all rows of the reply")
        .check(command_line::WholeNumber{1, 1000})
        .show_default();
    command.footer("Examples:\n  evoctl breeding\n  evoctl breeding --generation 3 --rows 50\n"
                   "  evoctl breeding --json | jq '.descendants[] | select(.mutations)'");
    command.action([&] { breeding(common, options); });
}

} // namespace evod::ctl
