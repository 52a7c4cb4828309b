#include "server/console/export.h"

#include "server/console/bundle.h"
#include "server/console/export_tables.h"
#include "server/runtime/worker_pool.h"

#include <cerrno>
#include <charconv>
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

Refusal wrong_option(const std::string& option, const std::string& allowed, const std::string& got) {
    return {.code = base::RefusalCode::InvalidArgument,
            .message = option + ": got " + got + ", allowed " + allowed,
            .violations = {}};
}

/// "30:0:12".
std::optional<OrganismName> organism_named(const std::string& text) {
    OrganismName name;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto read = [&](auto& number, char before) {
        if (before != 0 && (at == end || *at++ != before))
            return false;
        const auto done = std::from_chars(at, end, number);
        at = done.ptr;
        return done.ec == std::errc{};
    };
    const bool good = read(name.generation, 0) && read(name.island, ':') && read(name.organism, ':') && at == end;
    return good ? std::optional{name} : std::nullopt;
}

Result<void> write_rows(const Exported& run, const ExportOptions& options, std::ostream& out) {
    const auto format = options.format == "jsonl" ? Table::Format::JsonLines : Table::Format::Csv;
    if (options.what == "generations")
        return write_generations(run, out, format);
    if (options.what == "organisms") {
        if (const auto count = generations_out_of_reach(run.file))
            std::cerr << "evod export: " << count
                      << " generations are left out: they are not held any more, and "
                         "follow another version of the model than this evod, which cannot simulate them again\n";
        return write_organisms(run, out, format);
    }
    if (options.what == "events")
        return write_events(run, out, format);
    if (options.what == "population")
        return write_population(run, out, format, options.generation.value_or(run.file.last_generation()));
    return write_lineage(run, out, format, organism_named(options.of));
}

/// What is wrong with the options together, as far as they alone tell.
Result<void> check(const ExportOptions& options) {
    if (options.what.empty() && options.bundle.empty())
        return wrong_option("--what", "one of its words, or --bundle FOLDER instead", "nothing");
    if (!options.of.empty() && options.what != "lineage")
        return wrong_option("--of", "only with --what lineage", options.of);
    if (!options.of.empty() && !organism_named(options.of))
        return wrong_option("--of", "GENERATION:ISLAND:ORGANISM", options.of);
    if (options.generation && options.what != "population")
        return wrong_option("--generation", "only with --what population", std::to_string(*options.generation));
    return {};
}

Result<void> export_to(const ExportOptions& options) {
    if (auto good = check(options); !good)
        return good;
    std::error_code error;
    if (!options.output.empty() && std::filesystem::equivalent(options.output, options.run, error))
        return wrong_option("--output", "another file than the run file itself", options.output);
    const auto file = RunFile::open_read_only(options.run);
    if (!file)
        return file.error();
    if (auto held = (*file)->hold_still(); !held)
        return held;
    const auto executor = runtime::make_executor(options.threads);
    if (!options.bundle.empty())
        return write_bundle({**file, *executor}, options.bundle);
    std::ofstream output;
    if (!options.output.empty()) {
        output.open(options.output, std::ios::binary);
        if (!output)
            return cannot_write("--output: cannot write " + options.output + ": " + std::strerror(errno));
    }
    std::ios::sync_with_stdio(false);
    std::ostream& out = options.output.empty() ? std::cout : output;
    if (Result<void> written = write_rows({**file, *executor}, options, out); !written)
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
