#include "server/evolution/gene_mask.h"

#include <gtest/gtest.h>

namespace evod::evolution {
namespace {

TEST(GeneMask, FlipsAndComplementsOnlyItsGenes) {
    for (const unsigned genes : {6u, 7u, 32u, 33u, 64u, 328u}) {
        GeneMask<> mask{genes};
        EXPECT_EQ(mask.count(), 0u);
        mask.flip_from(genes - 2);
        EXPECT_EQ(mask.count(), 2u);
        EXPECT_TRUE(mask.contains(genes - 1));
        EXPECT_FALSE(mask.contains(genes - 3));
        mask.complement();
        EXPECT_EQ(mask.count(), genes - 2);
        mask.assign([] { return ~0u; });
        EXPECT_EQ(mask.count(), genes);
        mask.complement();
        EXPECT_EQ(mask, GeneMask<>{genes});
    }
}

TEST(GeneMask, OfSixGenesIsOneWord) {
    GeneMask<6> mask{6};
    mask.assign([] { return ~0u; });
    EXPECT_EQ(mask.words().size(), 1u);
    EXPECT_EQ(mask.words()[0], 63u);
    mask.flip_from(2);
    EXPECT_EQ(mask.words()[0], 3u);
}

} // namespace
} // namespace evod::evolution
