#include "client/ctl/input_file.h"

#include "client/ctl/stop.h"

#include <gmock/gmock.h>

namespace evod::ctl {
namespace {

TEST(InputFile, TheChoicesOfAnExperimentAreTextsAndNumbers) {
    const v1::FreeGeneList list = choices_in(R"({"fitness": "external", "free_genes": [
        {"name": "rate", "min": 0, "max": 1}, {"name": "act", "choices": ["relu", "a,b"]}, {"choices": [16, 0.5]}]})");
    ASSERT_EQ(list.genes_size(), 2);
    EXPECT_EQ(list.genes(0).name(), "act");
    EXPECT_THAT(list.genes(0).choices(), testing::ElementsAre("relu", "a,b"));
    EXPECT_EQ(list.genes(1).name(), "free2");
    EXPECT_THAT(list.genes(1).choices(), testing::ElementsAre("16", "0.5"));
}

TEST(InputFile, AnExperimentWithoutAListHasNoChoices) {
    for (const char* const text :
         {"", "{", "[]", "{}", R"({"free_genes": 3})", R"({"free_genes": [1, {"choices": 2}]})"}) {
        EXPECT_EQ(choices_in(text).genes_size(), 0) << text;
    }
}

TEST(InputFile, AMissingPopulationFileIsRefused) {
    EXPECT_THROW(population_in("/nowhere/population.csv", {}), Stop);
}

} // namespace
} // namespace evod::ctl
