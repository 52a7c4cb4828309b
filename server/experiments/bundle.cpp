#include "server/experiments/bundle.h"

#include "proto/files/unfinished_file.h"
#include "server/parameters/experiment.h"
#include "server/replay/columns.h"
#include "server/replay/rerun.h"

#include <openssl/evp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace evod::experiments {
namespace {

namespace fs = std::filesystem;
using base::Refusal;
using base::RefusalCode;
using base::Result;

template <class Write>
Result<void> write_file(const fs::path& path, Write&& write) {
    std::ofstream out{path, std::ios::binary};
    if (out) {
        if (Result<void> written = write(out); !written) {
            return written;
        }
    }
    if (!out.flush()) {
        return refusal(RefusalCode::Unavailable, "cannot write " + path.string() + ": the disk may be full");
    }
    return {};
}

/// The text of an experiment file with all parameters and the seed.
std::string experiment_text(const run_file::RunIdentity& identity) {
    // A fork begins with the parameters of its first generation. They may differ from the values that the schedule has
    // for generation 1, so the schedule is omitted.
    const std::string parameters =
        to_experiment_text(identity.requested_parameters().values, parameters::Written::Everything,
                           identity.forked_from ? parameters::Schedule{} : identity.schedule);
    return "{\n  \"seed\": " + std::to_string(identity.seed.value) + "," + parameters.substr(1);
}

/// The checksum as 64 hexadecimal digits.
Result<std::string> sha256_of(const fs::path& path) {
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), EVP_MD_CTX_free};
    std::ifstream in{path, std::ios::binary};
    bool good = context && in && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
    std::vector<char> block(1 << 20);
    while (good && in) {
        in.read(block.data(), static_cast<std::streamsize>(block.size()));
        good = !in.bad() && EVP_DigestUpdate(context.get(), block.data(), static_cast<std::size_t>(in.gcount())) == 1;
    }
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int bytes = 0;
    if (!good || EVP_DigestFinal_ex(context.get(), digest, &bytes) != 1) {
        return refusal(RefusalCode::Unavailable, "cannot read " + path.string() + " to compute its checksum");
    }
    std::string text;
    for (unsigned int i = 0; i < bytes; ++i) {
        for (const int digit : {digest[i] >> 4, digest[i] & 15}) {
            text += "0123456789abcdef"[digit];
        }
    }
    return text;
}

Result<void> write_checksums(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& file : fs::directory_iterator{folder}) {
        names.push_back(file.path().filename().string());
    }
    std::ranges::sort(names);
    return write_file(folder / "SHA256SUMS", [&](std::ostream& out) -> Result<void> {
        for (const std::string& name : names) {
            const auto sum = sha256_of(folder / name);
            if (!sum) {
                return sum.error();
            }
            out << *sum << "  " << name << '\n';
        }
        return {};
    });
}

/// Instructions to repeat the run with `evod run`, or the reason why that is impossible.
Result<std::string> rerun_text(run_file::RunFile& file) {
    const run_file::RunIdentity& identity = file.identity();
    const auto changes = replay::world_changes(file);
    if (!changes) {
        return changes.error();
    }
    const std::uint64_t generations = file.generations().last_ended();
    if (identity.forked_from) {
        return "The run is a fork: it begins in generation " + std::to_string(identity.first_generation) +
               ", at tick " + std::to_string(identity.first_tick) +
               ", of another run, and only the run file contains that state. `evod verify` " + "begins there.\n";
    }
    if (generations == 0) {
        return std::string{"No generation has ended, so there are no numbers to compare.\n"};
    }
    if (!changes->empty()) {
        return "The world was changed " + std::to_string(changes->size()) +
               (changes->size() == 1 ? " time" : " times") +
               " during the run (events.csv). `evod verify` applies the same changes at the same ticks.\n";
    }
    return "    evod run experiment.json " +
           std::string{identity.first_population ? "--population population.csv " : ""} + "--generations " +
           std::to_string(generations) +
           " --csv again.csv\n    cmp again.csv generations.csv\n\nThe first command simulates the run from its "
           "parameters and seed alone. The second prints nothing if all numbers are equal.\n";
}

Result<std::string> repeat_text(run_file::RunFile& file, const std::string& file_name) {
    const run_file::RunIdentity& identity = file.identity();
    const auto rerun = rerun_text(file);
    if (!rerun) {
        return rerun.error();
    }
    const std::string model = std::to_string(identity.model_version);
    const std::uint64_t left_out = replay::generations_out_of_reach(file);
    return "# How to repeat the run \"" + identity.name + "\"\n\n| | |\n|---|---|\n| run | " +
           to_text(identity.run_id) + " |\n| seed | " + std::to_string(identity.seed.value) +
           " |\n| created by | evod " + identity.evod_version + ", model version " + model +
           (identity.build.empty() ? "" : ", built from " + identity.build) + " |\n| generations that have ended | " +
           std::to_string(file.generations().last_ended()) + " |\n| ticks | " + std::to_string(file.contents().tick) +
           " |\n| folder created by | evod " + EVOD_VERSION + ", model version " +
           std::to_string(simulation::model_version) + ", built from " + run_file::build_text() +
           " |\n\nEvery evod with model version " + model +
           " gives the same bits, with any number of threads.\n\n    sha256sum --check SHA256SUMS\n" +
           "    evod verify " + file_name +
           "\n\nThe first command finds changed files. The second simulates the run again and compares the result with "
           "everything in the run file: state hashes, organisms, parents, fitness, deaths, statistics.\n\n" +
           *rerun +
           (left_out == 0 ? ""
                          : "\norganisms.csv and lineage.csv lack " + std::to_string(left_out) +
                                " generations: the run file no longer contains their organisms, and the evod that "
                                "created this folder cannot simulate them again.\n");
}

Result<void> fill(const replay::RunSource& run, const fs::path& folder) {
    const std::string file_name = run.file.identity().name + ".evod";
    if (auto copied = run.file.copy_to((folder / file_name).string()); !copied) {
        return copied;
    }
    const auto write_text = [&](const char* name, const std::string& text) {
        return write_file(folder / name, [&](std::ostream& out) -> Result<void> {
            out << text;
            return {};
        });
    };
    if (auto done = write_text("experiment.json", experiment_text(run.file.identity())); !done) {
        return done;
    }
    constexpr auto csv = replay::Table::Format::Csv;
    using replay::RunTable;
    std::vector<std::pair<const char*, RunTable>> names{{"generations.csv", RunTable::Generations},
                                                        {"organisms.csv", RunTable::Organisms},
                                                        {"lineage.csv", RunTable::Lineage},
                                                        {"events.csv", RunTable::Events},
                                                        {"notes.csv", RunTable::Notes}};
    if (parameters::has_births(run.file.identity().parameters)) {
        names.emplace_back("births.csv", RunTable::Births);
    }
    for (const auto& [name, table] : names) {
        const replay::WantedTable wanted{.table = table, .format = csv};
        if (auto done =
                write_file(folder / name, [&](std::ostream& out) { return replay::write_table(run, wanted, out); });
            !done) {
            return done;
        }
    }
    if (const auto& first = run.file.identity().first_population) {
        const auto write = [&](std::ostream& out) -> Result<void> {
            replay::write_population(*first, run.file.identity().parameters, csv, out);
            return {};
        };
        if (auto done = write_file(folder / "population.csv", write); !done) {
            return done;
        }
    }
    const auto repeat = repeat_text(run.file, file_name);
    if (!repeat) {
        return repeat.error();
    }
    if (auto done = write_text("REPEAT.md", *repeat); !done) {
        return done;
    }
    return write_checksums(folder);
}

/// The names of all files that a bundle can contain while it is written.
std::set<std::string> names_in_bundle(const std::string& run_file) {
    return {run_file,         run_file + "-journal", run_file + "-wal", run_file + "-shm", "experiment.json",
            "population.csv", "generations.csv",     "organisms.csv",   "lineage.csv",     "events.csv",
            "notes.csv",      "REPEAT.md",           "SHA256SUMS"};
}

/// Deletes the folder of a bundle that an ended program left unfinished. Refused if it contains other files.
Result<void> remove_unfinished(const fs::path& part, const std::string& run_file) {
    std::error_code error;
    if (!fs::exists(fs::symlink_status(part, error))) {
        return {};
    }
    const std::set<std::string> names = names_in_bundle(run_file);
    bool other = !fs::is_directory(fs::symlink_status(part, error));
    for (fs::directory_iterator file{part, error}, end; !other && !error && file != end; file.increment(error)) {
        other = !names.contains(file->path().filename().string()) || !file->is_regular_file(error);
    }
    if (!other && !error) {
        fs::remove_all(part, error);
    }
    if (other || error) {
        return refusal(RefusalCode::AlreadyExists,
                       "--bundle: " + part.string() +
                           " exists, and is not an unfinished bundle of this run: move it away");
    }
    return {};
}

} // namespace

Result<void> write_bundle(const replay::RunSource& run, const std::string& folder) {
    std::error_code error;
    if (fs::exists(fs::symlink_status(folder, error))) {
        return refusal(RefusalCode::AlreadyExists, "--bundle: " + folder + " exists already");
    }
    const fs::path whole = fs::path{folder}.has_filename() ? fs::path{folder} : fs::path{folder}.parent_path();
    const fs::path part = whole.string() + ".part";
    const auto cannot_create = [&] {
        return refusal(RefusalCode::Unavailable,
                       "--bundle: cannot create the folder " + folder + ": " + error.message());
    };
    if (auto removed = remove_unfinished(part, run.file.identity().name + ".evod"); !removed) {
        return removed;
    }
    std::vector<std::string> unfinished{part.string()};
    for (const std::string& name : names_in_bundle(run.file.identity().name + ".evod")) {
        unfinished.push_back((part / name).string());
    }
    const files::DeletedBySignals deleted_by_signals{unfinished};
    if (!fs::create_directory(part, error)) {
        return cannot_create();
    }
    Result<void> filled = fill(run, part);
    if (filled) {
        fs::rename(part, whole, error);
    }
    if (!filled || error) {
        std::error_code ignored;
        fs::remove_all(part, ignored);
        return filled ? cannot_create() : filled;
    }
    return {};
}

} // namespace evod::experiments
