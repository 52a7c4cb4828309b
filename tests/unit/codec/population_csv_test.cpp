#include "proto/codec/population_csv.h"

#include <gmock/gmock.h>

#include <sstream>
#include <string>

namespace evod::codec {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

const std::vector<std::string> body_genes{"normal_speed", "impulse",     "body_size",
                                          "base_health",  "food_radius", "poison_radius"};
const std::string heading = std::string{population_heading} + "\n";

Result<Population> read(const std::string& text) {
    std::istringstream in{text};
    return read_population(in);
}

std::string wrong(const std::string& text) {
    const auto population = read(text);
    return population ? "nothing is wrong" : population.error().what;
}

TEST(PopulationCsv, IslandsAreReadInOrder) {
    const auto islands = read(heading + "0,0,1,2,3,4,5,6.5\n0,1,7,8,9,10,11,12\r\n1,0,1e1,-2,3,4,5,0.1");
    ASSERT_TRUE(islands);
    EXPECT_EQ(islands->organism_count(0), 2u);
    EXPECT_THAT(islands->islands,
                ElementsAre(ElementsAre(1, 2, 3, 4, 5, 6.5f, 7, 8, 9, 10, 11, 12), ElementsAre(10, -2, 3, 4, 5, 0.1f)));
}

TEST(PopulationCsv, AWrittenPopulationIsReadBackExactly) {
    const std::vector<std::vector<float>> islands{{1, 2, 3, 4, 5, 6.5f, 0.1f, 1e-7f, -3.4e38f, 10, 11, 12},
                                                  {1.0f / 3, -2, 3, 4, 5, 0}};
    const std::string text = population_text({body_genes, islands});
    EXPECT_THAT(text, StartsWith(heading + "0,0,1,2,3,4,5,6.5\n0,1,0.1,1e-07,"));
    EXPECT_EQ(read(text).value().islands, islands);
}

TEST(PopulationCsv, FurtherGenesHaveTheirNames) {
    Population population{body_genes, {{1, 2, 3, 4, 5, 6, 0.5f, -1, 7, 8, 9, 10, 11, 12, 0.25f, 3}}};
    population.gene_names.insert(population.gene_names.end(), {"hidden1<food_bearing", "free0"});
    const std::string text = population_text(population);
    EXPECT_THAT(text,
                StartsWith(std::string{population_heading} + ",hidden1<food_bearing,free0\n0,0,1,2,3,4,5,6,0.5,-1\n"));
    const auto back = read(text);
    ASSERT_TRUE(back) << back.error().what;
    EXPECT_EQ(back->gene_names, population.gene_names);
    EXPECT_EQ(back->islands, population.islands);
    EXPECT_EQ(back->organism_count(0), 2u);
    EXPECT_THAT(wrong(std::string{population_heading} + ",\n"), StartsWith("line 1: got"));
    EXPECT_THAT(wrong(std::string{population_heading} + ",a,,b\n"), StartsWith("line 1: got"));
    EXPECT_THAT(wrong(std::string{population_heading} + "x\n"), StartsWith("line 1: got"));
    EXPECT_THAT(wrong(std::string{population_heading} + ",a\n0,0,1,2,3,4,5,6\n"),
                testing::EndsWith("allowed an island, an organism and 7 genes"));
}

TEST(PopulationCsv, ErrorsNameTheLine) {
    const std::string good = heading + "0,0,1,2,3,4,5,6\n";
    EXPECT_THAT(wrong(""), StartsWith("line 1: got \"\", allowed the heading island,"));
    EXPECT_THAT(wrong("0,0,1,2,3,4,5,6\n"), StartsWith("line 1: got \"0,0,1"));
    EXPECT_EQ(wrong(heading), "contains no organism");
    for (const char* line : {"0,1,1,2,3,4,5", "0,1,1,2,3,4,5,", "0,1,1,2,3,4,5,6,7", "0,1,1,2,3,4,5,6,",
                             "0,1,1,2,x,4,5,6", "", "0,-1,1,2,3,4,5,6", "0,1,1,2,3,4,5,1e99"}) {
        EXPECT_EQ(wrong(good + line + "\n"),
                  std::string{"line 3: got \""} + line + "\", allowed an island, an organism and 6 genes");
    }
    for (const char* line : {"0,0,1,2,3,4,5,6", "0,2,1,2,3,4,5,6", "1,1,1,2,3,4,5,6", "2,0,1,2,3,4,5,6"}) {
        EXPECT_EQ(wrong(good + line + "\n"),
                  std::string{"line 3: got \""} + line + "\", allowed organism 1 of island 0, or the next island");
    }
    EXPECT_EQ(wrong(heading + "1,0,1,2,3,4,5,6\n"),
              "line 2: got \"1,0,1,2,3,4,5,6\", allowed organism 0 of island 0, or the next island");
}

TEST(PopulationCsv, ErrorsQuoteOnlyTheBeginningOfALine) {
    EXPECT_THAT(wrong(heading + std::string(100'000, '9')), testing::SizeIs(testing::Lt(200u)));
}

} // namespace
} // namespace evod::codec
