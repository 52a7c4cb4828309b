#include "client/ctl/class_results.h"

#include "client/core/history_csv.h"
#include "client/ctl/class_info.h"
#include "proto/files/unfinished_file.h"
#include "proto/text/csv.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>

namespace evod::ctl {

namespace {

/// What the ended generations of a world come to.
struct Results {
    std::uint64_t generations = 0;     // number of the last ended generation; 0: none
    std::uint64_t best_generation = 0; // the first with the best fitness
    double best = 0, last_mean = 0;    // over all islands
};

Results results_of(const v1::History& history) {
    Results results;
    double sum = 0;
    std::uint64_t organisms = 0;
    for (const v1::GenerationStatistics& row : history.generations()) {
        if (results.generations == 0 || row.fitness_best() > results.best) {
            results.best = row.fitness_best();
            results.best_generation = row.generation();
        }
        if (row.generation() != results.generations) {
            results.generations = row.generation();
            sum = 0;
            organisms = 0;
        }
        sum += row.fitness_mean() * row.organism_count();
        organisms += row.organism_count();
        results.last_mean = organisms == 0 ? 0 : sum / static_cast<double>(organisms);
    }
    return results;
}

/// Returns the history of the world with which a member began. Empty if the world does not exist, because the member
/// has not joined yet or has deleted it.
v1::History history_of(Caller& caller, const v1::ClassMember& member) {
    v1::GetHistory wanted;
    wanted.set_world(member.world());
    try {
        return caller.history(std::move(wanted));
    } catch (const Stop& stop) {
        if (stop.status.code() != v1::CODE_NOT_FOUND) {
            throw;
        }
        return {};
    }
}

std::string csv_line(const std::vector<std::string>& cells) {
    std::string line;
    for (const std::string& cell : cells) {
        line += (line.empty() ? "" : ",") + text::csv_cell(cell);
    }
    return line + "\n";
}

/// One cell for each column of the summary of a member.
std::vector<std::string> summary_of(const v1::ClassMember& member, const Results& results) {
    const auto if_ended = [&](std::string text) { return results.generations == 0 ? "" : text; };
    return {std::to_string(member.number()),
            member.name(),
            member.world(),
            std::to_string(results.generations),
            if_ended(std::to_string(results.best_generation)),
            if_ended(number_text(results.best)),
            if_ended(number_text(results.last_mean))};
}
const std::vector<std::string> summary_columns{"number",          "name",         "world",    "generations",
                                               "best_generation", "best_fitness", "last_mean"};

/// Writes a file that appears when it is complete.
///
/// write  returns whether it could write everything.
void write_file(const std::filesystem::path& path, const std::function<bool(std::ostream&)>& write) {
    files::UnfinishedFile file{path.string()};
    if (!file.stream() || !write(file.stream()) || !file.finish()) {
        throw Stop{ExitCode::Refused, "FOLDER: cannot write " + path.string() + ": " + std::strerror(errno)};
    }
}

/// Writes the worlds of a class into files.
class Collection {
  public:
    Collection(Caller& caller, v1::ClassInfo info, std::filesystem::path folder)
        : caller_{caller}, info_{std::move(info)}, folder_{std::move(folder)} {}

    /// Calls a function that exports. If the server refuses the export, notes this and returns false.
    bool attempt(const std::string& world, const std::function<void()>& act) {
        try {
            act();
            return true;
        } catch (const Stop& stop) {
            if (stop.code != ExitCode::Refused || stop.status.code() == v1::CODE_UNSPECIFIED) {
                throw;
            }
            failures_.push_back(world + ": " + stop.text);
            return false;
        }
    }

    void add(const v1::WorldInfo& world) {
        const auto owner = std::ranges::find(info_.members(), world.owner(), &v1::ClassMember::user);
        const v1::ClassMember* const member = owner == info_.members().end() ? nullptr : &*owner;
        attempt(world.name(), [&] {
            write_run_file(world.name());
            ++files_;
        });
        attempt(world.name(), [&] { add_notes(world.name(), member); });
        if (member != nullptr) {
            ++worlds_[member->number()];
        }
    }

    void write_tables() {
        write_file(folder_ / "notes.csv", [&](std::ostream& out) {
            return (out << csv_line({"number", "name", "world", "entry", "tick", "generation", "user", "kind", "text"})
                        << notes_)
                .good();
        });
        std::vector<std::string> columns = summary_columns;
        columns.insert(columns.end(), {"joined", "removed", "worlds", "notes"});
        std::string rows = csv_line(columns);
        for (const v1::ClassMember& member : info_.members()) {
            Results results;
            attempt(member.world(), [&] { results = results_of(history_of(caller_, member)); });
            std::vector<std::string> row = summary_of(member, results);
            row.insert(row.end(),
                       {member.joined() ? "true" : "false", member.removed() ? "true" : "false",
                        std::to_string(worlds_[member.number()]), std::to_string(note_counts_[member.number()])});
            rows += csv_line(row);
        }
        write_file(folder_ / "students.csv", [&](std::ostream& out) { return (out << rows).good(); });
    }

    int files() const { return files_; }
    const std::vector<std::string>& failures() const { return failures_; }

  private:
    void write_run_file(const std::string& world) {
        v1::ExportRun wanted;
        wanted.set_world(world);
        wanted.set_table(v1::RUN_TABLE_FILE);
        write_file(folder_ / (world + ".evod"), [&](std::ostream& out) {
            caller_.export_run(wanted, [&](const v1::ExportPart& part) {
                return out.write(part.text().data(), static_cast<std::streamsize>(part.text().size())).good();
            });
            return out.good();
        });
    }

    /// member  the owner of the world; nullptr: it belongs to no member.
    void add_notes(const std::string& world, const v1::ClassMember* member) {
        v1::ExportRun wanted;
        wanted.set_world(world);
        wanted.set_table(v1::RUN_TABLE_NOTES);
        wanted.set_format(v1::TEXT_FORMAT_CSV);
        std::stringstream table;
        caller_.export_run(wanted, [&](const v1::ExportPart& part) { return (table << part.text()).good(); });
        text::CsvReader reader{table};
        constexpr std::size_t sender = 3; // its column: a note of the server has no user
        reader.next();                    // the heading
        while (reader.next()) {
            std::vector<std::string> row{member ? std::to_string(member->number()) : "", member ? member->name() : "",
                                         world};
            for (std::size_t column = 0; column < reader.cells().size(); ++column) {
                if (column != sender) {
                    row.emplace_back(reader.cells()[column]);
                }
            }
            notes_ += csv_line(row);
            if (member != nullptr) {
                ++note_counts_[member->number()];
            }
        }
    }

    Caller& caller_;
    const v1::ClassInfo info_;
    const std::filesystem::path folder_;
    std::string notes_;                                 // rows of notes.csv
    std::map<std::uint32_t, int> worlds_, note_counts_; // by number of the member
    std::vector<std::string> failures_;
    int files_ = 0;
};

} // namespace

void compare_class(const Common& common, const CompareOptions& options) {
    if (options.summary && !options.csv) {
        throw Stop{ExitCode::Usage, "--summary: only with --csv"};
    }
    Caller caller{common};
    const v1::ClassInfo info = class_named(caller, options.name);
    std::string csv;
    Table table{{{"NUMBER", Table::Align::Right},
                 {"NAME"},
                 {"WORLD"},
                 {"GENERATIONS", Table::Align::Right},
                 {"BEST IN", Table::Align::Right},
                 {"BEST", Table::Align::Right},
                 {"LAST MEAN", Table::Align::Right}}};
    std::vector<std::string> columns{"number", "name", "world"};
    for (const std::string& column : core::history_columns({})) {
        columns.push_back(column);
    }
    csv = csv_line(options.summary ? summary_columns : columns);
    for (const v1::ClassMember& member : info.members()) {
        v1::History history = history_of(caller, member);
        const Results results = results_of(history);
        const std::vector<std::string> summary = summary_of(member, results);
        std::vector<std::string> row = summary;
        if (results.generations > 0) {
            row[row.size() - 2] = fitness_text(results.best);
            row.back() = fitness_text(results.last_mean);
        }
        table.add(row);
        if (options.summary) {
            csv += csv_line(summary);
            continue;
        }
        for (v1::GenerationStatistics& row : *history.mutable_generations()) {
            row.clear_genes();
            std::string line = csv_line({std::to_string(member.number()), member.name(), member.world()});
            line.back() = ',';
            csv += line + core::history_line(core::history_numbers(row));
        }
    }
    print(common, info, [&] { return options.csv ? csv : table.to_text(); });
}

void collect_class(const Common& common, const CollectOptions& options) {
    Caller caller{common};
    v1::ClassInfo info = class_named(caller, options.name);
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error) {
        throw Stop{ExitCode::Usage, "FOLDER: cannot create " + options.folder + ": " + error.message()};
    }
    v1::Request request;
    request.mutable_list_worlds();
    const v1::WorldList worlds = caller.call(std::move(request)).worlds();
    Collection collection{caller, info, options.folder};
    for (const v1::WorldInfo& world : worlds.worlds()) {
        if (world.class_() == options.name) {
            collection.add(world);
            if (!common.json && ::isatty(STDERR_FILENO) == 1) {
                std::cerr << "\r\033[K" << collection.files() << " run files" << std::flush;
            }
        }
    }
    collection.write_tables();
    print(common, info, [&] {
        return std::to_string(collection.files()) + " run files, notes.csv and students.csv are in " + options.folder +
               "\n";
    });
    std::string text;
    for (const std::string& failure : collection.failures()) {
        text += (text.empty() ? "" : "\n") + failure;
    }
    if (!text.empty()) {
        throw Stop{ExitCode::Refused, text};
    }
}

} // namespace evod::ctl
