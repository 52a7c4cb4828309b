#include "client/ctl/input_file.h"

#include "client/ctl/caller.h"
#include "proto/codec/population_csv.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace evod::ctl {

std::ifstream open_file(const std::string& what, const std::string& path) {
    std::error_code error;
    std::ifstream file;
    if (std::filesystem::is_directory(path, error)) {
        errno = EISDIR; // a stream can open a folder, but throws when it reads from it
    } else {
        file.open(path, std::ios::binary);
    }
    if (!file.is_open()) {
        throw Stop{ExitCode::Usage, "the " + what + " file " + path + " cannot be read: " + std::strerror(errno)};
    }
    return file;
}

codec::Population population_in(const std::string& path) {
    std::ifstream file = open_file("population", path);
    auto population = codec::read_population(file);
    if (!population) {
        throw Stop{ExitCode::Usage, "the population file " + path + " is invalid: " + population.error().what};
    }
    return *std::move(population);
}

} // namespace evod::ctl
