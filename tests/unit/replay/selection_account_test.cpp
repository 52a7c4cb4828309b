// Selection accounts in run files: recovered, forked and replayed worlds have the accounts of the original.
#include "server/replay/columns.h"
#include "server/replay/mismatch.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/verify.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

using Accounts = std::vector<std::optional<evolution::SelectionAccount>>; // per island

Accounts accounts_of(const simulation::World& world) {
    Accounts accounts;
    for (const simulation::Island& island : world.islands()) {
        accounts.push_back(island.born().account);
    }
    return accounts;
}

Accounts accounts_of(const std::vector<simulation::GenerationStatistics>& statistics) {
    Accounts accounts;
    for (const simulation::GenerationStatistics& island : statistics) {
        accounts.push_back(island.account);
    }
    return accounts;
}

class SelectionAccountTest : public testing::Test {
  protected:
    /// Six generations and a half on two islands with migrants between them, a checkpoint at the end of the fifth and
    /// within the last.
    void record(std::uint64_t keep_every) {
        accounts.clear();
        StorageThread thread{{.keep_every = keep_every}};
        RecordedRun run{data, thread};
        for (int tick = 1; tick <= 780; ++tick) {
            run.advance(1);
            accounts.resize(run.world().moment().generation);
            accounts.back() = accounts_of(run.world());
            if (tick == 600 || tick == 700) {
                run.checkpoint();
            }
        }
        run.recorder().close_all(run.laboratory());
    }
    std::string path() const { return data.file_of("w"); }
    void expect_agrees(RunFile& file) {
        const auto verified = verify(file, executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference)
            << verified->difference->part << " at tick " << verified->difference->differs.tick << ": stored "
            << verified->difference->stored << ", simulated " << verified->difference->simulated;
    }

    TemporaryFolder folder;
    DataFolder data = *DataFolder::open(folder.path());
    base::InlineExecutor executor;
    std::vector<Accounts> accounts; // of each generation
};

TEST_F(SelectionAccountTest, TheyAddUpToTheChangeOfTheStatistics) {
    record(1);
    ASSERT_EQ(accounts.size(), 7u);
    const auto file = RunFile::open_read_only(path());
    auto before = *(*file)->generations().statistics_of(1);
    EXPECT_EQ(accounts_of(before), Accounts(2)) << "nothing came before";
    for (std::uint64_t generation = 2; generation <= 6; ++generation) {
        const auto statistics = *(*file)->generations().statistics_of(generation);
        EXPECT_EQ(accounts_of(statistics), accounts[generation - 1]);
        for (std::size_t island = 0; island < 2; ++island) {
            ASSERT_TRUE(statistics[island].account) << generation;
            bool has_migrants = false;
            for (unsigned gene = 0; gene < evolution::body_gene_count; ++gene) {
                const evolution::GeneAccount& account = (*statistics[island].account)[gene];
                const double change = statistics[island].genes[gene].mean - before[island].genes[gene].mean;
                EXPECT_NEAR(account.change, change, 1e-11);
                EXPECT_NEAR(account.selection + account.transmission + account.migration, change, 1e-11);
                has_migrants |= account.migration != 0;
            }
            EXPECT_EQ(has_migrants, generation % 2 == 1) << "after each second generation";
        }
        before = statistics;
    }
}

TEST_F(SelectionAccountTest, AccountsAreEqualAfterARestartAndInAReplay) {
    for (const std::uint64_t keep_every : {1u, 3u}) {
        record(keep_every);
        const auto file = RunFile::open_read_only(path());
        expect_agrees(**file);
        const auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(accounts_of(recovered->world), accounts.back());
        for (const simulation::GenerationRows& rows : recovered->world.history()) {
            EXPECT_EQ(accounts_of(rows), accounts[rows.front().generation - 1]);
        }
        for (std::uint64_t generation = 1; generation <= 7; ++generation) {
            const auto there = Rerun::at(**file, generation, executor);
            ASSERT_TRUE(there) << to_text(there.error());
            EXPECT_EQ(accounts_of(there->world()), accounts[generation - 1]) << generation;
        }
        folder.clear();
    }
}

TEST_F(SelectionAccountTest, ACheckpointAfterAGenerationHasItsAccounts) {
    record(1);
    const auto file = RunFile::open_read_only(path());
    const auto rerun = Rerun::before(**file, 600, executor);
    ASSERT_TRUE(rerun) << to_text(rerun.error());
    ASSERT_EQ(rerun->world().moment().tick, 600u) << "not at the checkpoint";
    ASSERT_TRUE(rerun->world().generation_over());
    EXPECT_EQ(accounts_of(rerun->world().history().back()), accounts[4]);
}

TEST_F(SelectionAccountTest, AForkHasTheAccountsOfItsOriginAndItsOwn) {
    auto thread = std::make_unique<StorageThread>(RunFile::Options{});
    RecordedRun run{data, *thread};
    run.advance(400);
    const Accounts present = accounts_of(run.world());
    run.fork({3, 4});
    run.recorder().close_all(run.laboratory());
    thread.reset(); // writes everything
    const auto file = RunFile::open_read_only(data.file_of("fork"));
    ASSERT_TRUE(file) << to_text(file.error());
    expect_agrees(**file);
    const auto fork = recover(**file, executor);
    ASSERT_TRUE(fork) << to_text(fork.error());
    EXPECT_EQ(accounts_of(fork->world), present);
    ASSERT_EQ(fork->world.history().size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(accounts_of(fork->world.history()[i]), accounts_of(run.world().history()[i]));
    }
    EXPECT_TRUE(fork->world.history()[1][0].account);
}

TEST_F(SelectionAccountTest, MissingOrChangedAccountsAreNamed) {
    record(1);
    const auto complaint = [&] {
        const auto file = RunFile::open_read_only(path());
        const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
        return verified ? std::string{} : to_text(verified.error());
    };
    EXPECT_EQ(complaint(), "");
    change(path(), "UPDATE selection_account SET impulse_selection = 1 WHERE generation = 3 AND island = 0");
    EXPECT_THAT(complaint(), HasSubstr("the selection accounts of generation 3"));
    change(path(), "DELETE FROM selection_account WHERE generation = 3");
    EXPECT_THAT(complaint(), HasSubstr("the selection accounts of generation 3"));
}

TEST_F(SelectionAccountTest, AChangedAccountIsReportedButItsLastDigits) {
    record(1);
    const auto file = RunFile::open_read_only(path());
    auto begun = *(*file)->generations().beginning_of(5);
    const auto simulated = begun->born;
    EXPECT_FALSE(compare(begun->born, simulated));
    (*begun->born[1].account)[2].transmission += 1e-12;
    EXPECT_FALSE(compare(begun->born, simulated)) << "the last digits, as an earlier build may have stored them";
    (*begun->born[1].account)[2].transmission += 1e-6;
    const std::vector<std::string> names = gene_names_of((*file)->identity().parameters);
    const auto found = compare(begun->born, simulated, names);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->part, "the selection account: body_size_transmission on island 1");
    begun->born[1].account.reset();
    EXPECT_FALSE(compare(begun->born, simulated)) << "not known";

    const auto ended = *(*file)->generations().statistics_of(5);
    auto other = ended;
    (*other[0].account)[0].change *= 1 + 1e-6;
    const auto in_statistics = compare(other, ended, names);
    ASSERT_TRUE(in_statistics);
    EXPECT_EQ(in_statistics->part, "the statistics: normal_speed_change on island 0");
    other[0].account.reset();
    EXPECT_TRUE(compare(ended, other)) << "what is stored must be simulated";
}

} // namespace
} // namespace evod::replay
