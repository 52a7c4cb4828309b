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
    EXPECT_THAT(wrong(std::string{population_heading} + ",a,a\n"), StartsWith("line 1: got"));
    EXPECT_THAT(wrong(std::string{population_heading} + ",a,,b\n"), StartsWith("line 1: got"));
    EXPECT_EQ(wrong(std::string{population_heading} + "x\n"), "contains no organism");
    EXPECT_THAT(wrong(std::string{population_heading} + ",a\n0,0,1,2,3,4,5,6\n"),
                testing::EndsWith("allowed an island, an organism and 7 genes, so 9 cells, not 8"));
}

TEST(PopulationCsv, AGeneThatIsAChoiceMayBeItsTextOrItsIndex) {
    v1::FreeGeneList list;
    auto& act = *list.add_genes();
    act.set_name("act");
    for (const char* choice : {"relu", "a,b", "1", "16"}) {
        act.add_choices(choice);
    }
    std::istringstream in{"rate,island,act,organism\n0.5,0,relu,0\n1,0,\"a,b\",1\n2,0, 16 ,2\n3,0,0,3\n4,0,1,4\n"};
    const auto population = read_population(in, list);
    ASSERT_TRUE(population) << population.error().what;
    EXPECT_THAT(population->islands, ElementsAre(ElementsAre(0.5f, 0, 1, 1, 2, 3, 3, 0, 4, 2)));
    std::istringstream other{"island,organism,act\n0,0,gelu\n"};
    EXPECT_EQ(read_population(other, list).error().what,
              "line 2: got \"0,0,gelu\", allowed one of relu, a,b, 1, 16 (column act)");
}

TEST(PopulationCsv, ChromosomesMayHaveNoGenesOfTheBody) {
    const auto population = read("organism,free1,island,free0\n0,2,0,1\n");
    ASSERT_TRUE(population) << population.error().what;
    EXPECT_THAT(population->gene_names, ElementsAre("free1", "free0"));
    EXPECT_THAT(population->islands, ElementsAre(ElementsAre(2, 1)));
    EXPECT_EQ(population_text(*population), "island,organism,free1,free0\n0,0,2,1\n");
}

TEST(PopulationCsv, ErrorsNameTheLine) {
    const std::string good = heading + "0,0,1,2,3,4,5,6\n";
    EXPECT_THAT(wrong(""), StartsWith("line 1: got \"\", allowed the heading island,"));
    EXPECT_THAT(wrong("0,0,1,2,3,4,5,6\n"), StartsWith("line 1: got \"0,0,1"));
    EXPECT_THAT(wrong("island,organism\n0,0\n"), StartsWith("line 1: got"));
    EXPECT_EQ(wrong(heading), "contains no organism");
    for (const char* line : {"0,1,1,2,3,4,5", "0,1,1,2,3,4,5,", "0,1,1,2,3,4,5,6,7", "0,1,1,2,3,4,5,6,",
                             "0,1,1,2,x,4,5,6", "0,-1,1,2,3,4,5,6", "0,1,1,2,3,4,5,1e99"}) {
        EXPECT_THAT(wrong(good + line + "\n"), StartsWith(std::string{"line 3: got \""} + line +
                                                          "\", allowed an island, an organism and 6 genes"));
    }
    EXPECT_THAT(wrong(good + "0,1,1,2,x,4,5,6\n"), testing::EndsWith("(column body_size)"));
    EXPECT_THAT(wrong(good + "0,x,1,2,3,4,5,6\n"), testing::EndsWith("(column organism)"));
    EXPECT_THAT(wrong(good + "0,1,1,5,2,3,4,5,6\n"), testing::HasSubstr("decimal comma"));
}

TEST(PopulationCsv, NumbersOfOrganismsAreFree) {
    const auto read_back = read(heading + "7,22,1,2,3,4,5,6\n3,0,11,2,3,4,5,6\n7,22,21,2,3,4,5,6\n");
    ASSERT_TRUE(read_back) << read_back.error().what;
    EXPECT_THAT(read_back->islands,
                ElementsAre(ElementsAre(11, 2, 3, 4, 5, 6), ElementsAre(1, 2, 3, 4, 5, 6, 21, 2, 3, 4, 5, 6)));
}

TEST(PopulationCsv, FilesOfSpreadsheetsAndRAreRead) {
    const std::vector<std::vector<float>> expected{{1.5f, 2, 3, 4, 5, 6, 0.25f}};
    for (const std::string& text :
         {"\xef\xbb\xbf" + std::string{population_heading} + ",free0\r\n0, 0, 1.5, 2,3,4,5 ,6,0.25\r\n\r\n",
          std::string{"organism;island;free0;impulse;normal_speed;body_size;base_health;food_radius;poison_radius\n"
                      "0;0;0,25;2;1,5;3;4;5;6\n;;;;;;;;\n"},
          std::string{"\"\",\"island\",\"organism\",\"normal_speed\",\"impulse\",\"body_size\",\"base_health\","
                      "\"food_radius\",\"poison_radius\",\"free0\"\n\"1\",0,0,1.5,2,3,4,5,6,0.25\n"},
          std::string{"island\torganism\tnormal_speed\timpulse\tbody_size\tbase_health\tfood_radius\tpoison_radius"
                      "\tfree0\n0\t0\t1,5\t2\t3\t4\t5\t6\t0.25\n"}}) {
        const auto population = read(text);
        ASSERT_TRUE(population) << text << population.error().what;
        EXPECT_EQ(population->islands, expected) << text;
        EXPECT_EQ(population->gene_names.at(6), "free0");
    }
}

TEST(PopulationCsv, ErrorsQuoteOnlyTheBeginningOfALine) {
    EXPECT_THAT(wrong(heading + std::string(100'000, '9')), testing::SizeIs(testing::Lt(200u)));
}

} // namespace
} // namespace evod::codec
