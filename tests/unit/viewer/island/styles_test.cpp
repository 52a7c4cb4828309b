#include "client/viewer/island/styles.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Styles, FoodAndPoisonDifferInShapeInTheVividSkin) {
    for (const Background background : {Background::Dark, Background::Light}) {
        const Styles& styles = styles_of({Skin::Vivid, background});
        EXPECT_EQ(styles.food.form, Form::Leaf);
        EXPECT_EQ(styles.poison.form, Form::Star);
        EXPECT_EQ(styles.organism.form, Form::Body);
        EXPECT_EQ(styles.food.fill, palette::of({Skin::Vivid, background}).food);
    }
}

TEST(Styles, TheClassicSkinHasHollowCirclesAndDots) {
    const Styles& styles = styles_of({Skin::Classic});
    EXPECT_EQ(styles.organism.form, Form::Circle);
    EXPECT_EQ(styles.organism.fill.alpha, 0);
    EXPECT_EQ(styles.organism.edge, palette::organism);
    EXPECT_EQ(styles.food.form, Form::Circle);
    EXPECT_EQ(styles.poison.form, Form::Circle);
    EXPECT_EQ(&styles, &styles_of({Skin::Classic, Background::Dark})) << "it has one background";
}

TEST(Styles, VividNumbersNeedLargerOrganisms) {
    EXPECT_GT(styles_of({Skin::Vivid}).label_zoom_min, styles_of({Skin::Classic}).label_zoom_min);
}

} // namespace
} // namespace evod::viewer
