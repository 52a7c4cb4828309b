#include "server/commands/export.h"

#include "proto/command_line/command.h"
#include "proto/files/unfinished_file.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/experiments/bundle.h"
#include "server/replay/run_tables.h"
#include "server/run_file/check.h"
#include "server/runtime/worker_pool.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <optional>

namespace evod::commands {
namespace {

using base::Refusal;
using base::Result;
using run_file::RunFile;

Refusal cannot_write(const std::string& what) {
    return {.code = base::RefusalCode::Unavailable, .message = what, .violations = {}};
}

Refusal wrong_option(const std::string& option, const std::string& allowed, const std::string& got) {
    return {.code = base::RefusalCode::InvalidArgument,
            .message = option + ": got " + got + ", allowed " + allowed,
            .violations = {}};
}

/// Parses GENERATION:ISLAND:ORGANISM, such as "30:0:12".
std::optional<replay::OrganismName> organism_named(const std::string& text) {
    replay::OrganismName name;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto read = [&](auto& number, char before) {
        if (before != 0 && (at == end || *at++ != before)) {
            return false;
        }
        const auto done = std::from_chars(at, end, number);
        at = done.ptr;
        return done.ec == std::errc{};
    };
    const bool valid = read(name.generation, 0) && read(name.island, ':') && read(name.organism, ':') && at == end;
    return valid ? std::optional{name} : std::nullopt;
}

/// Returns the table that the options select; nullopt if they select a bundle. Rejects options that contradict each
/// other.
Result<std::optional<replay::WantedTable>> wanted_table(const ExportOptions& options) {
    using replay::RunTable;
    static const std::map<std::string, RunTable> tables{{"generations", RunTable::Generations},
                                                        {"organisms", RunTable::Organisms},
                                                        {"lineage", RunTable::Lineage},
                                                        {"population", RunTable::Population},
                                                        {"events", RunTable::Events},
                                                        {"notes", RunTable::Notes},
                                                        {"births", RunTable::Births}};
    const auto table = tables.find(options.what);
    if (table == tables.end() && options.bundle.empty()) {
        return wrong_option("--what", "a table that evod export --help lists, or --bundle FOLDER instead", "nothing");
    }
    if (!options.of.empty() && options.what != "lineage") {
        return wrong_option("--of", "only with --what lineage", options.of);
    }
    const auto of = organism_named(options.of);
    if (!options.of.empty() && !of) {
        return wrong_option("--of", "GENERATION:ISLAND:ORGANISM", options.of);
    }
    if (options.generation && options.what != "population") {
        return wrong_option("--generation", "only with --what population", std::to_string(*options.generation));
    }
    if (options.every != 1 && options.what != "generations" && options.what != "organisms") {
        return wrong_option("--every", "only with --what generations or organisms", std::to_string(options.every));
    }
    // A bundle must contain CSV, because its REPEAT.md compares generations.csv with the output of `evod run --csv`.
    if (!options.bundle.empty() && options.format != "csv") {
        return wrong_option("--format", "only csv with --bundle", options.format);
    }
    if (table == tables.end()) {
        return std::nullopt;
    }
    return replay::WantedTable{.table = table->second,
                               .format = options.format == "jsonl" ? replay::Table::Format::JsonLines
                                                                   : replay::Table::Format::Csv,
                               .generation = options.generation,
                               .of = of};
}

void report_omitted_generations(RunFile& file) {
    if (const auto count = replay::generations_out_of_reach(file)) {
        std::cerr << "evod: " << count
                  << " generations are omitted: the file does not contain their organisms, and this evod cannot "
                     "simulate them again, because another version of the model simulated them\n";
    }
}

/// Replaces the names of protocol fields with the names of the command line options.
Refusal with_option_names(Refusal refused) {
    for (base::Violation& violation : refused.violations) {
        violation.field = "--" + violation.field.substr(0, violation.field.find('.'));
    }
    return refused;
}

Result<void> export_to(const ExportOptions& options) {
    const auto wanted = wanted_table(options);
    if (!wanted) {
        return wanted.error();
    }
    std::error_code error;
    if (!options.output.empty() && std::filesystem::equivalent(options.output, options.run, error)) {
        return wrong_option("--output", "a file other than the run file itself", options.output);
    }
    const auto file = RunFile::open_checked(options.run);
    if (!file) {
        return file.error();
    }
    if (auto held = (*file)->pin_snapshot(); !held) {
        return held;
    }
    const Result<void> sound = check(**file);
    if (!sound && !options.bundle.empty()) {
        return sound;
    }
    const auto executor = runtime::make_executor(options.threads);
    const replay::RunSource run{.file = **file, .executor = *executor, .stop = {}, .every = options.every};
    using replay::RunTable;
    if (!*wanted || (*wanted)->table == RunTable::Organisms || (*wanted)->table == RunTable::Lineage) {
        report_omitted_generations(**file);
    }
    if (!*wanted) {
        return experiments::write_bundle(run, options.bundle);
    }
    std::optional<files::UnfinishedFile> output;
    if (!options.output.empty()) {
        output.emplace(options.output);
        if (!output->stream()) {
            return cannot_write("--output: cannot write " + options.output + ": " + std::strerror(errno));
        }
    }
    std::ios::sync_with_stdio(false);
    std::ostream& out = output ? output->stream() : std::cout;
    if (Result<void> written = replay::write_table(run, **wanted, out); !written) {
        return with_option_names(written.error());
    }
    if (!(output ? output->finish() : static_cast<bool>(out.flush()))) {
        return cannot_write(options.output.empty()
                                ? "cannot write to standard output: the disk may be full"
                                : "--output: cannot write " + options.output + ": the disk may be full");
    }
    return sound; // reports damage only after writing the intact part of the file
}

} // namespace

int export_run(const ExportOptions& options) {
    if (const Result<void> done = export_to(options); !done) {
        return fail(done.error());
    }
    return 0;
}

void add_export_command(command_line::Command& app) {
    auto& command =
        app.add_command("export", "Export a table of a run file as CSV or JSON lines, or the whole run as a folder")
            .group("Run files");
    auto& options = command.keep(ExportOptions{});
    options.threads = default_thread_count();
    command.add_option("run", &options.run, "Run file, NAME.evod; the run may still be in progress").required();
    const auto what =
        command
            .add_option(
                "--what", &options.what,
                "Table to export. generations: statistics; organisms: parents, genes and cause of death of each "
                "organism; lineage: parents of each organism; population: genes of one generation, as input for "
                "--population; events: the commands of the run; notes: the notes that users have added; births: in a "
                "world with births, when each organism was born and died, and its parents")
            .choices({"generations", "organisms", "lineage", "population", "events", "notes", "births"});
    command.add_option(
        "--of", &options.of,
        "Only with --what lineage: export only the organism GENERATION:ISLAND:ORGANISM and its ancestors");
    command
        .add_option("--generation", &options.generation,
                    "Only with --what population: generation to export; default: the last that has begun")
        .check(generation_number);
    command
        .add_option("--every", &options.every,
                    "Only with --what generations or organisms: export only generations that this number divides, and "
                    "the last one")
        .check(command_line::WholeNumber{.min = 1, .max = std::numeric_limits<std::uint32_t>::max()});
    command.add_option("--format", &options.format, "Format of the table: csv, or jsonl with one JSON object per line")
        .choices({"csv", "jsonl"})
        .show_default();
    const auto output = command.add_option("--output", &options.output, "Output file; default: standard output");
    command
        .add_option("--threads", &options.threads,
                    "Number of threads that recompute the generations that the file does not store in full")
        .check(thread_count)
        .show_default();
    command
        .add_option("--bundle", &options.bundle,
                    "Folder to create, with a copy of the run file, all tables, checksums, and instructions to repeat "
                    "the run")
        .excludes(what)
        .excludes(output);
    command.action([&] { return export_run(options); });
}

} // namespace evod::commands
