#include "proto/codec/gene_texts.h"

#include <algorithm>

namespace evod::codec {

GeneTexts::GeneTexts(const v1::FreeGeneList& list, std::span<const std::string> gene_names) {
    for (const v1::FreeGene& listed : list.genes()) {
        const auto gene = static_cast<std::size_t>(std::ranges::find(gene_names, listed.name()) - gene_names.begin());
        if (gene < gene_names.size() && listed.choices_size() > 0) {
            choices_.resize(std::max(choices_.size(), gene + 1));
            choices_[gene].assign(listed.choices().begin(), listed.choices().end());
        }
    }
}

GeneTexts::GeneTexts(const v1::WorldInfo& world)
    : GeneTexts{world.free_genes(), std::vector<std::string>{world.gene_names().begin(), world.gene_names().end()}} {}

const std::string* GeneTexts::choice(std::size_t gene, float value) const {
    if (gene >= choices_.size() || !(value >= 0 && value < static_cast<float>(choices_[gene].size()))) {
        return nullptr;
    }
    const auto index = static_cast<std::size_t>(value);
    return static_cast<float>(index) == value ? &choices_[gene][index] : nullptr;
}

std::string GeneTexts::text_of(std::size_t gene, float value, std::string number) const {
    const std::string* const text = choice(gene, value);
    return text != nullptr ? *text : number;
}

std::optional<float> GeneTexts::index_of(std::size_t gene, std::string_view text) const {
    if (gene >= choices_.size()) {
        return std::nullopt;
    }
    const auto found = std::ranges::find(choices_[gene], text);
    return found == choices_[gene].end() ? std::nullopt
                                         : std::optional{static_cast<float>(found - choices_[gene].begin())};
}

std::string GeneTexts::all(std::size_t gene) const {
    std::string text;
    if (gene < choices_.size()) {
        for (const std::string& choice : choices_[gene]) {
            text += (text.empty() ? "" : ", ") + choice;
        }
    }
    return text;
}

} // namespace evod::codec
