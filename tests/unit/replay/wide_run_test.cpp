// Runs whose chromosomes have more than six genes: recovery, replay, verification, forks, tables, migration.
#include "server/replay/breeding.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "tests/unit/replay/stored_run_fixture.h"

#include <gmock/gmock.h>

#include <charconv>
#include <map>
#include <random>
#include <sstream>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

enum class Wide { FreeGenes, Network };
void PrintTo(Wide wide, std::ostream* out) {
    *out << (wide == Wide::FreeGenes ? "free genes" : "network");
}

/// small_world() with 16 genes, of which 10 are free, or with 328 genes, of which 322 are weights of a network.
parameters::Parameters wide_world(Wide wide) {
    parameters::Parameters parameters = small_world();
    if (wide == Wide::FreeGenes) {
        parameters.free_genes = 10;
    } else {
        parameters.controller = evolution::Controller::Network;
        parameters.sense_speed = parameters.sense_health = parameters.sense_wall = true;
        parameters.brain_hidden = 32;
    }
    return parameters;
}

/// The shortest text that reads back as the same number.
std::string text_of(auto number) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

class WideRunTest : public StoredRuns, public testing::WithParamInterface<Wide> {
  protected:
    std::unique_ptr<RecordedRun> begin() {
        return std::make_unique<RecordedRun>(data, *thread, base::Seed{7}, simulation::FirstPopulation{},
                                             parameters::Schedule{}, wide_world(GetParam()));
    }
    /// A command whose effect depends on the groups of genes.
    v1::Request mutate_beyond_body() const {
        return set_parameter("mutate_group", std::string{GetParam() == Wide::FreeGenes ? "free" : "brain"});
    }
    unsigned genes() const { return GetParam() == Wide::FreeGenes ? 16 : 328; }
};

TEST_P(WideRunTest, AKilledRunContinuesExactly) {
    std::mt19937 random{1};
    for (int round = 0; round < 12; ++round) {
        begin_again();
        const auto run = begin();
        run->advance(random() % 200);
        run->command(mutate_beyond_body());
        if (round % 2 == 1) {
            run->checkpoint();
        }
        run->advance(random() % 300);
        run->command(set_parameter("crossover", std::string{"blend"}));

        const auto file = file_left();
        auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        simulation::World& again = recovered->world;
        ASSERT_EQ(again.hash(), run->world().hash());
        ASSERT_EQ(again.history().size(), run->world().history().size());
        for (std::size_t i = 0; i < again.history().size(); ++i) {
            const simulation::GenerationStatistics &one = again.history()[i][1], &other = run->world().history()[i][1];
            ASSERT_EQ(one.genes.size(), genes());
            EXPECT_EQ(one.genes.back().mean, other.genes.back().mean);
            EXPECT_EQ(one.genes.back().max, other.genes.back().max);
            EXPECT_EQ(one.account, other.account);
        }
        for (int tick = 0; tick < 250; ++tick) {
            again.advance_tick(three_threads);
            run->world().advance_tick(executor);
            ASSERT_EQ(again.hash(), run->world().hash()) << tick;
        }
        expect_agrees(*file);
    }
}

TEST_P(WideRunTest, AReplayReachesEveryMoment) {
    std::map<std::uint64_t, base::StateHash> hashes;
    {
        const auto run = begin();
        for (std::uint64_t tick = 1; tick <= 400; ++tick) {
            run->advance(1);
            hashes[tick] = run->world().hash();
            if (tick == 150) {
                run->command(mutate_beyond_body());
            }
            if (tick == 200) {
                run->checkpoint();
            }
        }
        run->recorder().close_all(run->laboratory());
    }
    const auto file = file_left();
    for (std::uint64_t tick = 1; tick < 400; tick += 7) {
        auto rerun = Rerun::before(*file, tick, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        rerun->advance_to(tick, three_threads);
        ASSERT_EQ(rerun->world().moment().tick, tick);
        EXPECT_EQ(rerun->hash_of_tick(), hashes[tick]) << tick;
    }
    for (std::uint64_t generation = 1; generation <= 4; ++generation) {
        auto rerun = Rerun::at(*file, generation, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        rerun->advance_tick(executor);
        EXPECT_EQ(rerun->hash_of_tick(), hashes[rerun->world().moment().tick]) << generation;
    }
}

TEST_P(WideRunTest, AForkContinuesExactly) {
    base::StateHash hash;
    {
        const auto run = begin();
        run->advance(290);
        run->command(mutate_beyond_body());
        run->fork({3, 4});
        run->advance(130, "fork");
        run->recorder().close_all(run->laboratory());
        hash = (*run->laboratory().find("fork"))->world.hash();
    }
    const auto file = file_left("fork");
    const auto recovered = recover(*file, three_threads);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_EQ(recovered->world.hash(), hash);
    EXPECT_EQ(recovered->world.history().size(), 3u) << "two generations are the origin's";
    EXPECT_EQ(recovered->world.history()[0][0].genes.size(), genes());
    expect_agrees(*file);
    const auto moment = replay::fork(*file, {}, data.file_of("again"), "again", {5, 6}, executor);
    ASSERT_TRUE(moment) << to_text(moment.error());
    expect_agrees(*file_left("again"));
}

TEST_P(WideRunTest, StatisticsOfFewerGenesAreReported) {
    const auto run = begin();
    run->advance(300);
    const auto file = file_left();
    GenerationEnded ended = **file->generations().outcome_of(1);
    ended.statistics[1].genes.pop_back();
    file->begin();
    file->write(ended);
    ASSERT_TRUE(file->commit());
    std::ostringstream text;
    const auto written = write_table({*file, executor}, {.table = RunTable::Generations}, text);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, HasSubstr("is damaged: a row of the further genes of generation 1"));
    EXPECT_FALSE(Rerun::at(*file, 2, executor)) << "its world has these statistics";
}

TEST_P(WideRunTest, AResetChangesTheNumberOfGenes) {
    {
        RecordedRun run{data, *thread};
        run.advance(130);
        for (const parameters::ParameterDescription* description :
             parameters::parameters_that_differ(small_world(), wide_world(GetParam()))) {
            run.command(set_parameter(std::string{description->name}, description->get(wide_world(GetParam()))));
        }
        run.advance(130);
        EXPECT_EQ(run.world().islands()[0].born().genes.rows(), 6);
        run.reset({8}, {3, 4});
        run.advance(250);
        EXPECT_EQ(run.world().islands()[0].born().genes.rows(), genes());
    }
    const auto file = file_left();
    expect_agrees(*file);
    EXPECT_EQ(recover(*file, executor)->world.history()[0][0].genes.size(), genes());
}

TEST_P(WideRunTest, TablesContainEveryGene) {
    const auto run = begin();
    run->advance(130);
    const evolution::GeneMatrix population = run->world().islands()[1].born().genes;
    run->advance(130);
    const auto statistics = run->world().history()[1][1];
    const std::vector<std::string> names = evolution::gene_layout(wide_world(GetParam())).names;
    const auto file = file_left();

    std::string row = "1,0", heading = "island,organism";
    for (unsigned gene = 0; gene < genes(); ++gene) {
        heading += "," + names[gene];
        row += "," + text_of(population(gene, 0));
    }
    const auto table = lines_of(*file, {.table = RunTable::Population, .generation = 2});
    ASSERT_EQ(table.size(), 25u);
    EXPECT_EQ(table[0], heading);
    EXPECT_EQ(table[13], row);

    const auto organisms = lines_of(*file, {.table = RunTable::Organisms});
    EXPECT_THAT(organisms[0], HasSubstr("," + names.back() + ","));
    const auto generations = lines_of(*file, {.table = RunTable::Generations});
    ASSERT_EQ(generations.size(), 5u); // two islands in two generations
    EXPECT_THAT(generations[0], HasSubstr(names.back() + "_mean"));
    EXPECT_THAT(generations[4], HasSubstr("," + text_of(statistics.genes.back().mean) + ","));
}

TEST_P(WideRunTest, MigrantsBringTheirWholeChromosomes) {
    // The migration after generation 2 copies the best of each island; nothing else changes genes here.
    const auto run = begin();
    run->command(set_parameter("crossover", std::string{"none"}));
    run->command(set_parameter("mutation_chance", 0.0));
    run->command(set_parameter("elite_count", 11u)); // migrants replace no elite
    run->advance(239);
    const evolution::GeneMatrix from = run->world().islands()[0].born().genes,
                                to = run->world().islands()[1].born().genes;
    run->advance(2);
    ASSERT_EQ(run->world().moment().generation, 3u);
    const evolution::GeneMatrix now = run->world().islands()[1].born().genes;
    const auto contains = [&](const evolution::GeneMatrix& population, Eigen::Index organism) {
        return (population.colwise() - now.col(organism)).abs().colwise().sum().minCoeff() == 0;
    };
    int migrants = 0;
    for (Eigen::Index i = 0; i < now.cols(); ++i) {
        migrants += contains(from, i);
        EXPECT_NE(contains(from, i), contains(to, i)) << i;
    }
    EXPECT_GE(migrants, 1);
    run->advance(120);
    for (unsigned gene = 0; gene < genes(); ++gene) {
        EXPECT_NE(run->world().history()[2][1].account->at(gene).migration, 0) << gene;
    }
}

TEST_P(WideRunTest, BreedingsAreRecomputedForEveryGene) {
    const auto run = begin();
    run->advance(370);
    const auto file = file_left();
    for (std::uint64_t generation = 1; generation <= 3; ++generation) {
        const auto bred = breeding_of(*file, {.generation = generation, .island = 1, .rows = {}}, executor, {});
        ASSERT_TRUE(bred) << to_text(bred.error());
    }
}

TEST_P(WideRunTest, DamageOfFurtherGenesIsReported) {
    const auto damaged_by = [&](const std::string& sql) {
        begin_again();
        {
            const auto run = begin();
            run->advance(250);
        }
        thread.reset();
        change(data.file_of("w"), sql);
        const auto file = RunFile::open(data.file_of("w"), {});
        if (!file) {
            return to_text(file.error());
        }
        const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
        return verified ? std::string{"accepted"} : to_text(verified.error());
    };
    EXPECT_THAT(damaged_by("UPDATE more_genes SET statistics = zeroblob(8)"),
                HasSubstr("further genes of generation 1"));
    EXPECT_THAT(damaged_by("DELETE FROM more_genes WHERE generation = 2"), HasSubstr("further genes of generation 2"));
    EXPECT_THAT(damaged_by("DROP TABLE more_genes"), HasSubstr("lacks the table \"more_genes\""));
}

INSTANTIATE_TEST_SUITE_P(Genes, WideRunTest, testing::Values(Wide::FreeGenes, Wide::Network));

} // namespace
} // namespace evod::replay
