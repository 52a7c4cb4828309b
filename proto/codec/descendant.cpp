#include "proto/codec/descendant.h"

namespace evod::codec {
namespace {

constexpr int bits_of_word = 32;
constexpr int most_single_genes = 12;

} // namespace

bool comes_from_second(const evod::v1::Descendant& descendant, int gene) {
    const int word = gene / bits_of_word;
    if (word > descendant.more_from_second_size()) {
        return false; // trailing words of zeros may be missing
    }
    const std::uint32_t bits = word == 0 ? descendant.from_second() : descendant.more_from_second(word - 1);
    return (bits >> (gene % bits_of_word) & 1) != 0;
}

std::string parents_of_genes(const evod::v1::Descendant& descendant) {
    const int count = descendant.genes_size();
    std::string text;
    for (int gene = 0, end = 0; gene < count; gene = end) {
        const bool second = comes_from_second(descendant, gene);
        for (end = gene + 1; end < count && comes_from_second(descendant, end) == second; ++end) {
        }
        const char parent = second ? '2' : '1';
        if (count <= most_single_genes) {
            text.append(static_cast<std::size_t>(end - gene), parent);
        } else {
            text += (text.empty() ? "" : " ") + std::to_string(end - gene) + "x" + parent;
        }
    }
    return text;
}

} // namespace evod::codec
