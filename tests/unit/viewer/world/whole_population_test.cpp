#include "client/viewer/world/whole_population.h"

#include "tests/unit/viewer/world/population_pages.h"
#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// A world with three islands.
struct WholePopulationTest : ViewedWorldTest {
    WholePopulationTest() {
        show_first_snapshot(world, session, 50);
        population.request(world, [this](const auto& answer) { read = answer; });
    }
    void answer(const evod::v1::Request& request, const evod::v1::Population& page) {
        ASSERT_TRUE(request.has_get_population());
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        *message.mutable_response()->mutable_population() = page;
        session.send(message);
    }
    /// The next request, which an update sends as soon as the answer before it has arrived.
    evod::v1::Request next() {
        until(world, [&] { return session.unread_bytes() > 0; });
        return session.read_request();
    }

    ViewedWorld world{wanted()};
    core::FakeSession session = begin(world);
    WholePopulation population;
    std::optional<core::Result<WholePopulation::Genes>> read;
};

TEST_F(WholePopulationTest, ReadsAllPagesOfAllIslands) {
    for (std::uint32_t island = 0; island < 3; ++island) {
        auto request = next();
        EXPECT_EQ(request.get_population().world(), "default");
        EXPECT_EQ(request.get_population().island(), island);
        EXPECT_EQ(request.get_population().first_organism(), 0u);
        answer(request, page_of(0, 2, 3, 4, 6));
        request = next();
        EXPECT_EQ(request.get_population().island(), island);
        EXPECT_EQ(request.get_population().first_organism(), 2u);
        answer(request, page_of(2, 1, 3, 4, 6));
    }
    until(world, [&] { return read.has_value(); });
    ASSERT_TRUE(*read);
    const WholePopulation::Genes& genes = **read;
    EXPECT_EQ(genes.world, "default");
    EXPECT_EQ(genes.generation, 4u);
    ASSERT_THAT(genes.population.islands, SizeIs(3));
    EXPECT_THAT(genes.population.islands[2],
                ElementsAre(0, 100, 200, 300, 400, 500, 1, 101, 201, 301, 401, 501, 2, 102, 202, 302, 402, 502));
}

TEST_F(WholePopulationTest, BeginsAgainWithANewGeneration) {
    answer(next(), page_of(0, 3, 3, 4, 6));
    answer(next(), page_of(0, 3, 3, 5, 6)); // of island 1
    for (std::uint32_t island = 0; island < 3; ++island) {
        const auto request = next();
        EXPECT_EQ(request.get_population().island(), island);
        answer(request, page_of(0, 3, 3, 6, 6));
    }
    until(world, [&] { return read.has_value(); });
    ASSERT_TRUE(*read);
    EXPECT_EQ((*read)->generation, 6u);
    EXPECT_THAT((*read)->population.islands, SizeIs(3));
}

TEST_F(WholePopulationTest, BeginsAgainAfterAnOrganismWasPlaced) {
    answer(next(), page_of(0, 2, 3, 4, 6));
    answer(next(), page_of(2, 2, 4, 4, 6)); // now of four organisms
    for (std::uint32_t island = 0; island < 3; ++island) {
        const auto request = next();
        EXPECT_EQ(request.get_population().first_organism(), 0u);
        answer(request, page_of(0, 4, 4, 4, 6));
    }
    until(world, [&] { return read.has_value(); });
    ASSERT_TRUE(*read);
    EXPECT_THAT((*read)->population.islands[0], SizeIs(24));
}

TEST_F(WholePopulationTest, GivesUpOnAWorldThatIsTooFast) {
    std::uint64_t generation = 4;
    for (unsigned attempt = 0; attempt < WholePopulation::attempts_max; ++attempt) {
        answer(next(), page_of(0, 3, 3, ++generation, 6));
        answer(next(), page_of(0, 3, 3, ++generation, 6));
    }
    until(world, [&] { return read.has_value(); });
    ASSERT_FALSE(*read);
    EXPECT_THAT(read->error().what, HasSubstr("pause the world first"));
}

TEST_F(WholePopulationTest, ReportsARefusalAndAnInvalidAnswer) {
    session.refuse(next().request_id(), evod::v1::CODE_RESOURCE_EXHAUSTED, "the server is busy");
    until(world, [&] { return read.has_value(); });
    EXPECT_EQ(read->error().what, "The server is busy");
    read.reset();
    population.request(world, [this](const auto& answer) { read = answer; });
    answer(next(), page_of(0, 3, 3, 4, 2));
    until(world, [&] { return read.has_value(); });
    EXPECT_EQ(read->error().what, "The server's answer is invalid: population.genes has 24 bytes, not 72");
}

} // namespace
} // namespace evod::viewer
