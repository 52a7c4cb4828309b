// Runs in which commands placed and removed entities: recovery, verification, forks and tables.
#include "server/simulation/entities.h"

#include "server/replay/breeding.h"
#include "server/replay/recovery.h"
#include "server/replay/run_file_fork.h"
#include "tests/unit/replay/stored_run_fixture.h"

#include <gmock/gmock.h>

#include <random>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

/// Places food, poison and, if there is room, an organism; removes an organism if `remove` is true.
void change_entities(RecordedRun& run, std::mt19937& random, bool remove) {
    const simulation::World& world = run.world();
    const auto index = static_cast<std::uint32_t>(random() % 2);
    const simulation::Island& island = world.islands()[index];
    v1::Request request;
    v1::Place& place = *request.mutable_place();
    place.set_world("w");
    place.set_island(index);
    for (int i = 0; i < 3; ++i) {
        v1::PlacedItem& item = *place.add_items();
        item.set_kind(i == 0 ? v1::ITEM_KIND_POISON : v1::ITEM_KIND_FOOD);
        item.set_x_px(static_cast<double>(50 + random() % 300));
        item.set_y_px(static_cast<double>(50 + random() % 300));
    }
    simulation::PlaceEntities organism{.world = "w", .island = index};
    organism.organisms.push_back({0, 0, std::vector<float>(evolution::body_gene_count, 110)});
    for (int attempt = 0; attempt < 100; ++attempt) {
        auto& [x_px, y_px, genes] = organism.organisms[0];
        x_px = static_cast<double>(50 + random() % 500);
        y_px = static_cast<double>(50 + random() % 300);
        if (check(world, organism)) {
            v1::PlacedOrganism& placed = *place.add_organisms();
            placed.set_x_px(x_px);
            placed.set_y_px(y_px);
            placed.mutable_genes()->Add(genes.data(), genes.data() + genes.size());
            break;
        }
    }
    run.command(request);
    for (std::uint32_t id = 0; remove && id < island.life_records().cause.size(); ++id) {
        if (island.body_of(id)) {
            v1::Request removal;
            removal.mutable_remove()->set_world("w");
            removal.mutable_remove()->set_island(index);
            removal.mutable_remove()->add_organisms(id);
            run.command(removal);
            break;
        }
    }
}

class StoredEntitiesTest : public StoredRuns {
  protected:
    /// The lines of a table that contain `part`.
    std::vector<std::string> rows_with(RunFile& file, const WantedTable& wanted, const std::string& part) {
        std::vector<std::string> lines = lines_of(file, wanted);
        std::erase_if(lines, [&](const std::string& line) { return line.find(part) == std::string::npos; });
        return lines;
    }
};

TEST_F(StoredEntitiesTest, AKilledRunContinuesWithThem) {
    // Ticks of commands: before the first tick, at a stored state hash, after a checkpoint, in later generations.
    for (const bool with_checkpoint : {false, true}) {
        for (const std::uint64_t last : {0u, 60u, 90u, 119u, 130u, 300u}) {
            begin_again();
            RecordedRun run{data, *thread};
            std::mt19937 random{static_cast<std::uint32_t>(last + 1)};
            for (const std::uint64_t tick : {0u, 60u, 90u, 119u, 130u, 300u}) {
                if (tick > last) {
                    break;
                }
                run.advance(tick - run.world().moment().tick);
                if (with_checkpoint && tick == 90) {
                    run.checkpoint();
                }
                change_entities(run, random, tick == 60);
                change_entities(run, random, false);
            }
            const auto file = file_left();
            auto recovered = recover(*file, three_threads);
            ASSERT_TRUE(recovered) << to_text(recovered.error());
            EXPECT_EQ(recovered->world.hash(), run.world().hash()) << "after tick " << last;
            for (int tick = 0; tick < 200; ++tick) {
                recovered->world.advance_tick(three_threads);
                run.world().advance_tick(executor);
                ASSERT_EQ(recovered->world.hash(), run.world().hash()) << tick;
            }
            expect_agrees(*file);
        }
    }
}

TEST_F(StoredEntitiesTest, AForkContinuesWithThem) {
    for (const std::uint64_t at : {0u, 60u, 100u}) {
        begin_again();
        std::mt19937 random{11};
        base::StateHash hash;
        {
            RecordedRun run{data, *thread};
            run.advance(at);
            change_entities(run, random, at == 60);
            run.fork({3, 4});
            run.advance(130, "fork");
            run.recorder().close_all(run.laboratory());
            hash = (*run.laboratory().find("fork"))->world.hash();
        }
        const auto file = file_left("fork");
        const auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash);
        expect_agrees(*file);
        const auto placed = rows_with(*file, {.table = RunTable::Organisms}, "placed");
        EXPECT_EQ(placed.size(), 1u) << at;
        // A fork of the file, at its present tick.
        const auto moment = replay::fork(*file, {}, data.file_of("again"), "again", {5, 6}, executor);
        ASSERT_TRUE(moment) << to_text(moment.error());
        expect_agrees(*file_left("again"));
    }
}

TEST_F(StoredEntitiesTest, TablesContainPlacedOrganisms) {
    RecordedRun run{data, *thread};
    run.advance(10);
    std::mt19937 random{4};
    change_entities(run, random, true);
    run.advance(400);
    const auto file = file_left();
    const auto organisms = rows_with(*file, {.table = RunTable::Organisms}, ",placed,");
    ASSERT_EQ(organisms.size(), 1u);
    EXPECT_THAT(organisms[0], HasSubstr(",12,,,placed,110,110,110,110,110,110,")); // the first id after the twelve
    EXPECT_EQ(rows_with(*file, {.table = RunTable::Organisms}, ",removed").size(), 1u);
    EXPECT_EQ(rows_with(*file, {.table = RunTable::Lineage}, ",placed,").size(), 1u);
    EXPECT_EQ(rows_with(*file, {.table = RunTable::Events}, "placed").size(), 0u);
    EXPECT_EQ(rows_with(*file, {.table = RunTable::Events}, ",place,").size(), 1u);
    // The population at the beginning of the generation: 2 islands of 12 organisms and a heading.
    EXPECT_EQ(rows_with(*file, {.table = RunTable::Population, .generation = 1}, ",").size(), 25u);
    for (const std::uint32_t island : {0u, 1u}) {
        const auto bred = breeding_of(*file, {.generation = 1, .island = island, .rows = {}}, executor, {});
        EXPECT_TRUE(bred) << to_text(bred.error());
    }
}

} // namespace
} // namespace evod::replay
