#include "server/experiments/population_file.h"

#include "proto/codec/population_csv.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>

namespace evod::experiments {
namespace {

using base::RefusalCode;
using testing::AllOf;
using testing::HasSubstr;

class PopulationFile : public testing::Test {
  protected:
    PopulationFile() {
        parameters.population_size = 2;
        parameters.island_count = 1;
    }
    /// further  the names of genes beyond those of the body, each after a comma.
    base::Result<simulation::FirstPopulation> load(const std::string& rows, const std::string& further = "") const {
        std::ofstream{path} << codec::population_heading << further << '\n' << rows;
        return load_population({path}, parameters);
    }
    std::string refusal_of(const std::string& rows) const {
        const auto loaded = load(rows);
        EXPECT_FALSE(loaded);
        return loaded ? "" : to_text(loaded.error());
    }

    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/first.csv";
    parameters::Parameters parameters;
};

TEST_F(PopulationFile, HasAColumnPerOrganism) {
    const auto loaded = load("0,0,100,101,102,103,104,105\n0,1,110,111,112,113,114,115\n");
    ASSERT_TRUE(loaded) << to_text(loaded.error());
    ASSERT_EQ((*loaded)->size(), 1u);
    const evolution::GeneMatrix& genes = (*loaded)->front();
    ASSERT_EQ(genes.rows(), evolution::body_gene_count);
    ASSERT_EQ(genes.cols(), 2);
    EXPECT_EQ(genes(0, 0), 100);
    EXPECT_EQ(genes(5, 0), 105);
    EXPECT_EQ(genes(0, 1), 110);
}

TEST_F(PopulationFile, NoPathIsNoPopulation) {
    const auto loaded = load_population({}, parameters);
    ASSERT_TRUE(loaded);
    EXPECT_EQ(*loaded, nullptr);
}

TEST_F(PopulationFile, MustFitTheWorld) {
    const std::string one = "0,0,100,101,102,103,104,105\n", two = one + "0,1,110,111,112,113,114,115\n";
    EXPECT_THAT(refusal_of(two + "0,2,110,111,112,113,114,115\n"), AllOf(HasSubstr(path), HasSubstr("population")));
    EXPECT_THAT(refusal_of(two + "1,0,100,101,102,103,104,105\n"), HasSubstr("population"));
    EXPECT_THAT(refusal_of("0,0,100,101,1e9,103,104,105\n0,1,110,111,112,113,114,115\n"),
                HasSubstr("population[0].organism[0].body_size"));
}

TEST_F(PopulationFile, MayLeavePlaces) {
    const auto loaded = load("0,22,100,101,102,103,104,105\n");
    ASSERT_TRUE(loaded) << to_text(loaded.error());
    EXPECT_EQ((*loaded)->front().cols(), 1);
}

TEST_F(PopulationFile, SeveralFilesArePutTogether) {
    const std::string other = folder.path() + "/second.csv";
    std::ofstream{path} << codec::population_heading << "\n0,7,100,101,102,103,104,105\n";
    std::ofstream{other} << codec::population_heading << "\n0,7,110,111,112,113,114,115\n";
    const auto loaded = load_population({path, other}, parameters);
    ASSERT_TRUE(loaded) << to_text(loaded.error());
    EXPECT_EQ((*loaded)->front()(0, 0), 100);
    EXPECT_EQ((*loaded)->front()(0, 1), 110);
    const auto thrice = load_population({path, other, path}, parameters);
    ASSERT_FALSE(thrice);
    EXPECT_THAT(to_text(thrice.error()), AllOf(HasSubstr(other), HasSubstr("3 organisms")));
}

TEST_F(PopulationFile, FreeGenesMayHaveAnyOrder) {
    parameters.free_genes = 2;
    const auto loaded = load("0,0,100,101,102,103,104,105,0.25,0.75\n", ",free1,free0");
    ASSERT_TRUE(loaded) << to_text(loaded.error());
    EXPECT_EQ((*loaded)->front()(6, 0), 0.75f);
    EXPECT_EQ((*loaded)->front()(7, 0), 0.25f);
}

TEST_F(PopulationFile, HasTheGenesOfTheWorld) {
    const std::string six = "0,0,100,101,102,103,104,105\n0,1,110,111,112,113,114,115\n",
                      eight = "0,0,100,101,102,103,104,105,0,1\n0,1,110,111,112,113,114,115,1,0\n";
    const auto fault = [&](const std::string& rows, const std::string& further) {
        const auto loaded = load(rows, further);
        return loaded ? "none" : to_text(loaded.error().violations.at(0));
    };
    EXPECT_EQ(fault(eight, ",free0,free1"), "population.gene_names[6]: got the gene free0, allowed no gene");
    parameters.free_genes = 2;
    EXPECT_EQ(fault(eight, ",free0,free1"), "none");
    EXPECT_EQ((**load(eight, ",free0,free1"))[0](7, 0), 1);
    EXPECT_EQ(fault(eight, ",free0,free2"), "population.gene_names[7]: got the gene free2, allowed the gene free1");
    EXPECT_EQ(fault(six, ""), "population.gene_names[6]: got no gene, allowed the gene free0");
    const std::string outside = "0,0,100,101,102,103,104,105,0,2\n0,1,110,111,112,113,114,115,1,0\n";
    EXPECT_EQ(fault(outside, ",free0,free1"),
              "population[0].organism[0].free1: got 2, allowed 0 to 1 (free_gene_min, free_gene_max)");
}

TEST_F(PopulationFile, NamesTheFileAndTheLine) {
    EXPECT_THAT(refusal_of("0,0,100,101,102,103,104\n"), AllOf(HasSubstr(path), HasSubstr("line 2")));
    EXPECT_THAT(refusal_of(""), AllOf(HasSubstr(path), HasSubstr("no organism")));
    const auto missing = load_population({folder.path() + "/none.csv"}, parameters);
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().message, HasSubstr("/none.csv"));
}

} // namespace
} // namespace evod::experiments
