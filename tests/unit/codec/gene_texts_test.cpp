#include "proto/codec/gene_texts.h"

#include <gtest/gtest.h>

#include <limits>

namespace evod::codec {
namespace {

TEST(GeneTexts, AChoiceHasATextAndAnIndex) {
    v1::FreeGeneList list;
    list.add_genes()->set_name("rate");
    auto& material = *list.add_genes();
    material.set_name("material");
    material.add_choices("steel");
    material.add_choices("wood");
    const std::vector<std::string> names{"body_size", "material", "rate"};
    const GeneTexts texts{list, names};
    EXPECT_EQ(*texts.choice(1, 1), "wood");
    EXPECT_EQ(texts.text_of(1, 1, "1.00"), "wood");
    EXPECT_EQ(texts.text_of(2, 1, "1.00"), "1.00");
    EXPECT_EQ(texts.index_of(1, "wood"), 1.0F);
    EXPECT_EQ(texts.index_of(1, "clay"), std::nullopt);
    EXPECT_EQ(texts.all(1), "steel, wood");
    for (const float value : {-1.0F, 0.5F, 2.0F, 1e30F, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_EQ(texts.choice(1, value), nullptr) << value;
    }
    for (const std::size_t gene : {0U, 2U, 3U}) {
        EXPECT_EQ(texts.choice(gene, 0), nullptr) << gene;
        EXPECT_EQ(texts.index_of(gene, "wood"), std::nullopt) << gene;
        EXPECT_EQ(texts.all(gene), "") << gene;
    }
}

} // namespace
} // namespace evod::codec
