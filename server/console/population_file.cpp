#include "server/console/population_file.h"

#include "server/tables/columns.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

namespace evod::console {
namespace {

using base::RefusalCode;
using base::Result;

base::Refusal wrong_line(std::uint64_t line, const std::string& allowed, std::string_view got) {
    constexpr std::size_t shown_bytes_max = 80;
    return refusal(RefusalCode::InvalidArgument, "line " + std::to_string(line) + ": got \"" +
                                                     std::string{got.substr(0, shown_bytes_max)} + "\", allowed " +
                                                     allowed);
}

/// The next field of a line, which is shortened by it; false if it is no T.
template <class T>
bool take(std::string_view& line, T& value) {
    const std::string_view field = line.substr(0, line.find(','));
    line.remove_prefix(std::min(line.size(), field.size() + 1));
    const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
    return read.ec == std::errc{} && read.ptr == field.data() + field.size();
}

bool next_line(std::istream& in, std::string& line) {
    if (!std::getline(in, line))
        return false;
    if (line.ends_with('\r'))
        line.pop_back();
    return true;
}

} // namespace

Result<simulation::FirstPopulation> read_population(std::istream& in) {
    std::string heading;
    for (const std::string& column : tables::population_columns())
        heading += (heading.empty() ? "" : ",") + column;
    std::string line;
    if (!next_line(in, line) || line != heading)
        return wrong_line(1, "the heading " + heading, line);

    std::vector<std::vector<float>> islands; // by organism, then gene
    for (std::uint64_t number = 2; next_line(in, line); ++number) {
        std::string_view rest = line;
        std::uint64_t island = 0, organism = 0;
        evolution::Chromosome genes;
        bool good = take(rest, island) && take(rest, organism);
        for (float& gene : genes)
            good = good && take(rest, gene);
        if (!good || !rest.empty() || std::count(line.begin(), line.end(), ',') != evolution::gene_count + 1)
            return wrong_line(number, "an island, an organism and six genes", line);
        if (island == islands.size() && organism == 0)
            islands.emplace_back();
        const bool next = !islands.empty() && island == islands.size() - 1;
        if (!next || organism != islands.back().size() / evolution::gene_count) {
            const std::string island_now = std::to_string(islands.empty() ? 0 : islands.size() - 1);
            const std::string organism_next =
                std::to_string(islands.empty() ? 0 : islands.back().size() / evolution::gene_count);
            return wrong_line(number, "organism " + organism_next + " of island " + island_now + ", or the next island",
                              line);
        }
        islands.back().insert(islands.back().end(), genes.begin(), genes.end());
    }
    if (in.bad())
        return refusal(RefusalCode::Unavailable, std::string{"cannot be read: "} + std::strerror(errno));
    if (islands.empty())
        return refusal(RefusalCode::InvalidArgument, "holds no organism");
    std::vector<evolution::GeneMatrix> population;
    for (const std::vector<float>& genes : islands)
        population.push_back(Eigen::Map<const evolution::GeneMatrix>{
            genes.data(), evolution::gene_count, static_cast<Eigen::Index>(genes.size() / evolution::gene_count)});
    return std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(population));
}

Result<simulation::FirstPopulation> load_population(const std::string& path, const simulation::Parameters& parameters) {
    if (path.empty())
        return simulation::FirstPopulation{};
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        return refusal(RefusalCode::NotFound, path + ": this is a folder, not a population file");
    std::ifstream file{path, std::ios::binary};
    if (!file)
        return refusal(RefusalCode::NotFound, path + ": cannot be read: " + std::strerror(errno));
    auto population = read_population(file);
    if (!population)
        return refusal(population.error().code, path + ": " + population.error().message);
    if (auto faults = faults_of(*population, parameters, "population"); !faults.empty())
        return base::Refusal{.code = RefusalCode::InvalidArgument,
                             .message = path + ": a world with these parameters cannot begin so",
                             .violations = std::move(faults)};
    return population;
}

} // namespace evod::console
