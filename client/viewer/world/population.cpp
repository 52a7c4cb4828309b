#include "client/viewer/world/population.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>

namespace evod::viewer {

namespace {

std::uint32_t number_at(std::string_view bytes, std::size_t index) {
    std::uint32_t number = 0;
    for (unsigned i = 0; i < 4; ++i) {
        number |= std::uint32_t{static_cast<std::uint8_t>(bytes[4 * index + i])} << (8 * i);
    }
    return number;
}

void append(std::string_view bytes, std::size_t column, std::size_t count, std::vector<float>& to) {
    for (std::size_t i = 0; i < count; ++i) {
        to.push_back(std::bit_cast<float>(number_at(bytes, column * count + i)));
    }
}

bool all_finite(std::string_view floats) {
    for (std::size_t i = 0; i < floats.size() / 4; ++i) {
        if (!std::isfinite(std::bit_cast<float>(number_at(floats, i)))) {
            return false;
        }
    }
    return true;
}

std::string wrong(const char* field, std::size_t got, std::size_t allowed) {
    return std::string{"population."} + field + " has " + std::to_string(got) + " bytes, not " +
           std::to_string(allowed);
}

} // namespace

std::optional<std::string> Population::add(const evod::v1::Population& page) {
    const std::size_t count = page.count();
    if (page.first() != next()) {
        return "population.first is " + std::to_string(page.first()) + ", not " + std::to_string(next());
    }
    if (begun_ && (page.generation() != generation_ || page.organism_count() != organism_count_)) {
        return "population.generation is " + std::to_string(page.generation()) + ", not " + std::to_string(generation_);
    }
    if (count > page.organism_count() - std::min<std::size_t>(page.first(), page.organism_count()) ||
        (count == 0 && page.first() < page.organism_count())) {
        return "population.count is " + std::to_string(count) + ", but the page begins at organism " +
               std::to_string(page.first()) + " of " + std::to_string(page.organism_count());
    }
    if (page.genes().size() != 4 * count * gene_count()) {
        return wrong("genes", page.genes().size(), 4 * count * gene_count());
    }
    if (page.choices().size() != count) {
        return wrong("choices", page.choices().size(), count);
    }
    if (page.forces().size() != 8 * count) {
        return wrong("forces", page.forces().size(), 8 * count);
    }
    if (page.targets().size() != 8 * count) {
        return wrong("targets", page.targets().size(), 8 * count);
    }
    for (const auto& [field, floats] : {std::pair<const char*, const std::string&>{"genes", page.genes()},
                                        {"forces", page.forces()},
                                        {"targets", page.targets()}}) {
        if (!all_finite(floats)) {
            return std::string{"population."} + field + " contains a value that is not a finite number";
        }
    }
    if (!std::ranges::all_of(page.choices(), [](char choice) { return evod::v1::Choice_IsValid(choice); })) {
        return "population.choices contains an unknown choice";
    }
    begun_ = true;
    generation_ = page.generation();
    generation_tick_ = page.generation_tick();
    organism_count_ = page.organism_count();
    for (std::size_t gene = 0; gene < genes_.size(); ++gene) {
        append(page.genes(), gene, count, genes_[gene]);
    }
    for (std::size_t column = 0; column < 2; ++column) {
        append(page.forces(), column, count, forces_[column]);
        append(page.targets(), column, count, targets_[column]);
    }
    choices_.insert(choices_.end(), page.choices().begin(), page.choices().end());
    if (complete()) {
        finish();
    }
    return std::nullopt;
}

void Population::finish() {
    for (const std::vector<float>& gene : genes_) {
        Range range;
        if (!gene.empty()) {
            const auto [min, max] = std::ranges::minmax(gene);
            double sum = 0;
            for (const float value : gene) {
                sum += value;
            }
            range = {min, static_cast<float>(sum / static_cast<double>(gene.size())), max};
        }
        ranges_.push_back(range);
    }
}

} // namespace evod::viewer
