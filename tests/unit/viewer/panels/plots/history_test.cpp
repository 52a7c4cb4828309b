#include "client/viewer/panels/plots/history.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

v1::GenerationStatistics statistics_of(std::uint64_t generation, std::uint32_t island = 0) {
    v1::GenerationStatistics statistics;
    statistics.set_generation(generation);
    statistics.set_island(island);
    statistics.set_organism_count(10);
    statistics.set_fitness_best(100.0 * static_cast<double>(generation) + island);
    statistics.add_genes()->set_mean(1.5);
    return statistics;
}

v1::Event finished(std::uint64_t generation, const std::string& run_id = "a", const std::string& world = "lab") {
    v1::Event event;
    event.set_world(world);
    event.set_run_id(run_id);
    *event.mutable_generation_finished()->add_statistics() = statistics_of(generation);
    return event;
}

v1::History page(std::uint64_t first, std::uint64_t last, std::optional<std::uint64_t> next = std::nullopt) {
    v1::History history;
    for (std::uint64_t generation = first; generation <= last; ++generation) {
        *history.add_generations() = statistics_of(generation);
    }
    if (next) {
        history.set_next_generation(*next);
    }
    return history;
}

struct HistoryTest : testing::Test {
    HistoryTest() { history.set_run("lab", "a"); }

    /// Returns the first generation of the next query.
    std::uint64_t ask() {
        const auto query = history.next_query();
        EXPECT_TRUE(query);
        if (!query) {
            return 0;
        }
        number = query->number;
        EXPECT_EQ(query->request.get_history().world(), "lab");
        EXPECT_FALSE(query->request.get_history().has_island());
        return query->request.get_history().first_generation();
    }
    void answer(const v1::History& page) { history.receive(number, &page); }
    std::vector<double> known() const {
        const auto column = history.table().column(std::nullopt, "generation");
        return {column.begin(), column.end()};
    }

    History history;
    std::uint64_t number = 0;
};

TEST_F(HistoryTest, RequestsEarlierGenerationsPageByPage) {
    EXPECT_EQ(ask(), 1u);
    EXPECT_EQ(history.next_query(), std::nullopt) << "one at a time";
    answer(page(1, 3, 4));
    EXPECT_FALSE(history.complete());
    EXPECT_EQ(ask(), 4u);
    answer(page(4, 5));
    EXPECT_TRUE(history.complete());
    EXPECT_EQ(history.next_query(), std::nullopt);
    EXPECT_THAT(known(), ElementsAre(1, 2, 3, 4, 5));
    EXPECT_THAT(history.table().column(0, "fitness_best"), ElementsAre(100, 200, 300, 400, 500));
}

TEST_F(HistoryTest, EventsContinueAfterThePages) {
    ask();
    history.apply_event(finished(4)); // while the first page is pending
    answer(page(1, 3));
    history.apply_event(finished(5));
    history.apply_event(finished(5));
    EXPECT_TRUE(history.complete());
    EXPECT_THAT(known(), ElementsAre(1, 2, 3, 4, 5));
}

TEST_F(HistoryTest, RequestsAGap) {
    ask();
    answer(page(1, 3));
    history.apply_event(finished(6));
    EXPECT_EQ(ask(), 4u);
    history.apply_event(finished(7));
    answer(page(4, 6));
    EXPECT_TRUE(history.complete());
    EXPECT_THAT(known(), ElementsAre(1, 2, 3, 4, 5, 6, 7));
}

TEST_F(HistoryTest, AnEventBeyondAGapLeavesNoHole) {
    ask();
    answer(page(1, 3));
    history.apply_event(finished(5));
    EXPECT_EQ(ask(), 4u);
    history.apply_event(finished(8)); // 6 and 7 are missing
    answer(page(4, 6));
    EXPECT_FALSE(history.complete());
    EXPECT_EQ(ask(), 7u);
    answer(page(7, 8));
    EXPECT_THAT(known(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_TRUE(history.complete());
}

TEST_F(HistoryTest, DoesNotRequestWhatTheServerDropped) {
    ask();
    answer(page(1, 3));
    history.apply_event(finished(20'000));
    EXPECT_EQ(ask(), 4u);
    answer(page(10'001, 20'000 - 9'990));
    EXPECT_TRUE(history.complete());
    history.apply_event(finished(20'001));
    EXPECT_TRUE(history.complete());
}

TEST_F(HistoryTest, DroppedEventsAndSnapshotsRevealAGap) {
    ask();
    answer(page(1, 3));
    v1::Event dropped;
    dropped.mutable_events_dropped()->set_dropped_count(2);
    history.apply_event(dropped);
    EXPECT_EQ(ask(), 4u);
    history.refresh(); // again, while the query is pending
    answer(page(4, 5));
    EXPECT_EQ(ask(), 6u);
    answer({});
    EXPECT_TRUE(history.complete());
    history.set_ended(5);
    EXPECT_TRUE(history.complete());
    history.set_ended(6);
    EXPECT_EQ(ask(), 6u);
    answer({});
    EXPECT_TRUE(history.complete()) << "the server no longer has it";
}

TEST_F(HistoryTest, AResetClearsItAndOldAnswersAreIgnored) {
    ask();
    answer(page(1, 3, 4));
    ask();
    const std::uint64_t revision = history.revision();
    v1::Event reset;
    reset.set_world("lab");
    reset.set_run_id("b");
    reset.mutable_world_reset()->mutable_world()->set_name("lab");
    reset.mutable_world_reset()->mutable_world()->set_run_id("b");
    history.apply_event(reset);
    EXPECT_NE(history.revision(), revision);
    EXPECT_TRUE(history.table().empty());
    answer(page(4, 9)); // of the previous run
    history.apply_event(finished(10, "a"));
    EXPECT_TRUE(history.table().empty());
    EXPECT_EQ(ask(), 1u);
    answer(page(1, 1));
    EXPECT_THAT(known(), ElementsAre(1));
    history.set_run("lab", "b");
    EXPECT_THAT(known(), ElementsAre(1)) << "the same as before";
}

TEST_F(HistoryTest, IgnoresEventsOfOtherWorlds) {
    ask();
    answer(page(1, 1));
    history.apply_event(finished(2, "a", "other"));
    EXPECT_THAT(known(), ElementsAre(1));
}

TEST_F(HistoryTest, SendsAFailedQueryAgain) {
    ask();
    answer(page(1, 3, 4));
    ask();
    history.receive(number, nullptr);
    EXPECT_FALSE(history.complete());
    EXPECT_EQ(ask(), 1u);
}

v1::History with_change(v1::History page, std::uint64_t generation, double after) {
    v1::AppliedChange& change = *page.add_changes();
    change.set_generation(generation);
    change.mutable_by()->set_user("alice");
    change.add_values()->set_name("mutation_chance");
    change.mutable_values(0)->mutable_before()->set_real(0.1);
    change.mutable_values(0)->mutable_after()->set_real(after);
    return page;
}

TEST_F(HistoryTest, RequestsChangesWhenAnEventReportsOne) {
    ask();
    answer(with_change(with_change(page(1, 3), 2, 0.2), 4, 0.3)); // generation 4 is not over
    ASSERT_EQ(history.changes().size(), 2u);
    EXPECT_EQ(history.changes()[0].x, 2);
    EXPECT_EQ(history.changes()[0].text, "generation 2: mutation_chance 0.1 → 0.2 by alice");

    history.apply_event(finished(4));
    history.apply_event(finished(5));
    EXPECT_EQ(history.next_query(), std::nullopt);
    v1::Event changed;
    changed.set_world("other");
    changed.mutable_parameters_changed();
    history.apply_event(changed);
    EXPECT_EQ(history.next_query(), std::nullopt) << "another world";
    changed.set_world("lab");
    history.apply_event(changed);
    EXPECT_EQ(ask(), 4u) << "the first generation that may have changes not known yet";
    answer(with_change(with_change(page(4, 5), 4, 0.3), 5, 0.4));
    EXPECT_EQ(history.changes().size(), 3u) << "each once";
    EXPECT_TRUE(history.complete());
    history.set_run("lab", "b");
    EXPECT_TRUE(history.changes().empty());
}

TEST(HistoryTable, JoinsIslands) {
    v1::GenerationStatistics first = statistics_of(1, 0), second = statistics_of(1, 1);
    first.set_fitness_mean(10);
    first.set_fitness_deviation(3);
    first.set_fitness_worst(-5);
    first.set_starved_count(2);
    second.set_organism_count(30);
    second.set_fitness_mean(20);
    second.set_fitness_deviation(4);
    second.set_starved_count(5);
    second.mutable_genes(0)->set_mean(3.5);
    HistoryTable table;
    table.set_gene_names({"impulse"});
    table.add(std::vector<std::vector<double>>{core::history_numbers(first), core::history_numbers(second)});
    const auto all = [&](const char* name) { return table.column(std::nullopt, name)[0]; };
    EXPECT_EQ(table.island_count(), 2u);
    EXPECT_EQ(all("organism_count"), 40);
    EXPECT_EQ(all("fitness_best"), 101);
    EXPECT_EQ(all("fitness_worst"), -5);
    EXPECT_EQ(all("fitness_mean"), 17.5);
    // The mean square minus the square of the mean, of 10 and 30 organisms.
    EXPECT_NEAR(all("fitness_deviation"), std::sqrt((10 * (9 + 100) + 30 * (16 + 400)) / 40.0 - 17.5 * 17.5), 1e-12);
    EXPECT_TRUE(std::isnan(all("fitness_median")));
    EXPECT_EQ(all("starved_count"), 7);
    EXPECT_EQ(all("impulse_mean"), 3);
    EXPECT_EQ(all("impulse_deviation"), std::sqrt(0.75));
    EXPECT_TRUE(table.column(2, "fitness_best").empty());
    EXPECT_TRUE(table.column(0, "beauty").empty());
}

TEST(HistoryTable, OneIslandEqualsAllIslands) {
    HistoryTable table;
    const auto numbers = core::history_numbers(statistics_of(7));
    table.add(std::vector<std::vector<double>>{numbers});
    EXPECT_THAT(table.column(std::nullopt, "fitness_median"), ElementsAre(0));
    EXPECT_THAT(table.column(std::nullopt, "gene_0_mean"), ElementsAre(1.5)) << "until its name is known";
    table.set_gene_names({"impulse"});
    EXPECT_THAT(table.column(0, "impulse_mean"), ElementsAre(1.5));
}

TEST(HistoryTable, IsReadBackFromAFile) {
    HistoryTable table;
    table.set_gene_names({"impulse"});
    for (const std::uint64_t generation : {2, 1, 5}) {
        table.add(std::vector<std::vector<double>>{core::history_numbers(statistics_of(generation, 0)),
                                                   core::history_numbers(statistics_of(generation, 1))});
    }
    const std::string path =
        (std::filesystem::temp_directory_path() / ("history_test-" + std::to_string(getpid()) + ".csv")).string();
    std::ofstream{path} << table.to_csv();
    const auto loaded = load_history(path);
    ASSERT_TRUE(loaded) << loaded.error().what;
    EXPECT_EQ(loaded->to_csv(), table.to_csv());
    EXPECT_THAT(loaded->column(1, "fitness_best"), ElementsAre(101, 201, 501));
    std::ofstream{path} << "a,b\n";
    EXPECT_THAT(load_history(path).error().what, HasSubstr(path + ": line 1"));
    std::filesystem::remove(path);
    EXPECT_EQ(load_history(path).error().what, path + ": cannot be read: No such file or directory");
}

} // namespace
} // namespace evod::viewer
