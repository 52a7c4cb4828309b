// Runs of colonies: recovery, verification, forks and tables.
#include "server/replay/breeding.h"
#include "server/replay/lineage.h"
#include "server/replay/mismatch.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "server/run_file/checkpoint.h"
#include "server/simulation/entities.h"
#include "tests/unit/replay/stored_run_fixture.h"

#include <gmock/gmock.h>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

enum class Kind { Births, BirthsAndPredators, Predators };
void PrintTo(Kind kind, std::ostream* out) {
    *out << (kind == Kind::Births ? "births" : kind == Kind::Predators ? "predators" : "births_and_predators");
}

class StoredColonyTest : public StoredRuns, public testing::WithParamInterface<Kind> {
  protected:
    static bool has_births() { return GetParam() != Kind::Predators; }
    static parameters::Parameters colony() {
        parameters::Parameters parameters = small_world();
        parameters.reproduction =
            has_births() ? parameters::Reproduction::Births : parameters::Reproduction::Generations;
        parameters.births = parameters::Births::Asexual;
        parameters.food_count = 100;
        parameters.food_health = 60;
        parameters.birth_cost = 5;
        parameters.lifespan_s = has_births() ? 5 : 0;
        parameters.predator_count = GetParam() == Kind::Births ? 0 : 3;
        parameters.predator_from = 2;
        parameters.handling_s = 1;
        return parameters;
    }
    std::unique_ptr<RecordedRun> begin() {
        return std::make_unique<RecordedRun>(data, *thread, base::Seed{7}, simulation::FirstPopulation{},
                                             parameters::Schedule{}, colony());
    }
    /// Places an organism where there is room.
    static void place_organism(RecordedRun& run) {
        simulation::PlaceEntities command{.world = "w", .island = 1};
        command.organisms.push_back({100, 100, std::vector<float>(evolution::body_gene_count, 100)});
        while (!check(run.world(), command)) {
            command.organisms[0].x_px += 10;
        }
        v1::Request request;
        request.mutable_place()->set_world("w");
        request.mutable_place()->set_island(1);
        v1::PlacedOrganism& placed = *request.mutable_place()->add_organisms();
        const auto& [x_px, y_px, genes] = command.organisms[0];
        placed.set_x_px(x_px);
        placed.set_y_px(y_px);
        placed.mutable_genes()->Add(genes.data(), genes.data() + genes.size());
        run.command(request);
    }
};

TEST_P(StoredColonyTest, AKilledRunContinues) {
    for (const std::uint64_t ticks : {60u, 120u, 121u, 500u, 733u}) {
        begin_again();
        base::StateHash hash;
        {
            const auto run = begin();
            run->advance(ticks);
            hash = run->world().hash();
            run->checkpoint();
        }
        const auto file = file_left();
        const auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash) << ticks;
        expect_agrees(*file);
    }
}

TEST_P(StoredColonyTest, APlacedOrganismStaysInTheColony) {
    {
        const auto run = begin();
        run->advance(200);
        place_organism(*run);
        run->advance(300);
    }
    const auto file = file_left();
    expect_agrees(*file);
}

TEST_P(StoredColonyTest, AForkContinues) {
    for (const std::uint64_t ticks : {240u, 333u}) {
        begin_again();
        base::StateHash hash;
        {
            const auto run = begin();
            run->advance(ticks);
            run->fork({5, 6});
            run->advance(300, "fork");
            hash = (*run->laboratory().find("fork"))->world.hash();
            run->recorder().close_all(run->laboratory());
        }
        const auto file = file_left("fork");
        const auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash) << ticks;
        expect_agrees(*file);
        const auto history = file->generations().history(file->identity().first_generation, 100);
        ASSERT_TRUE(history && !history->empty());
        EXPECT_TRUE(history->back()[0].colony.has_value()) << "it is inherited";
    }
}

TEST_P(StoredColonyTest, AForkOfAFileBeginsWithAnyGeneration) {
    base::StateHash hash;
    {
        const auto run = begin();
        run->advance(360);
        run->advance(1);
        run->advance(100);
        hash = run->world().hash();
    }
    const auto file = file_left();
    const std::string path = folder.path() + "/fork.evod";
    const auto forked = fork(*file, 4, path, "fork", {8, 9}, executor);
    ASSERT_TRUE(forked) << to_text(forked.error());
    EXPECT_EQ(forked->generation, 4u);
    auto copy = RunFile::open(path, {});
    ASSERT_TRUE(copy) << to_text(copy.error());
    auto recovered = recover(**copy, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    while (recovered->world.moment().tick < 461) {
        recovered->world.advance_tick(executor);
    }
    EXPECT_EQ(recovered->world.hash(), hash);
}

TEST_P(StoredColonyTest, EveryOrganismHasOneRowOfBirths) {
    {
        const auto run = begin();
        run->advance(300);
        place_organism(*run);
        run->advance(420);
        run->recorder().close_all(run->laboratory());
    }
    const auto file = file_left();
    ASSERT_TRUE(file->pin_snapshot());
    if (!has_births()) {
        std::ostringstream text;
        const auto refused = write_table({*file, executor}, {.table = RunTable::Births}, text);
        ASSERT_FALSE(refused);
        EXPECT_THAT(to_text(refused.error()), HasSubstr("a world with births"));
        return;
    }
    std::size_t born = 0;
    for (const simulation::GenerationRows& rows : *file->generations().history(100, 100)) {
        for (const simulation::GenerationStatistics& island : rows) {
            born += island.colony->born_count;
            for (const auto& predators : island.predators) {
                born += predators.colony->born_count;
            }
        }
    }
    EXPECT_GT(born, 20u);
    const std::vector<std::string> lines = lines_of(*file, {.table = RunTable::Births});
    const std::size_t predators = 2 * colony().predator_count;
    std::size_t with_parents = 0, migrants = 0;
    for (const std::string& line : lines) {
        with_parents += line.find(",,,") == std::string::npos;
        migrants += line.find(",replaced,") != std::string::npos;
    }
    EXPECT_EQ(lines.size(), 1 + born + 24 + 1 + predators + migrants);
    EXPECT_GE(with_parents, born);
}

TEST_P(StoredColonyTest, LineageFindsTheParents) {
    {
        const auto run = begin();
        run->advance(720);
        run->recorder().close_all(run->laboratory());
    }
    const auto file = file_left();
    ASSERT_TRUE(file->pin_snapshot());
    std::size_t children = 0, counted = 0;
    const auto done = each_generation(*file, executor, {}, [&](std::uint64_t, const std::vector<Family>& families) {
        for (const Family& family : families) {
            for (std::size_t organism = 0; organism < family.origins.organism_count(); ++organism) {
                children += family.origins.origin(organism) == std::string{"child"};
                counted += family.child_count.empty() ? 0 : family.child_count[organism];
            }
        }
        return true;
    });
    ASSERT_TRUE(done) << to_text(done.error());
    EXPECT_GT(children, 20u);
    EXPECT_GT(counted, 20u);
    const auto lines = lines_of(*file, {.table = RunTable::Lineage, .of = OrganismName{5, 0, 2}});
    EXPECT_GE(lines.size(), 5u);
    EXPECT_THAT(lines.front(), HasSubstr(",species"));
    EXPECT_GT(lines_of(*file, {.table = RunTable::Organisms}).size(), 24u);
}

TEST_P(StoredColonyTest, GenerationsThatAreNotRetainedAreSimulated) {
    thread = std::make_unique<StorageThread>(RunFile::Options{.keep_every = 3});
    {
        const auto run = begin();
        run->advance(700);
        run->recorder().close_all(run->laboratory());
    }
    const auto file = file_left();
    expect_agrees(*file); // pins a snapshot
    EXPECT_EQ(file->database().number("SELECT count(*) FROM interval WHERE generation = 3"), 0);
    const auto lines = lines_of(*file, {.table = has_births() ? RunTable::Births : RunTable::Lineage});
    EXPECT_GT(lines.size(), 24u);
}

TEST_P(StoredColonyTest, BreedingIsThatOfThePrey) {
    {
        const auto run = begin();
        run->advance(700);
        run->recorder().close_all(run->laboratory());
    }
    const auto file = file_left();
    ASSERT_TRUE(file->pin_snapshot());
    for (const std::uint64_t generation : {1u, 2u, 4u}) {
        const auto bred =
            breeding_of(*file, {.generation = generation, .island = 1, .rows = {.count_max = 12}}, executor, {});
        ASSERT_EQ(bred.has_value(), !has_births()) << (bred ? "" : to_text(bred.error()));
        if (bred) {
            EXPECT_EQ(bred->record.contender_count, 12u);
        } else {
            EXPECT_THAT(to_text(bred.error()), HasSubstr("a world with births breeds no generations"));
        }
    }
}

TEST_P(StoredColonyTest, ImpossibleOpeningsAreRefused) {
    if (!has_births()) {
        return;
    }
    {
        const auto run = begin();
        run->advance(300);
    }
    auto file = file_left();
    const auto begun = file->generations().beginning_of(3);
    ASSERT_TRUE(begun && *begun);
    GenerationBegun changed = **begun;
    changed.openings[1].state.organisms[0].health = -1;
    const auto rerun = Rerun::from(*file, changed, nullptr, {}, {}, executor);
    ASSERT_FALSE(rerun);
    EXPECT_THAT(to_text(rerun.error()), HasSubstr("impossible"));
    changed = **begun;
    changed.openings[1].age_ticks[0] += 1;
    file->begin();
    file->write(changed);
    ASSERT_TRUE(file->commit());
    const auto verified = verify(*file, three_threads, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified) << to_text(verified.error());
    ASSERT_TRUE(verified->difference);
    EXPECT_THAT(verified->difference->part, HasSubstr("the age of organism 0 on island 1"));
}

INSTANTIATE_TEST_SUITE_P(All, StoredColonyTest,
                         testing::Values(Kind::Births, Kind::BirthsAndPredators, Kind::Predators),
                         testing::PrintToStringParamName());

} // namespace
} // namespace evod::replay
