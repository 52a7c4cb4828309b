#include "proto/codec/descendant.h"

#include <gtest/gtest.h>

namespace evod::codec {
namespace {

/// A descendant whose genes from `begin` to before `end` come from the second parent.
evod::v1::Descendant crossed(int genes, int begin, int end) {
    evod::v1::Descendant descendant;
    for (int gene = 0; gene < genes; ++gene) {
        descendant.add_genes(0);
    }
    for (int word = 0; word < (genes + 31) / 32; ++word) {
        std::uint32_t bits = 0;
        for (int gene = word * 32; gene < word * 32 + 32; ++gene) {
            bits |= std::uint32_t{gene >= begin && gene < end} << (gene % 32);
        }
        if (word == 0) {
            descendant.set_from_second(bits);
        } else {
            descendant.add_more_from_second(bits);
        }
    }
    return descendant;
}

TEST(Descendant, EveryGeneOfALongChromosomeHasAParent) {
    const auto descendant = crossed(100, 31, 97);
    for (int gene = 0; gene < 100; ++gene) {
        EXPECT_EQ(comes_from_second(descendant, gene), gene >= 31 && gene < 97) << gene;
    }
}

TEST(Descendant, GenesBeyondTheWordsComeFromTheFirst) {
    auto descendant = crossed(100, 0, 100);
    descendant.mutable_more_from_second()->Truncate(1);
    EXPECT_TRUE(comes_from_second(descendant, 63));
    EXPECT_FALSE(comes_from_second(descendant, 64));
}

TEST(Descendant, ParentsOfGenesAreText) {
    EXPECT_EQ(parents_of_genes(crossed(6, 2, 6)), "112222");
    EXPECT_EQ(parents_of_genes(crossed(6, 0, 0)), "111111");
    EXPECT_EQ(parents_of_genes(crossed(328, 2, 312)), "2x1 310x2 16x1");
    EXPECT_EQ(parents_of_genes({}), "");
}

} // namespace
} // namespace evod::codec
