#include "client/viewer/plots/population.h"

#include <bit>

namespace evod::viewer {

namespace {

/// The number at `place` of a column of f32, little-endian.
float float_at(const std::string& bytes, std::size_t place) {
    std::uint32_t bits = 0;
    for (std::size_t i = 4; i-- > 0;) {
        bits = bits << 8 | static_cast<std::uint8_t>(bytes[4 * place + i]);
    }
    return std::bit_cast<float>(bits);
}

} // namespace

evod::v1::Request PopulationGenes::question(const std::string& world, std::uint32_t island) const {
    evod::v1::Request request;
    evod::v1::GetPopulation& query = *request.mutable_get_population();
    query.set_world(world);
    query.set_island(island);
    query.set_first_organism(read_);
    return request;
}

bool PopulationGenes::take(const evod::v1::Population& page) {
    const std::size_t count = page.count();
    const bool same =
        !organism_count_ || (page.generation() == generation_ && page.organism_count() == organism_count_);
    const std::size_t gene_count = count > 0 ? page.genes().size() / (4 * count) : genes_.size();
    if (!same || page.first() != read_ || page.organism_count() - read_ < count ||
        page.genes().size() != 4 * count * gene_count || (!genes_.empty() && genes_.size() != gene_count) ||
        page.choices().size() != count || (count == 0 && read_ < page.organism_count())) {
        return false;
    }
    generation_ = page.generation();
    organism_count_ = page.organism_count();
    genes_.resize(gene_count);
    for (std::size_t gene = 0; gene < gene_count; ++gene) {
        for (std::size_t i = 0; i < count; ++i) {
            genes_[gene].push_back(float_at(page.genes(), gene * count + i));
        }
    }
    for (const char choice : page.choices()) {
        lives_.push_back(choice != evod::v1::CHOICE_NONE);
        living_count_ += lives_.back() ? 1 : 0;
    }
    read_ += page.count();
    return true;
}

std::vector<float> PopulationGenes::gene(std::size_t index, bool of_the_living) const {
    std::vector<float> numbers;
    for (std::size_t i = 0; index < genes_.size() && i < genes_[index].size(); ++i) {
        if (!of_the_living || lives_[i]) {
            numbers.push_back(genes_[index][i]);
        }
    }
    return numbers;
}

} // namespace evod::viewer
