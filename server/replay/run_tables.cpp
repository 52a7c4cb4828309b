#include "server/replay/run_tables.h"

#include "evod/v1/commands.pb.h"
#include "server/replay/birth_table.h"
#include "server/replay/columns.h"
#include "server/replay/exported_file.h"
#include "server/replay/generation_reader.h"
#include "server/replay/lineage.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <utility>

namespace evod::replay {
namespace {

using base::Refusal;
using base::Result;
using run_file::RunFile;

/// Calls `of_generation` for each generation that has begun and is wanted, in order, as long as rows can be written.
template <class OfGeneration>
Result<void> for_each_generation(const RunSource& run, const std::ostream& out, OfGeneration&& of_generation) {
    run_file::RunFile& file = run.file;
    const std::uint64_t last = file.generations().last();
    for (std::uint64_t generation = file.identity().first_generation; generation <= last && out; ++generation) {
        if (run.stop()) {
            return cancelled_refusal();
        }
        if (auto begun = expect_generation(file, generation); !begun) {
            return begun;
        }
        if (generation % run.every != 0 && generation != last) {
            continue;
        }
        if (Result<void> done = of_generation(generation); !done) {
            return done;
        }
    }
    return {};
}

/// Tables of organisms have a further column in colonies.
void add_species_column(const RunSource& run, std::vector<std::string>& columns) {
    if (simulation::is_colony(run.file.identity().parameters)) {
        columns.emplace_back("species");
    }
}
void write_species(Table& table, const parameters::Parameters& parameters, const Origins& origins,
                   std::size_t organism) {
    if (simulation::is_colony(parameters)) {
        table.text(species_name(origins.species(organism)));
    }
}

/// The results of one island in a generation that has ended.
struct EndedIsland {
    const run_file::IslandOutcome& outcome;
    const simulation::GenerationStatistics& statistics;
};
/// placed  WholeGeneration::placed of the organism's island.
/// ended   results of the organism's island; nullopt before the end of the generation.
void write_organism(Table& table, const codec::GeneTexts& texts, const evolution::GeneMatrix& genes,
                    const Origins& origins, std::span<const std::uint32_t> placed, std::size_t organism,
                    const parameters::Parameters& parameters, const std::optional<EndedIsland>& ended) {
    const double tick_s = parameters.tick_s;
    const std::size_t bred = origins.bred_count;
    if (const auto parents = origins.parents_of(organism)) {
        table.number(parents->first).number(parents->second);
    } else {
        table.nothing().nothing();
    }
    table.text(origins.origin(organism));
    std::size_t gene = 0;
    for (const float value : evolution::column(genes, static_cast<std::uint32_t>(organism))) {
        write_gene(table, texts, gene++, value);
    }
    if (ended) {
        const run_file::IslandOutcome& outcome = ended->outcome;
        const std::size_t objectives = outcome.objectives.size() / outcome.fitness.size();
        const bool alive = outcome.cause[organism] == simulation::CauseOfDeath::Alive;
        table.number(outcome.fitness[organism])
            .number(alive ? ended->statistics.simulated_s - (organism < bred ? 0 : placed[organism - bred] * tick_s)
                          : outcome.lived_ticks[organism] * tick_s)
            .text(run_file::name_of(outcome.cause[organism]));
        for (std::uint32_t objective = 1; objective < parameters.objectives; ++objective) {
            if (objectives > objective) {
                table.number(outcome.objectives[organism * objectives + objective]);
            } else { // the world computes its fitness itself
                table.nothing();
            }
        }
    } else {
        table.nothing().nothing().nothing();
        for (std::uint32_t objective = 1; objective < parameters.objectives; ++objective) {
            table.nothing();
        }
    }
    write_species(table, parameters, origins, organism);
    table.end_row();
}

Refusal not_found_refusal(base::Violation violation) {
    return {.code = base::RefusalCode::NotFound,
            .message = "the run file has no such organism",
            .violations = {std::move(violation)},
            .reason = base::Reason::OrganismNotFound};
}

/// The reason why a generation that has begun cannot be read; nullopt if it can be read.
std::optional<Refusal> out_of_reach(run_file::RunFile& file, const char* field, std::uint64_t generation) {
    if (can_be_read(file, generation)) {
        return std::nullopt;
    }
    Refusal refused = *file.other_model();
    refused.violations.push_back({field,
                                  "a retained generation; the nearest are " +
                                      std::to_string(file.retention().at_or_before(generation)) + " and " +
                                      std::to_string(file.retention().at_or_after(generation)),
                                  std::to_string(generation)});
    return refused;
}

std::optional<base::Violation> wrong_place(const OrganismName& name, const std::vector<Family>& families) {
    if (name.island >= families.size()) {
        return base::Violation{"of.island", "an island from 0 to " + std::to_string(families.size() - 1),
                               std::to_string(name.island)};
    }
    const std::size_t count = families[name.island].origins.organism_count();
    if (name.organism >= count) {
        return base::Violation{"of.organism", "an organism from 0 to " + std::to_string(count - 1),
                               std::to_string(name.organism)};
    }
    return std::nullopt;
}

/// A flag for each organism of each island: whether the organism is requested.
using Wanted = std::vector<std::vector<bool>>;

/// The parents of an organism that was born during its interval.
std::optional<evolution::Parents> parents_within(const Family& family, std::size_t organism) {
    return organism < family.origins.bred_count ? std::nullopt : family.origins.parents_of(organism);
}

void write_parents(Table& table, std::uint64_t generation, std::size_t island, const Family& family,
                   std::size_t organism) {
    if (const auto within = parents_within(family, organism)) {
        table.number(generation).number(island).number(within->first);
        table.number(generation).number(island).number(within->second);
        return;
    }
    const bool is_known = organism < family.parents.size() && family.parents[organism].front() != nowhere;
    for (std::size_t parent = 0; parent < 2; ++parent) {
        if (is_known) {
            const Place& place = family.parents[organism][parent];
            table.number(generation - 1).number(place.island).number(place.organism);
        } else {
            table.nothing().nothing().nothing();
        }
    }
}

void write_families(Table& table, std::uint64_t generation, const std::vector<Family>& families, const Wanted* wanted,
                    bool with_species) {
    for (std::size_t island = 0; island < families.size(); ++island) {
        const Family& family = families[island];
        const std::size_t organisms = family.origins.organism_count();
        for (std::size_t organism = 0; organism < organisms && table.can_write(); ++organism) {
            if (wanted != nullptr && !(*wanted)[island][organism]) {
                continue;
            }
            table.number(generation).number(island).number(organism);
            write_parents(table, generation, island, family, organism);
            table.text(family.origins.origin(organism));
            if (family.fitness.empty()) {
                table.nothing();
            } else {
                table.number(family.fitness[organism]);
            }
            if (family.child_count.empty()) {
                table.nothing().nothing();
            } else {
                table.number(family.child_count[organism]).number(family.kept_count[organism]);
            }
            if (with_species) {
                table.text(species_name(family.origins.species(organism)));
            }
            table.end_row();
        }
    }
}

/// Adds the ancestors of the requested organisms that lived in the same interval. Parents have lower ids.
void add_ancestors_within(Wanted& wanted, const std::vector<Family>& families) {
    for (std::size_t island = 0; island < families.size(); ++island) {
        const Family& family = families[island];
        for (std::size_t organism = wanted[island].size(); organism-- > family.origins.bred_count;) {
            const auto parents = parents_within(family, organism);
            if (wanted[island][organism] && parents) {
                wanted[island][parents->first] = wanted[island][parents->second] = true;
            }
        }
    }
}

/// The parents of the requested organisms.
Wanted parents_of(const Wanted& wanted, const std::vector<Family>& families) {
    Wanted parents;
    for (std::size_t island = 0; island < families.size(); ++island) {
        for (std::size_t organism = 0; organism < families[island].parents.size(); ++organism) {
            if (!wanted[island][organism]) {
                continue;
            }
            for (const Place& parent : families[island].parents[organism]) {
                if (parent == nowhere) {
                    continue;
                }
                parents.resize(std::max<std::size_t>(parents.size(), parent.island + 1));
                std::vector<bool>& there = parents[parent.island];
                there.resize(std::max<std::size_t>(there.size(), parent.organism + 1));
                there[parent.organism] = true;
            }
        }
    }
    return parents;
}

/// The command's name as the protocol spells it: "set_parameters".
std::string kind_of(const v1::Request& request) {
    const auto* kinds = v1::Request::descriptor()->FindOneofByName("kind");
    const auto* kind = v1::Request::GetReflection()->GetOneofFieldDescriptor(request, kinds);
    return kind == nullptr ? std::string{"unknown"} : kind->name();
}

Result<void> write_generations(const RunSource& run, std::ostream& out, Table::Format format) {
    const std::vector<std::string> gene_names = gene_names_of(run.file.identity().parameters);
    const ColonyColumns colony = colony_columns_of(run.file.identity().parameters);
    Table table{out, format, statistics_columns(gene_names, colony)};
    return for_each_generation(run, out, [&](std::uint64_t generation) -> Result<void> {
        const auto statistics = run.file.generations().statistics_of(generation);
        if (!statistics) {
            return statistics.error();
        }
        for (const simulation::GenerationStatistics& island : *statistics) {
            write_row(table, island, gene_names, colony);
        }
        return {};
    });
}

Result<void> write_organisms(const RunSource& run, std::ostream& out, Table::Format format) {
    std::vector<std::string> columns{"generation", "island", "organism", "parent_first", "parent_second", "origin"};
    const std::vector<std::string> gene_names = gene_names_of(run.file.identity().parameters);
    columns.insert(columns.end(), gene_names.begin(), gene_names.end());
    columns.insert(columns.end(), {"fitness", "lived_s", "cause"});
    for (std::uint32_t objective = 2; objective <= run.file.identity().parameters.objectives; ++objective) {
        columns.push_back("objective" + std::to_string(objective));
    }
    add_species_column(run, columns);
    Table table{out, format, std::move(columns)};
    const codec::GeneTexts texts = gene_texts_of(run.file.identity().parameters);
    GenerationReader reader{run.file, run.executor, run.stop, Chromosomes::OfAll};
    return for_each_generation(run, out, [&](std::uint64_t generation) -> Result<void> {
        if (!can_be_read(run.file, generation, Chromosomes::OfAll)) {
            return {};
        }
        const auto whole = reader.read(generation);
        if (!whole) {
            return whole.error();
        }
        const auto& [begun, ended, placed, births] = *whole;
        for (std::size_t i = 0; i < begun.born.size(); ++i) {
            const evolution::GeneMatrix& genes = begun.born[i].genes;
            const Origins origins = origins_of(*whole, i);
            std::optional<EndedIsland> island;
            if (ended) {
                island.emplace(EndedIsland{ended->outcomes[i], ended->statistics[i]});
            }
            for (std::size_t organism = 0; organism < origins.organism_count() && table.can_write(); ++organism) {
                table.number(generation).number(i).number(organism);
                write_organism(table, texts, genes, origins, placed[i], organism, begun.opening.parameters.active,
                               island);
            }
        }
        return {};
    });
}

Result<void> write_lineage(const RunSource& run, std::ostream& out, Table::Format format,
                           const std::optional<OrganismName>& of, std::uint64_t first_generation) {
    std::vector<std::string> columns{"generation",
                                     "island",
                                     "organism",
                                     "parent_first_generation",
                                     "parent_first_island",
                                     "parent_first",
                                     "parent_second_generation",
                                     "parent_second_island",
                                     "parent_second",
                                     "origin",
                                     "fitness",
                                     "child_count",
                                     "kept_count"};
    add_species_column(run, columns);
    Table table{out, format, std::move(columns)};
    const bool with_species = simulation::is_colony(run.file.identity().parameters);
    const std::uint64_t first = run.file.identity().first_generation, last = run.file.generations().last();
    if (first_generation > last) {
        return not_found_refusal(
            {"first_generation", "at most " + std::to_string(last), std::to_string(first_generation)});
    }
    if (!of) {
        return each_generation(
            run.file, run.executor, run.stop,
            [&](std::uint64_t generation, const auto& families) {
                write_families(table, generation, families, nullptr, with_species);
                return out.good();
            },
            first_generation);
    }
    if (of->generation < first || of->generation > last) {
        return not_found_refusal({"of.generation",
                                  "a generation from " + std::to_string(first) + " to " + std::to_string(last),
                                  std::to_string(of->generation)});
    }
    if (auto refused = out_of_reach(run.file, "of.generation", of->generation)) {
        return *refused;
    }
    std::optional<base::Violation> wrong;
    Wanted wanted;
    const auto done = each_generation_back_from(
        run.file, of->generation, run.executor, run.stop, [&](std::uint64_t generation, const auto& families) {
            if (generation < first_generation) {
                return false;
            }
            if (generation == of->generation) {
                wrong = wrong_place(*of, families);
                if (wrong) {
                    return false;
                }
                wanted.resize(of->island + 1);
                wanted[of->island].resize(of->organism + 1);
                wanted[of->island][of->organism] = true;
            }
            wanted.resize(families.size());
            for (std::size_t island = 0; island < families.size(); ++island) {
                wanted[island].resize(families[island].origins.organism_count());
            }
            add_ancestors_within(wanted, families);
            write_families(table, generation, families, &wanted, with_species);
            wanted = parents_of(wanted, families);
            return !wanted.empty() && out.good();
        });
    if (wrong) {
        return not_found_refusal(*wrong);
    }
    return done;
}

Result<void> write_population(const RunSource& run, std::ostream& out, Table::Format format, std::uint64_t generation) {
    const std::uint64_t first = run.file.identity().first_generation, last = run.file.generations().last();
    if (generation < first || generation > last) {
        return Refusal{.code = base::RefusalCode::NotFound,
                       .message = run.file.path() + " has no such generation",
                       .violations = {{"generation", std::to_string(first) + " to " + std::to_string(last),
                                       std::to_string(generation)}},
                       .reason = base::Reason::MomentNotFound};
    }
    if (auto refused = out_of_reach(run.file, "generation", generation)) {
        return *refused;
    }
    const auto whole = GenerationReader{run.file, run.executor, run.stop}.read(generation);
    if (!whole) {
        return whole.error();
    }
    std::vector<evolution::GeneMatrix> population;
    for (std::size_t i = 0; i < whole->begun.born.size(); ++i) {
        const evolution::NextGeneration& born = whole->begun.born[i];
        population.push_back(
            born.genes.leftCols(born.genes.cols() - std::ssize(whole->placed[i]) - born.predator_count));
    }
    write_population(population, run.file.identity().parameters, format, out);
    return {};
}

/// Calls `of_entry` with each entry of the journal and its request, as long as `out` is good.
template <class OfEntry>
Result<void> for_each_entry(const RunSource& run, const std::ostream& out, OfEntry&& of_entry) {
    constexpr std::uint32_t entries_at_once = 1000;
    constexpr std::size_t bytes_at_once = 256 << 10; // they stay in memory while the job waits for its client
    for (std::uint64_t first = 1; out;) {
        const auto entries = run.file.journal().read(first, entries_at_once, bytes_at_once);
        if (!entries) {
            return entries.error();
        }
        if (entries->empty()) {
            break;
        }
        first += entries->size();
        for (const run_file::JournalEntry& entry : *entries) {
            if (!out) {
                return {};
            }
            v1::Request request;
            if (!request.ParseFromString(entry.origin.request) || !of_entry(entry, request)) {
                return Refusal{.code = base::RefusalCode::DataLoss,
                               .message = run.file.path() + " is damaged: entry " + std::to_string(entry.number) +
                                          " of its journal is not a request",
                               .violations = {}};
            }
        }
    }
    return {};
}

const char* sender_of(const run_file::JournalEntry& entry) {
    return entry.origin.by.kind == base::Actor::Kind::Server ? "server" : "client";
}

Result<void> write_events(const RunSource& run, std::ostream& out, Table::Format format, bool only_users) {
    google::protobuf::util::JsonPrintOptions json_options;
    json_options.preserve_proto_field_names = true;
    Table table{out, format, {"number", "tick", "sender", "user", "program", "address", "kind", "request"}};
    return for_each_entry(run, out, [&](const run_file::JournalEntry& entry, v1::Request& request) {
        // These two fields would allow another client to send the next command under the identity of this one.
        request.clear_client_key();
        request.clear_request_id();
        std::string json;
        if (!MessageToJsonString(request, &json, json_options).ok()) {
            return false;
        }
        const base::Actor& by = entry.origin.by;
        table.number(entry.number)
            .number(entry.tick)
            .text(sender_of(entry))
            .text(by.user)
            .text(only_users ? "" : by.program)
            .text(only_users ? "" : by.address)
            .text(kind_of(request))
            .json(json)
            .end_row();
        return true;
    });
}

Result<void> write_notes(const RunSource& run, std::ostream& out, Table::Format format) {
    Table table{out, format, {"number", "tick", "generation", "sender", "user", "kind", "text"}};
    return for_each_entry(run, out, [&](const run_file::JournalEntry& entry, const v1::Request& request) {
        if (request.has_add_note()) {
            table.number(entry.number)
                .number(entry.tick)
                .number(run.file.generations().at_tick(entry.tick))
                .text(sender_of(entry))
                .text(entry.origin.by.user)
                .text(request.add_note().kind())
                .text(request.add_note().text())
                .end_row();
        }
        return true;
    });
}

} // namespace

std::uint64_t generations_out_of_reach(run_file::RunFile& file, const base::StopCheck& stop) {
    std::uint64_t count = 0;
    const std::uint64_t last = file.generations().last();
    if (file.other_model()) {
        for (std::uint64_t generation = file.identity().first_generation; generation <= last && !stop(); ++generation) {
            const auto opening = file.generations().opening_of(generation);
            if (!opening || !*opening) {
                break; // the file is damaged; reading the generation reports it
            }
            count += !can_be_read(file, generation);
        }
    }
    return count;
}

void write_population(const std::vector<evolution::GeneMatrix>& population, const parameters::Parameters& parameters,
                      Table::Format format, std::ostream& out) {
    Table table{out, format, population_columns(gene_names_of(parameters))};
    const codec::GeneTexts texts = gene_texts_of(parameters);
    for (std::size_t island = 0; island < population.size(); ++island) {
        const evolution::GeneMatrix& genes = population[island];
        for (std::uint32_t organism = 0; organism < genes.cols() && table.can_write(); ++organism) {
            table.number(island).number(organism);
            std::size_t gene = 0;
            for (const float value : evolution::column(genes, organism)) {
                write_gene(table, texts, gene++, value);
            }
            table.end_row();
        }
    }
}

Result<void> write_table(const RunSource& run, const WantedTable& wanted, std::ostream& out) {
    switch (wanted.table) {
    case RunTable::Generations:
        return write_generations(run, out, wanted.format);
    case RunTable::Organisms:
        return write_organisms(run, out, wanted.format);
    case RunTable::Lineage:
        return write_lineage(run, out, wanted.format, wanted.of, wanted.first_generation);
    case RunTable::Population:
        return write_population(run, out, wanted.format, wanted.generation.value_or(run.file.generations().last()));
    case RunTable::Events:
        return write_events(run, out, wanted.format, wanted.only_users);
    case RunTable::Notes:
        return write_notes(run, out, wanted.format);
    case RunTable::Births:
        return write_births(run, out, wanted.format);
    case RunTable::File:
        break;
    }
    return write_exported_file(run.file, wanted.only_users, run.stop, out);
}

} // namespace evod::replay
