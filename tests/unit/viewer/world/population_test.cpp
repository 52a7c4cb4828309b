#include "client/viewer/world/population.h"

#include "tests/unit/viewer/world/population_pages.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
    EXPECT_EQ(population.choice(4), evod::v1::CHOICE_SEEK);
    EXPECT_THAT(population.force_x(), ElementsAre(1, 1, 1, 1, 1));
    EXPECT_THAT(population.force_y(), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(population.target_x_px(), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(population.target_y_px(), ElementsAre(0, 2, 4, 6, 8));
    EXPECT_EQ(population.range(1).min, 100);
    EXPECT_EQ(population.range(1).mean, 102);
    EXPECT_EQ(population.range(1).max, 104);
}

TEST(Population, AnOrganismPlacedBetweenPagesOutdatesThem) {
    Population population{2};
    EXPECT_FALSE(population.is_outdated_by(page_of(0, 3, 5)));
    ASSERT_EQ(population.add(page_of(0, 3, 5)), std::nullopt);
    EXPECT_FALSE(population.is_outdated_by(page_of(3, 2, 5)));
    EXPECT_TRUE(population.is_outdated_by(page_of(3, 3, 6)));
    EXPECT_TRUE(population.is_outdated_by(page_of(3, 2, 5, 5)));
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
