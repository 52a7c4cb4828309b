#include "server/protocol/breeding.h"

#include "tests/unit/protocol/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace evod::protocol {
namespace {

TEST(BreedingMessage, IsConvertedCompletely) {
    constexpr unsigned gene_count = 40;
    const std::vector<float> genes(gene_count, 100);
    evolution::GeneMask<> all{gene_count};
    all.flip_from(0);
    evolution::BreedingRecord record;
    record.places = {.elite = 1, .survivors = 3, .children = 5};
    record.contender_count = 7;
    record.pick_count = 9;
    record.contenders.push_back({1, 2, 3, 4, 5, {6, 11, 12}, 7, evolution::Migrant{8, 99, 9, 99}, 10});
    record.picks.push_back({1, 2.5, 3, {4, 5, 6}});
    for (const std::uint32_t id : {0, 2, 3}) {
        record.descendants.push_back({.id = id,
                                      .parents = {1, 2},
                                      .first_genes = genes,
                                      .second_genes = genes,
                                      .from_second = all,
                                      .second_share = 0.25,
                                      .crossed_genes = genes,
                                      .crossed = true,
                                      .order = {{1, 0, 2, 3, 4, 5}},
                                      .changes = {{1, evolution::ChangeKind::Creep, 2, 3},
                                                  {1, evolution::ChangeKind::Reset, 2, 3},
                                                  {1, evolution::ChangeKind::Scale, 2, 3},
                                                  {1, evolution::ChangeKind::BitFlip, 2, 3},
                                                  {1, evolution::ChangeKind::Clamp, 2, 3},
                                                  {1, evolution::ChangeKind::Reflect, 2, 3},
                                                  {1, evolution::ChangeKind::Redraw, 2, 3}},
                                      .genes = genes});
    }
    parameters::Parameters parameters;
    parameters.rearranging = evolution::OrderMutationMethod::Scramble;
    const v1::Breeding message = to_proto(record, parameters);
    auto unset = unset_in(message);
    // The caller adds the fields of the request. The first descendant has id 0.
    EXPECT_EQ(unset.erase("generation") + unset.erase("island") + unset.erase("descendants.id"), 3u);
    std::erase_if(unset, [](const std::string& path) { return path.starts_with("parameters."); }); // one kind of value
    EXPECT_THAT(unset, testing::IsEmpty());
    std::vector<double> contender;
    collect_numbers(message.contenders(0), contender);
    EXPECT_THAT(contender, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
    EXPECT_EQ(message.descendants(0).from_second(), ~0u);
    EXPECT_THAT(message.descendants(0).more_from_second(), testing::ElementsAre(0xffu));
    EXPECT_EQ(message.descendant_count(), 8u);
    EXPECT_EQ(message.descendants(0).kind(), v1::DESCENDANT_KIND_ELITE);
    EXPECT_EQ(message.descendants(1).kind(), v1::DESCENDANT_KIND_SURVIVOR);
    EXPECT_EQ(message.descendants(2).kind(), v1::DESCENDANT_KIND_CHILD);
    EXPECT_EQ(message.descendants(0).order_mutation().method(), "scramble");
    std::set<int> kinds;
    for (const auto& mutation : message.descendants(0).mutations()) {
        kinds.insert(mutation.kind());
    }
    EXPECT_EQ(kinds.size(), 7u);
    EXPECT_FALSE(kinds.contains(v1::MUTATION_KIND_UNSPECIFIED));
    std::set<std::string> parameter_names;
    for (const auto& assignment : message.parameters()) {
        parameter_names.insert(assignment.name());
    }
    EXPECT_TRUE(parameter_names.contains("population_size") && parameter_names.contains("immigrants_replace"));
    EXPECT_FALSE(parameter_names.contains("generation_s")); // a parameter of the model
}

} // namespace
} // namespace evod::protocol
