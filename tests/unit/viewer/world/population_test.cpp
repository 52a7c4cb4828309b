#include "client/viewer/world/population.h"

#include "tests/unit/codec/px_column.h"
#include "tests/unit/viewer/world/population_pages.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Optional;

TEST(Population, IsAssembledFromPages) {
    Population population{2};
    EXPECT_FALSE(population.complete());
    ASSERT_EQ(population.add(page_of(0, 3, 5)), std::nullopt);
    EXPECT_FALSE(population.complete());
    EXPECT_EQ(population.next(), 3u);
    ASSERT_EQ(population.add(page_of(3, 2, 5)), std::nullopt);
    ASSERT_TRUE(population.complete());
    EXPECT_EQ(population.generation(), 4u);
    EXPECT_THAT(population.gene(0), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(population.gene(1), ElementsAre(100, 101, 102, 103, 104));
    EXPECT_EQ(population.first_parent(4), 5u);
    EXPECT_EQ(population.second_parent(4), 6u);
    EXPECT_EQ(population.choice(4), evod::v1::CHOICE_SEEK);
    EXPECT_THAT(population.force_x(), ElementsAre(1, 1, 1, 1, 1));
    EXPECT_THAT(population.force_y(), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(population.target_x_px(), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(population.target_y_px(), ElementsAre(0, 2, 4, 6, 8));
    EXPECT_EQ(population.range(1).min, 100);
    EXPECT_EQ(population.range(1).mean, 102);
    EXPECT_EQ(population.range(1).max, 104);
    EXPECT_THAT(population.children_of(3), ElementsAre(1, 2));
}

TEST(Population, TheFirstGenerationHasNoParents) {
    Population population{2};
    ASSERT_EQ(population.add(page_of(0, 2, 4, 1)), std::nullopt);
    ASSERT_EQ(population.add(page_of(2, 2, 4, 1)), std::nullopt);
    EXPECT_FALSE(population.has_parents());
    EXPECT_TRUE(population.children_of(1).empty());
}

TEST(Population, AnOrganismPlacedBetweenPagesOutdatesThem) {
    Population population{2};
    EXPECT_FALSE(population.is_outdated_by(page_of(0, 3, 5)));
    ASSERT_EQ(population.add(page_of(0, 3, 5)), std::nullopt);
    EXPECT_FALSE(population.is_outdated_by(page_of(3, 2, 5)));
    EXPECT_TRUE(population.is_outdated_by(page_of(3, 3, 6)));
    EXPECT_TRUE(population.is_outdated_by(page_of(3, 2, 5, 5)));
}

/// A snapshot of generation 4 in which the organisms with these ids live.
codec::ReceivedSnapshot snapshot_of(codec::Column ids) {
    codec::ReceivedSnapshot snapshot;
    snapshot.about.set_generation(4);
    snapshot.about.mutable_live()->set_alive_count(static_cast<std::uint32_t>(ids.size()));
    snapshot.entities = codec::snapshot_with({.id = std::move(ids), .x = {}, .y = {}, .width = {}, .height = {}});
    return snapshot;
}

TEST(Living, AreTheOrganismsWithAChoice) {
    Population population{2};
    auto page = page_of(0, 4, 4);
    (*page.mutable_choices())[2] = evod::v1::CHOICE_UNSPECIFIED;
    ASSERT_EQ(population.add(page), std::nullopt);
    EXPECT_THAT(living(population, nullptr), Optional(ElementsAre(0, 1, 3)));
}

TEST(Living, AreThoseInTheSnapshotAfterTheGeneration) {
    Population population{2};
    auto page = page_of(0, 4, 4);
    page.mutable_choices()->assign(4, static_cast<char>(evod::v1::CHOICE_UNSPECIFIED));
    ASSERT_EQ(population.add(page), std::nullopt);
    codec::ReceivedSnapshot snapshot = snapshot_of({1, 3});
    EXPECT_THAT(living(population, &snapshot), Optional(ElementsAre(1, 3)));
    const codec::ReceivedSnapshot empty = snapshot_of({});
    EXPECT_THAT(living(population, &empty), Optional(IsEmpty()));
    snapshot.about.mutable_live()->set_alive_count(3);
    EXPECT_EQ(living(population, &snapshot), std::nullopt) << "it contains only part of the island";
    snapshot = snapshot_of({1, 3});
    snapshot.about.set_generation(5);
    EXPECT_EQ(living(population, &snapshot), std::nullopt);
    EXPECT_EQ(living(population, nullptr), std::nullopt);
}

TEST(Population, IsCompleteWithoutOrganisms) {
    Population population{2};
    ASSERT_EQ(population.add(page_of(0, 0, 0)), std::nullopt);
    EXPECT_TRUE(population.complete());
}

TEST(Population, RejectsInvalidPages) {
    struct Fault {
        const char* what;
        std::function<void(evod::v1::Population&)> change;
    };
    const auto a_byte_less = [](std::string& bytes) { bytes.pop_back(); };
    const Fault faults[] = {
        {"population.genes has", [&](auto& page) { a_byte_less(*page.mutable_genes()); }},
        {"population.genes has", [&](auto& page) { page.mutable_genes()->append(8, '\0'); }},
        {"population.parents has", [&](auto& page) { a_byte_less(*page.mutable_parents()); }},
        {"population.parents has", [&](auto& page) { page.clear_parents(); }},
        {"population.founders has", [&](auto& page) { a_byte_less(*page.mutable_founders()); }},
        {"population.founders has", [&](auto& page) { page.clear_founders(); }},
        {"population.choices has", [&](auto& page) { a_byte_less(*page.mutable_choices()); }},
        {"population.choices contains", [&](auto& page) { (*page.mutable_choices())[0] = 9; }},
        {"population.forces has", [&](auto& page) { a_byte_less(*page.mutable_forces()); }},
        {"population.targets has", [&](auto& page) { page.clear_targets(); }},
        {"population.forces contains a value that is not a finite number",
         [&](auto& page) {
             page.mutable_forces()->resize(page.forces().size() - 4);
             put(*page.mutable_forces(), std::numeric_limits<float>::infinity());
         }},
        {"population.first is", [&](auto& page) { page.set_first(2); }},
        {"population.first is", [&](auto& page) { page.set_first(4'000'000'000); }},
        {"population.count is", [&](auto& page) { page.set_count(0); }},
        {"population.count is", [&](auto& page) { page.set_count(3); }},
        {"population.generation is", [&](auto& page) { page.set_generation(5); }},
        {"population.generation is", [&](auto& page) { page.set_organism_count(6); }},
        {"population.genes has", [&](auto& page) { page.set_count(1); }},
    };
    for (const Fault& fault : faults) {
        Population population{2};
        ASSERT_EQ(population.add(page_of(0, 3, 5)), std::nullopt);
        auto page = page_of(3, 2, 5);
        fault.change(page);
        const auto wrong = population.add(page);
        ASSERT_TRUE(wrong) << fault.what;
        EXPECT_THAT(*wrong, HasSubstr(fault.what));
        EXPECT_EQ(population.next(), 3u) << "nothing was added";
        EXPECT_EQ(population.add(page_of(3, 2, 5)), std::nullopt);
        EXPECT_TRUE(population.complete());
    }
}

} // namespace
} // namespace evod::viewer
