// evoctl export: writes a table of a world's run file as CSV or JSON lines, or a copy of the file.
#include "client/ctl/caller.h"
#include "proto/command_line/command.h"
#include "proto/files/unfinished_file.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <iostream>
#include <map>
#include <optional>

namespace evod::ctl {

namespace {

const std::map<std::string, v1::RunTable> tables{{"generations", v1::RUN_TABLE_GENERATIONS},
                                                 {"organisms", v1::RUN_TABLE_ORGANISMS},
                                                 {"lineage", v1::RUN_TABLE_LINEAGE},
                                                 {"population", v1::RUN_TABLE_POPULATION},
                                                 {"events", v1::RUN_TABLE_EVENTS},
                                                 {"notes", v1::RUN_TABLE_NOTES},
                                                 {"file", v1::RUN_TABLE_FILE}};
const std::map<std::string, v1::TextFormat> formats{{"csv", v1::TEXT_FORMAT_CSV},
                                                    {"jsonl", v1::TEXT_FORMAT_JSON_LINES}};

struct ExportOptions {
    std::string what, of, format = "csv", output;
    std::optional<std::uint64_t> generation;
};

/// Parses GENERATION:ISLAND:ID, for example "30:0:12"; nullopt for any other text.
std::optional<v1::OrganismName> organism_named(const std::string& text) {
    std::uint64_t generation = 0;
    std::uint32_t island = 0, organism = 0;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto read = [&](auto& number) {
        const auto done = std::from_chars(at, end, number);
        at = done.ptr;
        return done.ec == std::errc{};
    };
    const auto colon = [&] { return at != end && *at++ == ':'; };
    if (!(read(generation) && colon() && read(island) && colon() && read(organism) && at == end)) {
        return std::nullopt;
    }
    v1::OrganismName name;
    name.set_generation(generation);
    name.set_island(island);
    name.set_organism(organism);
    return name;
}

v1::ExportRun request_of(const Common& common, const ExportOptions& options) {
    v1::ExportRun command;
    command.set_world(common.world);
    command.set_table(tables.at(options.what));
    if (command.table() != v1::RUN_TABLE_FILE) {
        command.set_format(formats.at(options.format));
    } else if (options.format != "csv") {
        throw Stop{ExitCode::Usage, "--format: not with --what file"};
    } else if (options.output.empty() && on_terminal()) {
        throw Stop{ExitCode::Usage, "--output: required with --what file on a terminal"};
    }
    if (options.generation) {
        if (command.table() != v1::RUN_TABLE_POPULATION) {
            throw Stop{ExitCode::Usage, "--generation: only with --what population"};
        }
        command.set_generation(*options.generation);
    }
    if (!options.of.empty()) {
        if (command.table() != v1::RUN_TABLE_LINEAGE) {
            throw Stop{ExitCode::Usage, "--of: only with --what lineage"};
        }
        const auto organism = organism_named(options.of);
        if (!organism) {
            throw Stop{ExitCode::Usage, "--of: got " + options.of + ", allowed GENERATION:ISLAND:ORGANISM"};
        }
        *command.mutable_of() = *organism;
    }
    return command;
}

void export_run(const Common& common, const ExportOptions& options) {
    const v1::ExportRun wanted = request_of(common, options);
    Caller caller{common};
    // The file is opened when the first part arrives, so that an existing file stays unchanged if the server refuses.
    std::optional<files::UnfinishedFile> file;
    bool is_first = true;
    caller.export_run(wanted, [&](const v1::ExportPart& part) {
        if (is_first && !options.output.empty()) {
            file.emplace(options.output);
            if (!file->stream()) {
                throw Stop{ExitCode::Usage, "--output: cannot write " + options.output + ": " + std::strerror(errno)};
            }
        }
        if (is_first && part.generations_left_out() > 0) {
            std::cerr
                << "evoctl: " << part.generations_left_out()
                << " generations are missing: they were purged, and the server cannot simulate them again because "
                   "its version of the model differs\n";
        }
        is_first = false;
        std::ostream& out = file ? file->stream() : std::cout;
        return out.write(part.text().data(), static_cast<std::streamsize>(part.text().size())).good();
    });
    if (!(file ? file->finish() : static_cast<bool>(std::cout.flush()))) {
        throw Stop{ExitCode::Refused, options.output.empty()
                                          ? "standard output cannot be written"
                                          : "--output: cannot write " + options.output + ", the disk may be full"};
    }
}

template <class Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) {
        names.push_back(name);
    }
    return names;
}

} // namespace

void add_export_command(command_line::Command& app, const Common& common) {
    auto& command = app.add_command("export", "Write a table of a world's run up to the current tick").group("Look");
    auto& options = command.keep(ExportOptions{});
    command
        .add_option(
            "--what", &options.what,
            "generations: statistics; organisms: parents, genes and fate of each; lineage: parents and children; "
            "population: the genes of one generation, for `create --population`; events: the journaled commands; "
            "notes: what users have noted; file: a copy of the run file")
        .required()
        .choices(names_of(tables));
    command.add_option("--of", &options.of,
                       "Write only the lineage of this organism, given as GENERATION:ISLAND:ORGANISM");
    command
        .add_option("--generation", &options.generation,
                    "Generation of the population; default: the current generation")
        .check(whole_number);
    command.add_option("--format", &options.format, "csv, or jsonl with one JSON object per line")
        .choices(names_of(formats))
        .show_default();
    command.add_option("--output", &options.output, "Output file; default: standard output");
    command.footer(
        "Examples:\n  evoctl export --what organisms --output organisms.csv\n"
        "  evoctl export --what population > plate.csv && evoctl create copy --population plate.csv\n"
        "  evoctl export --what file --output default.evod && evod verify default.evod\n\n"
        "To write a folder with all tables, run on the server's machine: evod export RUN.evod --bundle FOLDER");
    command.action([&] { export_run(common, options); });
}

} // namespace evod::ctl
