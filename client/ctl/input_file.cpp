#include "client/ctl/input_file.h"

#include "client/ctl/stop.h"
#include "proto/codec/population_csv.h"
#include "proto/files/input_file.h"

#include <sstream>
#include <utility>

namespace evod::ctl {

std::string text_in(const std::string& path, std::string_view kind, std::size_t bytes_max) {
    auto text = files::read_input(path, kind, bytes_max);
    if (!text) {
        throw Stop{ExitCode::Usage, path + ": " + text.error().why};
    }
    return *std::move(text);
}

codec::Population population_in(const std::string& path) {
    std::istringstream file{text_in(path, "a population file", organisms_bytes_max)};
    auto population = codec::read_population(file);
    if (!population) {
        throw Stop{ExitCode::Usage, "the population file " + path + " is invalid: " + population.error().what};
    }
    return *std::move(population);
}

} // namespace evod::ctl
