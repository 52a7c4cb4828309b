// Stored runs: a fixture for tests that record runs and read their files.
#pragma once

#include "server/replay/run_tables.h"
#include "server/replay/verify.h"
#include "server/jobs/thread_pool.h"
#include "tests/unit/recording/recorded_run.h"

#include <gtest/gtest.h>

#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace evod::replay {

class StoredRuns : public testing::Test {
  protected:
    StoredRuns() : data{*run_file::DataFolder::open(folder.path())} {}

    /// Empties the folder for another run.
    void begin_again() {
        thread.reset();
        folder.clear();
        thread = std::make_unique<recording::StorageThread>(run_file::RunFile::Options{});
    }
    /// The file as a failure of the machine would leave it now: all records; no end mark, unless the run was closed.
    std::unique_ptr<run_file::RunFile> file_left(const std::string& name = "w") {
        thread.reset();
        auto file = run_file::RunFile::open(data.file_of(name), {});
        EXPECT_TRUE(file) << to_text(file.error());
        return *std::move(file);
    }
    void expect_agrees(run_file::RunFile& file) {
        const auto verified = verify(file, three_threads, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference)
            << verified->difference->part << ": " << verified->difference->stored << " but "
            << verified->difference->simulated << " at tick " << verified->difference->differs.tick;
    }
    /// The lines of a table, with its heading.
    std::vector<std::string> lines_of(run_file::RunFile& file, const WantedTable& wanted) {
        std::ostringstream text;
        const auto written = write_table({file, executor}, wanted, text);
        EXPECT_TRUE(written) << to_text(written.error());
        std::istringstream rows{text.str()};
        std::vector<std::string> lines;
        for (std::string line; std::getline(rows, line);) {
            lines.push_back(line);
        }
        return lines;
    }

    recording::TemporaryFolder folder;
    run_file::DataFolder data;
    std::unique_ptr<recording::StorageThread> thread =
        std::make_unique<recording::StorageThread>(run_file::RunFile::Options{});
    base::InlineExecutor executor;
    jobs::ThreadPool three_threads{3};
};

} // namespace evod::replay
