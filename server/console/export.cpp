#include "server/console/export.h"

#include "evod/v1/commands.pb.h"
#include "server/console/report.h"
#include "server/console/table.h"
#include "server/storage/run_file.h"

#include <google/protobuf/util/json_util.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace evod::console {
namespace {

using base::Refusal;
using base::Result;
using storage::RunFile;

Refusal cannot_write(const std::string& what) {
    return {.code = base::RefusalCode::Unavailable, .message = what, .violations = {}};
}

/// Calls `of_generation` with each that has begun, in order, while rows can be written.
template <class OfGeneration>
Result<void> for_each_generation(RunFile& file, const std::ostream& out, OfGeneration&& of_generation) {
    const std::uint64_t last = file.last_generation();
    for (std::uint64_t generation = file.identity().first_generation; generation <= last && out; ++generation) {
        const auto opening = file.opening_of(generation);
        if (!opening)
            return opening.error();
        if (!*opening) // each has one: that of the last must be wrong, and may be very far away
            return Refusal{.code = base::RefusalCode::DataLoss,
                           .message = file.path() + " is damaged: it tells of generation " + std::to_string(last) +
                                      ", and not of generation " + std::to_string(generation),
                           .violations = {}};
        if (Result<void> done = of_generation(generation); !done)
            return done;
    }
    return {};
}

Result<void> export_generations(RunFile& file, std::ostream& out, Table::Format format) {
    Table table{out, format, statistics_columns()};
    return for_each_generation(file, out, [&](std::uint64_t generation) -> Result<void> {
        const auto statistics = file.statistics_of(generation);
        if (!statistics)
            return statistics.error();
        for (const simulation::GenerationStatistics& island : *statistics)
            write_row(table, island);
        return {};
    });
}

const char* origin_of(const evolution::NextGeneration& born, std::size_t organism) {
    if (born.parents.empty())
        return "initial";
    if (organism < born.elite_count)
        return "elite";
    return organism < born.survivor_count ? "survivor" : "child";
}

/// ended  of the same island; nullptr while the generation has not.
struct EndedIsland {
    const storage::IslandOutcome& outcome;
    const simulation::GenerationStatistics& statistics;
};
void write_organism(Table& table, const evolution::NextGeneration& born, std::size_t organism, double tick_s,
                    const std::optional<EndedIsland>& ended) {
    if (born.parents.empty())
        table.nothing().nothing();
    else
        table.number(born.parents[organism].first).number(born.parents[organism].second);
    table.text(origin_of(born, organism));
    for (const float gene : evolution::column(born.genes, static_cast<std::uint32_t>(organism)))
        table.number(gene);
    if (ended) {
        const storage::IslandOutcome& outcome = ended->outcome;
        const bool alive = outcome.cause[organism] == simulation::CauseOfDeath::Alive;
        table.number(outcome.fitness[organism])
            .number(alive ? ended->statistics.simulated_s : outcome.lived_ticks[organism] * tick_s)
            .text(storage::name_of(outcome.cause[organism]));
    } else {
        table.nothing().nothing().nothing();
    }
    table.end_row();
}

Result<void> export_organisms(RunFile& file, std::ostream& out, Table::Format format) {
    std::vector<std::string> columns{"generation", "island", "organism", "parent_first", "parent_second", "origin"};
    columns.insert(columns.end(), evolution::gene_names.begin(), evolution::gene_names.end());
    columns.insert(columns.end(), {"fitness", "lived_s", "cause"});
    Table table{out, format, std::move(columns)};
    return for_each_generation(file, out, [&](std::uint64_t generation) -> Result<void> {
        const auto damaged = [&] {
            return Refusal{.code = base::RefusalCode::DataLoss,
                           .message = file.path() + " is damaged: what it tells of generation " +
                                      std::to_string(generation) + " does not go together",
                           .violations = {}};
        };
        const auto begun = file.beginning_of(generation);
        if (!begun)
            return begun.error();
        const auto ended = file.outcome_of(generation);
        if (!ended)
            return ended.error();
        if (!*begun)
            return {}; // not held any more
        if (*ended && (*ended)->outcomes.size() != (*begun)->born.size())
            return damaged();
        for (std::size_t i = 0; i < (*begun)->born.size(); ++i) {
            const evolution::NextGeneration& born = (*begun)->born[i];
            const auto organisms = static_cast<std::size_t>(born.genes.cols());
            std::optional<EndedIsland> island;
            if (*ended)
                island.emplace(EndedIsland{(*ended)->outcomes[i], (*ended)->statistics[i]});
            if (island && island->outcome.fitness.size() != organisms)
                return damaged();
            for (std::size_t organism = 0; organism < organisms; ++organism) {
                table.number(generation).number(i).number(organism);
                write_organism(table, born, organism, (*begun)->opening.parameters.active.tick_s, island);
            }
        }
        return {};
    });
}

/// The command's name as the protocol spells it: "set_parameters".
std::string kind_of(const v1::Request& request) {
    const auto* kinds = v1::Request::descriptor()->FindOneofByName("request");
    const auto* kind = v1::Request::GetReflection()->GetOneofFieldDescriptor(request, kinds);
    return kind == nullptr ? std::string{"unknown"} : kind->name();
}

Result<void> export_events(RunFile& file, std::ostream& out, Table::Format format) {
    constexpr std::uint32_t entries_at_once = 1000;
    google::protobuf::util::JsonPrintOptions json_options;
    json_options.preserve_proto_field_names = true;
    Table table{out, format, {"number", "tick", "client", "client_key", "request_id", "kind", "request"}};
    for (std::uint64_t first = 1; out; first += entries_at_once) {
        const auto entries = file.journal(first, entries_at_once);
        if (!entries)
            return entries.error();
        for (const storage::JournalEntry& entry : *entries) {
            v1::Request request;
            std::string json;
            if (!request.ParseFromString(entry.origin.request) ||
                !MessageToJsonString(request, &json, json_options).ok())
                return Refusal{.code = base::RefusalCode::DataLoss,
                               .message = file.path() + " is damaged: entry " + std::to_string(entry.number) +
                                          " of its journal is no request",
                               .violations = {}};
            table.number(entry.number)
                .number(entry.tick)
                .text(entry.origin.client)
                .text(entry.origin.client_key)
                .number(entry.origin.request_id)
                .text(kind_of(request))
                .json(json)
                .end_row();
        }
        if (entries->size() < entries_at_once)
            break;
    }
    return {};
}

Result<void> export_to(const ExportOptions& options) {
    std::error_code error;
    if (!options.output.empty() && std::filesystem::equivalent(options.output, options.run, error))
        return Refusal{.code = base::RefusalCode::InvalidArgument,
                       .message = "--output: got " + options.output + ", allowed another file than the run file itself",
                       .violations = {}};
    const auto file = RunFile::open_read_only(options.run);
    if (!file)
        return file.error();
    if (auto held = (*file)->hold_still(); !held)
        return held;
    std::ofstream output;
    if (!options.output.empty()) {
        output.open(options.output, std::ios::binary);
        if (!output)
            return cannot_write("--output: cannot write " + options.output + ": " + std::strerror(errno));
    }
    std::ios::sync_with_stdio(false);
    std::ostream& out = options.output.empty() ? std::cout : output;
    const auto format = options.format == "jsonl" ? Table::Format::JsonLines : Table::Format::Csv;
    const auto write = options.what == "generations" ? export_generations
                       : options.what == "organisms" ? export_organisms
                                                     : export_events;
    if (Result<void> written = write(**file, out, format); !written)
        return written;
    if (!out.flush())
        return cannot_write(options.output.empty()
                                ? "standard output cannot be written, the disk may be full"
                                : "--output: cannot write " + options.output + ", the disk may be full");
    return {};
}

} // namespace

int export_run(const ExportOptions& options) {
    if (const Result<void> done = export_to(options); !done) {
        std::cerr << "evod export: " << base::to_text(done.error()) << '\n';
        return 1;
    }
    return 0;
}

} // namespace evod::console
