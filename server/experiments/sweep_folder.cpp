#include "server/experiments/sweep_folder.h"

#include "server/experiments/atomic_file.h"
#include "server/files/regular_file.h"
#include "server/replay/columns.h"
#include "server/run_file/build.h"
#include "server/simulation/model_version.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace evod::experiments {
namespace {

namespace fs = std::filesystem;
using base::RefusalCode;
using base::Result;
using evolution::Outcome;

constexpr std::string_view end_mark = "# ended by ";
constexpr std::size_t provenance_bytes_max =
    8 << 20; // a sweep file of 1 MiB with each line as a comment, and the other facts
constexpr std::array<std::pair<Outcome, std::string_view>, 4> outcome_names{
    {{Outcome::TargetFitness, "target_fitness"},
     {Outcome::Extinction, "extinction"},
     {Outcome::Stagnation, "stagnation_limit"},
     {Outcome::GenerationLimit, "generation_limit"}}};

struct ProvenanceEntry {
    std::string name, text;
};

/// Returns the entries of sweep.txt: all data that determines the results, and nothing else.
std::vector<ProvenanceEntry> provenance_entries(const Sweep& sweep) {
    std::string parameters = to_experiment_text(sweep.parameters, parameters::Written::Differences, sweep.schedule);
    std::erase(parameters, '\n');
    std::string text;
    for (std::size_t i = 0; i < sweep.text.size(); ++i) {
        const bool pair = sweep.text[i] == '\r' && i + 1 < sweep.text.size() && sweep.text[i + 1] == '\n';
        if (!pair) {
            text += sweep.text[i] == '\r' ? '\n' : sweep.text[i];
        }
    }
    while (text.ends_with('\n')) {
        text.pop_back();
    }
    return {{"evod", version_and_build()},
            {"model", std::to_string(simulation::model_version)},
            {"seed", std::to_string(sweep.seed.value)},
            {"runs", std::to_string(sweep.run_count()) + ": " + std::to_string(sweep.cells.size()) + " cells of " +
                         std::to_string(sweep.replicates) + " replicates"},
            {"parameters", parameters},
            {"sweep file", "\n" + text}};
}

/// Formats an entry of sweep.txt as a comment of one or more lines.
std::string to_text(const ProvenanceEntry& entry) {
    std::string text = "# " + entry.name + ": ";
    for (const char c : entry.text) {
        text += c == '\n' ? "\n#   " : std::string(1, c);
    }
    return text + "\n";
}

std::string provenance_of(const Sweep& sweep) {
    std::string text = "# evod sweep: a row per run, generation and island, made from:\n";
    for (const ProvenanceEntry& entry : provenance_entries(sweep)) {
        text += to_text(entry);
    }
    return text;
}

/// Returns the refusal of a folder that contains results of another sweep. It names the entries that differ.
///
/// there  text of the file sweep.txt in the folder.
base::Refusal other_sweep_refusal(const std::string& path, const std::string& there, const Sweep& sweep) {
    base::Refusal refused = refusal(RefusalCode::FailedPrecondition,
                                    path + " contains the results of another sweep: name another folder with --out");
    for (const ProvenanceEntry& entry : provenance_entries(sweep)) {
        if (there.find("\n" + to_text(entry)) != std::string::npos) {
            continue;
        }
        const std::string name = "\n# " + entry.name + ": ";
        const std::size_t begin = there.find(name);
        std::string got = begin == std::string::npos ? "nothing" : there.substr(begin + name.size());
        got = got.substr(0, got.find("\n# ")); // continuation lines are indented further
        const bool long_text = entry.text.find('\n') != std::string::npos;
        refused.violations.push_back({entry.name, long_text ? "no change since the sweep began" : entry.text,
                                      long_text ? "a changed text" : got.substr(0, got.find('\n'))});
    }
    if (refused.violations.empty()) {
        refused.message = path + "/sweep.txt was changed: name another folder with --out";
    }
    return refused;
}

/// Returns the sweep whose sweep.txt is given; nullopt if the text is damaged, or that sweep has another build, model,
/// experiment or seed than `sweep`.
std::optional<Sweep> sweep_in(const std::string& there, const Sweep& sweep) {
    for (const ProvenanceEntry& entry : provenance_entries(sweep)) {
        if (entry.name != "runs" && entry.name != "sweep file" &&
            there.find("\n" + to_text(entry)) == std::string::npos) {
            return std::nullopt;
        }
    }
    constexpr std::string_view name = "\n# sweep file: ", indent = "\n#   ";
    const std::size_t begin = there.find(name);
    if (begin == std::string::npos) {
        return std::nullopt;
    }
    std::string text = there.substr(begin + name.size());
    for (std::size_t at = 0; (at = text.find(indent, at)) != std::string::npos; ++at) {
        text.replace(at, indent.size(), "\n");
    }
    // The entries have shown that its experiment is the same.
    auto read = parse_sweep(text, [&](const std::string&) {
        return parameters::Experiment{
            .parameters = sweep.parameters, .schedule = sweep.schedule, .seed = sweep.seed, .description = {}};
    });
    return read ? std::optional{*std::move(read)} : std::nullopt;
}

/// Whether the runs of `smaller` are some of the runs of `sweep`, with the same cells and replicates.
bool is_part_of(const Sweep& smaller, const Sweep& sweep) {
    if (smaller.swept != sweep.swept || smaller.every != sweep.every || smaller.cells.size() > sweep.cells.size() ||
        smaller.run_count() == sweep.run_count() || smaller.replicates > sweep.replicates) {
        return false;
    }
    for (std::uint32_t replicate = 0; replicate < smaller.replicates; ++replicate) {
        if (!(smaller.seed_of(replicate) == sweep.seed_of(replicate))) {
            return false;
        }
    }
    for (std::size_t cell = 0; cell < smaller.cells.size(); ++cell) {
        if (smaller.cells[cell] != sweep.cells[cell] || !(smaller.parameters_of(cell) == sweep.parameters_of(cell)) ||
            !(smaller.schedule_of(cell) == sweep.schedule_of(cell))) {
            return false;
        }
    }
    return true;
}

std::string padded(std::size_t number, std::size_t count) {
    const std::string text = std::to_string(number);
    return std::string(std::to_string(count - 1).size() - text.size(), '0') + text;
}

Result<void> create_folder(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (!error && fs::is_directory(path, error)) {
        return {};
    }
    return refusal(RefusalCode::Unavailable, "cannot create the folder " + path + ": " +
                                                 (error ? error.message() : "a file with this name exists"));
}

/// The last line of a file; nullopt if the file is missing or does not end with a newline.
std::optional<std::string> last_line(const std::string& part) {
    std::error_code error;
    if (!fs::is_regular_file(part, error)) {
        return std::nullopt;
    }
    std::ifstream file{part, std::ios::binary | std::ios::ate};
    if (!file) {
        return std::nullopt;
    }
    constexpr std::streamoff enough = 128;
    const std::streamoff bytes = file.tellg(), begin = std::max<std::streamoff>(bytes - enough, 0);
    std::string text(static_cast<std::size_t>(bytes - begin), '\0');
    file.seekg(begin);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (!file || !text.ends_with('\n')) {
        return std::nullopt;
    }
    const std::size_t before = text.size() < 2 ? std::string::npos : text.rfind('\n', text.size() - 2);
    return before == std::string::npos ? text : text.substr(before + 1);
}

std::optional<RunEnd> parse_run_end(std::string_view line) {
    if (!line.starts_with(end_mark)) {
        return std::nullopt;
    }
    line.remove_prefix(end_mark.size());
    for (const auto& [outcome, name] : outcome_names) {
        if (!line.starts_with(name)) {
            continue;
        }
        RunEnd end{.outcome = outcome};
        constexpr std::string_view after_name = ", rows: ";
        const std::string_view rest = line.substr(name.size());
        if (!rest.starts_with(after_name)) {
            continue;
        }
        const char* const last = rest.data() + rest.size();
        const auto read = std::from_chars(rest.data() + after_name.size(), last, end.rows);
        if (read.ec == std::errc{} && std::string_view{read.ptr, last} == "\n") {
            return end;
        }
    }
    return std::nullopt;
}

} // namespace

std::string version_and_build() {
    return std::string{EVOD_VERSION} + ", " + run_file::build_text();
}

std::string_view name_of(Outcome outcome) {
    for (const auto& [of, name] : outcome_names) {
        if (of == outcome) {
            return name;
        }
    }
    return "nothing";
}

std::string to_text(const RunEnd& end) {
    return std::string{end_mark} + std::string{name_of(end.outcome)} + ", rows: " + std::to_string(end.rows) + "\n";
}

std::vector<std::string> sweep_columns(const Sweep& sweep) {
    std::vector<std::string> columns{"cell", "replicate", "seed"};
    for (const parameters::ParameterDescription* parameter : sweep.swept) {
        columns.emplace_back(parameter->name);
    }
    const std::vector<std::string> statistics = replay::statistics_columns(replay::body_gene_names());
    columns.insert(columns.end(), statistics.begin(), statistics.end());
    return columns;
}

Result<SweepFolder> SweepFolder::open(const std::string& path, const Sweep& sweep, Extension extension) {
    const std::string of_sweep = path + "/sweep.txt", provenance = provenance_of(sweep);
    std::error_code error;
    // Another task may be creating these files, sweep.txt before its results. So this function looks for results before
    // it looks for sweep.txt; otherwise a new result could seem to lack its sweep.txt.
    std::string result;
    for (const char* name : {"/runs.csv", "/parts", "/run-files"}) {
        if (fs::exists(path + name, error)) {
            result = path + name;
        }
    }
    if (!fs::exists(of_sweep, error)) {
        if (!result.empty()) {
            return refusal(RefusalCode::FailedPrecondition,
                           result +
                               " exists, but the sweep.txt of its sweep is missing: name another folder with --out");
        }
        if (auto created = create_folder(path); !created) {
            return created.error();
        }
        AtomicFile file{of_sweep};
        file.write(provenance);
        if (auto written = file.finish(); !written) {
            return written.error();
        }
    }
    const auto there = files::read_file(of_sweep, "the sweep.txt of a sweep", provenance_bytes_max);
    if (!there) {
        return there.error();
    }
    if (*there != provenance) {
        const auto smaller = sweep_in(*there, sweep);
        if (!smaller || !is_part_of(*smaller, sweep)) {
            base::Refusal refused = other_sweep_refusal(path, *there, sweep);
            if (smaller) {
                refused.message += ". A sweep in the same folder can get more replicates or seeds, and more values at "
                                   "the end of a list or of the first parameter of a grid";
            }
            return refused;
        }
        if (extension == Extension::Refused) {
            return refusal(RefusalCode::FailedPrecondition,
                           path + " contains a smaller sweep: extend it with one command without --array-index, which "
                                  "may be interrupted at once");
        }
        if (auto extended = SweepFolder{path, sweep}.extend(*smaller); !extended) {
            return extended.error();
        }
    }
    if (auto created = create_folder(path + "/parts"); !created) {
        return created.error();
    }
    return SweepFolder{path, sweep};
}

/// Renames the files of finished runs whose numbers get more digits, then replaces sweep.txt. After an interruption the
/// next call does the rest, because a file that already has its new name is not found under the old one.
Result<void> SweepFolder::extend(const Sweep& smaller) const {
    const SweepFolder before{path_, smaller};
    for (std::size_t run = 0; run < smaller.run_count(); ++run) {
        const std::size_t here = run / smaller.replicates * sweep_->replicates + run % smaller.replicates;
        for (const auto& [from, to] :
             {std::pair{before.part_of(run), part_of(here)}, std::pair{before.run_file_of(run), run_file_of(here)}}) {
            std::error_code error;
            if (from != to && fs::exists(from, error)) {
                fs::rename(from, to, error);
            }
            if (error) {
                return refusal(RefusalCode::Unavailable, "cannot rename " + from + ": " + error.message());
            }
        }
    }
    AtomicFile file{path_ + "/sweep.txt"};
    file.write(provenance_of(*sweep_));
    return file.finish();
}

std::string SweepFolder::name_of(std::size_t run) const {
    return "cell-" + padded(run / sweep_->replicates, sweep_->cells.size()) + "-replicate-" +
           padded(run % sweep_->replicates, sweep_->replicates);
}

Result<void> SweepFolder::create_run_file_folder() const {
    return create_folder(path_ + "/run-files");
}

std::optional<RunEnd> SweepFolder::end_of(std::size_t run, Wanted wanted) const {
    std::error_code error;
    if (wanted == Wanted::RowsAndRunFile && !fs::exists(run_file_of(run), error)) {
        return std::nullopt;
    }
    const auto line = last_line(part_of(run));
    return line ? parse_run_end(*line) : std::nullopt;
}

Result<void> SweepFolder::add_part(std::size_t run, AtomicFile& table, Gathered& gathered) const {
    const std::string path = part_of(run);
    const auto damaged = [&] {
        return refusal(RefusalCode::DataLoss,
                       path + " was changed: delete it, and enter the same command again to repeat this run");
    };
    const auto line = last_line(path);
    if (!line) {
        return damaged();
    }
    const auto end = parse_run_end(*line);
    if (!end) {
        return damaged();
    }
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path, error);
    if (error) {
        return damaged();
    }
    std::ifstream file{path, std::ios::binary};
    std::string block(1 << 16, '\0');
    std::uint64_t rows = 0;
    for (std::uintmax_t left = bytes - line->size(); left > 0;) {
        const std::size_t count = std::min<std::uintmax_t>(left, block.size());
        if (!file.read(block.data(), static_cast<std::streamsize>(count))) {
            return damaged();
        }
        const std::string_view text{block.data(), count};
        rows += static_cast<std::uint64_t>(std::ranges::count(text, '\n'));
        table.write(text);
        left -= count;
    }
    if (rows != end->rows) {
        return damaged();
    }
    gathered.rows += rows;
    ++gathered.runs[end->outcome];
    return {};
}

Result<SweepFolder::Gathered> SweepFolder::gather() const {
    AtomicFile table{this->table()};
    table.write(provenance_of(*sweep_));
    std::ostringstream heading;
    const replay::Table columns{heading, replay::Table::Format::Csv, sweep_columns(*sweep_)};
    table.write(heading.str());
    Gathered gathered;
    for (std::size_t run = 0; run < sweep_->run_count() && table.error().empty(); ++run) {
        if (auto added = add_part(run, table, gathered); !added) {
            return added.error();
        }
    }
    if (auto written = table.finish(); !written) {
        return written.error();
    }
    remove_temporary_files();
    return gathered;
}

/// Deletes the temporary files of processes that were killed. After gather() no process needs them.
void SweepFolder::remove_temporary_files() const {
    std::error_code error;
    std::vector<fs::path> left;
    for (const char* folder : {"", "/parts", "/run-files"}) {
        for (fs::directory_iterator file{path_ + folder, error}, end; !error && file != end; file.increment(error)) {
            if (AtomicFile::is_temporary(file->path().filename().string())) {
                left.push_back(file->path());
            }
        }
    }
    for (const fs::path& path : left) {
        fs::remove(path, error);
    }
}

} // namespace evod::experiments
