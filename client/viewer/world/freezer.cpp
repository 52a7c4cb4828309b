#include "client/viewer/world/freezer.h"

#include "client/viewer/text/numbers.h"
#include "client/viewer/world/new_world.h"
#include "client/viewer/world/user_folder.h"
#include "proto/codec/population_csv.h"
#include "proto/files/input_file.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace evod::viewer {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds interval{1};

/// Reads the population in a file of the freezer, or sets its problem.
void read_file(const fs::path& path, Frozen& frozen) {
    auto text = files::read_input(path.string(), "a population file", Freezer::file_bytes_max);
    if (!text) {
        frozen.problem = text.error().why;
        frozen.problem.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(frozen.problem.front())));
        return;
    }
    std::istringstream in{*std::move(text)};
    auto population = codec::read_population(in);
    if (population) {
        frozen.population = *std::move(population);
    } else {
        frozen.problem = population.error().what;
    }
}

} // namespace

std::size_t Frozen::organism_count() const {
    std::size_t count = 0;
    for (std::size_t island = 0; island < population.islands.size(); ++island) {
        count += population.organism_count(island);
    }
    return count;
}

std::string Frozen::content_text() const {
    const std::size_t count = organism_count();
    return with_separators(count) + (count == 1 ? " organism" : " organisms") +
           (population.islands.size() > 1 ? " on " + with_separators(population.islands.size()) + " islands" : "");
}

void Freezer::update(Clock::time_point now) {
    if (now >= next_ && !folder_.empty()) {
        next_ = now + interval;
        read();
    }
}

void Freezer::read() {
    problem_.clear();
    std::map<std::string, Seen> there;
    std::error_code error;
    for (fs::directory_iterator entry{folder_, error}; !error && entry != fs::directory_iterator{};
         entry.increment(error)) {
        if (entry->path().extension() == ".csv" && there.size() < files_max) {
            std::error_code gone; // a file may be removed between two calls
            there[entry->path().stem().string()] = {entry->last_write_time(gone), entry->file_size(gone)};
        }
    }
    if (error && error != std::errc::no_such_file_or_directory) {
        problem_ = folder_.string() + ": " + error.message();
    }
    std::vector<Frozen> files;
    for (const auto& [name, state] : there) {
        const auto known = seen_.find(name);
        if (known != seen_.end() && known->second == state) {
            files.push_back(std::move(*std::ranges::find(files_, name, &Frozen::name)));
        } else {
            read_file(path_of(name), files.emplace_back(Frozen{.name = name, .population = {}, .problem = {}}));
        }
    }
    files_ = std::move(files);
    seen_ = std::move(there);
}

const Frozen* Freezer::find(std::string_view name) const {
    const auto found = std::ranges::find(files_, name, &Frozen::name);
    return found == files_.end() ? nullptr : &*found;
}

core::Result<std::string> Freezer::save(const std::string& name, const codec::Population& population) {
    const auto failed = [](std::string what) { return core::Error{core::Error::Kind::Usage, std::move(what)}; };
    if (std::string problem = name_problem("name", name); !problem.empty()) {
        return failed(std::move(problem));
    }
    if (folder_.empty()) {
        return failed("There is no folder for the freezer: start evoview with --freezer FOLDER");
    }
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) {
        return failed(folder_.string() + ": " + error.message());
    }
    read();
    std::vector<std::string> used;
    for (const Frozen& file : files_) {
        used.push_back(file.name);
    }
    const std::string free = unused_name(name, used);
    const fs::path path = path_of(free), part = path.string() + "." + std::to_string(getpid());
    {
        std::ofstream out{part, std::ios::binary};
        out << codec::population_text(population);
        if (!out.flush()) {
            const std::string why = std::strerror(errno);
            fs::remove(part, error);
            return failed(path.string() + ": " + why);
        }
    }
    fs::rename(part, path, error);
    if (error) {
        const std::string why = error.message();
        fs::remove(part, error);
        return failed(path.string() + ": " + why);
    }
    read();
    return free;
}

std::string Freezer::remove(const std::string& name) {
    std::error_code error;
    fs::remove(path_of(name), error);
    read();
    return error ? path_of(name).string() + ": " + error.message() : "";
}

std::filesystem::path default_freezer_folder() {
    const fs::path data = user_folder("XDG_DATA_HOME", ".local/share");
    return data.empty() ? data : data / "freezer";
}

} // namespace evod::viewer
