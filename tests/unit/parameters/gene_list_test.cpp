#include "server/parameters/gene_list.h"

#include "server/parameters/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::parameters {
namespace {

using evolution::FreeGene;

constexpr const char* five_kinds = R"([{"name": "angle", "min": -90, "max": 90},
 {"name": "rate", "min": 0.001, "max": 1, "scale": "logarithmic", "mutation_step": 0.05},
 {"name": "layers", "min": 1, "max": 8, "step": 1},
 {"name": "material", "choices": ["steel", "oak \"A\"", "3"]},
 {"name": "tour", "permutation": 32}])";

TEST(GeneList, IsWrittenAsItWasRead) {
    const auto genes = parse_gene_list(five_kinds);
    ASSERT_TRUE(genes);
    EXPECT_EQ(genes->gene_count(), 36u);
    EXPECT_EQ(to_json_text(*genes), five_kinds);
    EXPECT_EQ(*parse_gene_list(to_json_text(*genes)), *genes);
    EXPECT_EQ(to_json_text({}), "[]");
    EXPECT_EQ(parse_gene_list(R"([{}, {"choices": [50, 75.5]}])")->list().at(1).name, "free1");
    EXPECT_THAT(parse_gene_list(R"([{"choices": [50, 75.5]}])")->list().at(0).choices,
                testing::ElementsAre("50", "75.5"));
}

TEST(GeneList, IsPartOfAnExperiment) {
    const std::string text =
        std::string{R"({"fitness": "external", "external_bodies": false, "free_genes": )"} + five_kinds + "}";
    const auto experiment = parse_experiment(text);
    ASSERT_TRUE(experiment) << experiment.error().violations.at(0).allowed;
    EXPECT_EQ(experiment->parameters.free_genes, 36u);
    const auto again = parse_experiment(to_experiment_text(experiment->parameters));
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->parameters == experiment->parameters);
    Parameters other = experiment->parameters;
    other.listed_genes = {};
    EXPECT_FALSE(other == experiment->parameters);
    // The number of genes is that of the list.
    EXPECT_FALSE(assign(experiment->parameters, std::vector<Assignment>{{"free_genes", 7u}}));
}

TEST(GeneList, FaultsNameTheGeneAndItsField) {
    struct Case {
        const char* list;
        std::string field, allowed;
    };
    const Case cases[] = {
        {R"([{"min": 1, "max": 0}])", "free_genes[0].max", "above min (1)"},
        {R"([{}, {"min": 0, "max": 0}])", "free_genes[1].max", "above min (0)"},
        {R"([{"name": "body_size"}])", "free_genes[0].name", "a name that no other gene has"},
        {R"([{"name": "a"}, {"name": "a"}])", "free_genes[1].name", "a name that no other gene has"},
        {R"([{"name": "a1"}, {"name": "a", "permutation": 3}])", "free_genes[1].name", "no other gene"},
        {R"([{"name": "two words"}])", "free_genes[0].name", "letters, digits and _"},
        {R"([{"min": 0, "max": 20000000, "step": 1}])", "free_genes[0].max", "±16777216"},
        {R"([{"min": -16777217, "max": 0, "step": 1}])", "free_genes[0].min", "±16777216"},
        {R"([{"min": 1e6, "max": 1e6, "step": 0.01}])", "free_genes[0].max", "above min"},
        {R"([{"min": 1000000, "max": 1000001, "step": 0.01}])", "free_genes[0].step", "because values are float32"},
        {R"([{"min": 0, "max": 1, "step": 0.3}])", "free_genes[0].max", "a whole number of steps"},
        {R"([{"min": 1000000, "max": 1000000.01}])", "free_genes[0].max", "float32"},
        {R"([{"min": 0, "max": 1, "scale": "logarithmic"}])", "free_genes[0].min", "logarithmic"},
        {R"([{"min": 1, "max": 2, "step": 1, "scale": "logarithmic"}])", "free_genes[0].step", "logarithmic"},
        {R"([{"min": 0, "max": 1e13}])", "free_genes[0].max", "-1e12 to 1e12"},
        {R"([{"choices": ["a"]}])", "free_genes[0].choices", "2 to 1000"},
        {R"([{"choices": ["a", "a"]}])", "free_genes[0].choices", "all different"},
        {R"([{"choices": "a"}])", "free_genes[0].choices", "a list of strings or numbers"},
        {R"([{"permutation": 1}])", "free_genes[0].permutation", "2 to 1000"},
        {R"([{"permutation": 5, "min": 3}])", "free_genes[0].min", "no other field"},
        {R"([{"maximum": 3}])", "free_genes[0].maximum", "name, min, max"},
        {R"([{"scale": "log"}])", "free_genes[0].scale", "\"linear\" or \"logarithmic\""},
        {R"([{"min": "0"}])", "free_genes[0].min", "a number"},
        {R"([3])", "free_genes[0]", "an object"},
        {R"([{"permutation": 999}, {"permutation": 2, "name": "b"}])", "free_genes", "at most 1000 genes"},
        {R"({"min": 3})", "free_genes", "a list of genes"},
    };
    for (const Case& wrong : cases) {
        const auto refused = parse_gene_list(wrong.list);
        ASSERT_FALSE(refused) << wrong.list;
        const base::Violation violation = refused.error().violations.at(0);
        EXPECT_THAT(violation.field, testing::StartsWith(wrong.field)) << wrong.list;
        EXPECT_THAT(violation.allowed, testing::HasSubstr(wrong.allowed)) << wrong.list;
    }
    EXPECT_EQ(parse_gene_list(cases[4].list).error().violations.at(0).got, "\"a1\"") << "the name that clashes";
}

} // namespace
} // namespace evod::parameters
