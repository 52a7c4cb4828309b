#include "client/ctl/population_file.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

namespace evod::ctl {

namespace {

constexpr std::string_view heading =
    "island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius";
constexpr int gene_count = 6;

/// The next field of a line, which is shortened by it; false if it is no T.
template <class T>
bool take(std::string_view& line, T& value) {
    const std::string_view field = line.substr(0, line.find(','));
    line.remove_prefix(std::min(line.size(), field.size() + 1));
    const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
    return read.ec == std::errc{} && read.ptr == field.data() + field.size();
}

bool next_line(std::istream& in, std::string& line) {
    if (!std::getline(in, line)) {
        return false;
    }
    if (line.ends_with('\r')) {
        line.pop_back();
    }
    return true;
}

} // namespace

Checked<std::vector<v1::IslandPopulation>> read_population(std::istream& in) {
    const auto wrong = [](std::uint64_t number, const std::string& allowed) {
        return Mistakes{{"line " + std::to_string(number) + ": must be " + allowed}};
    };
    std::string line;
    if (!next_line(in, line) || line != heading) {
        return wrong(1, "the heading " + std::string{heading});
    }
    std::vector<v1::IslandPopulation> islands;
    for (std::uint64_t number = 2; next_line(in, line); ++number) {
        std::string_view rest = line;
        std::uint64_t island = 0, organism = 0;
        bool good = take(rest, island) && take(rest, organism);
        if (good && island == islands.size() && organism == 0) {
            islands.emplace_back();
        }
        if (good && (islands.empty() || island != islands.size() - 1 ||
                     organism != static_cast<std::uint64_t>(islands.back().genes_size() / gene_count))) {
            return wrong(number, "the next organism of its island, or the first of the next island");
        }
        for (int gene = 0; good && gene < gene_count; ++gene) {
            float value = 0;
            good = take(rest, value);
            islands.back().add_genes(value);
        }
        if (!good || !rest.empty()) {
            return wrong(number, "an island, an organism and six genes");
        }
    }
    return islands;
}

} // namespace evod::ctl
