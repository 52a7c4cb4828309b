// Parses any text as a population file. The result must be one organism per line, or an error.
#include "proto/codec/population_csv.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod::codec;
    const std::string text{reinterpret_cast<const char*>(data), size};
    std::istringstream in{text};
    const auto population = read_population(in);
    if (!population) {
        if (population.error().what.empty()) {
            std::abort();
        }
        return 0;
    }
    std::size_t organisms = 0;
    for (std::size_t island = 0; island < population->islands.size(); ++island) {
        const auto& genes = population->islands[island];
        if (genes.empty() || genes.size() % population->gene_names.size() != 0) {
            std::abort();
        }
        organisms += population->organism_count(island);
    }
    const auto lines = std::count(text.begin(), text.end(), '\n') + (text.ends_with('\n') ? 0 : 1);
    if (organisms != static_cast<std::size_t>(lines) - 1) {
        std::abort();
    }
    return 0;
}
