// History: random worlds, commands, stops, kills and restarts, and the comparison with worlds that were never stopped.
#pragma once

#include "evod/v1/commands.pb.h"
#include "tests/histories/comparison.h"
#include "tests/histories/draws.h"
#include "tests/histories/random_commands.h"
#include "tests/histories/server.h"
#include "tests/histories/twins.h"
#include "tests/support/temporary_folder.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::histories {

class History {
  public:
    explicit History(std::uint64_t seed);

    /// Performs the actions of the history. Returns them and the first difference as text; nullopt if there is no
    /// difference.
    std::optional<std::string> play();
    /// The actions so far, one per line.
    const std::string& actions() const { return actions_; }

  private:
    /// Opens a server, lets it perform actions, and stops it.
    void live(base::Executor& executor, simulation::IslandsMaker* maker);
    void act();
    void apply(const std::vector<v1::Request>& requests);
    std::vector<SentCommand> commands_of(const std::vector<v1::Request>& requests);
    void send(const std::vector<SentCommand>& commands);
    /// Lets the server rest, and brings the twins to its moments.
    void settle();
    void compare_answers(const std::vector<SentCommand>& commands);
    void compare(Depth depth, base::Executor& executor);
    void look_back();
    void stop(base::Executor& executor);
    /// Leaves a copy of the data folder, as a kill of the server would.
    void kill();
    void fork_file(base::Executor& executor);
    /// Verifies all run files, and exports their tables.
    void read_files(base::Executor& executor);
    void verify(const std::filesystem::path& path, base::Executor& executor);
    void write_tables(const std::filesystem::path& path, base::Executor& executor);
    std::string folder() const { return folders_.path() + "/" + std::to_string(folder_); }
    const simulation::Entry& any_twin();
    void note(const std::string& action);
    void fail(const std::string& difference);

    Draws draws_;
    RandomCommands commands_;
    const run_file::RunFile::Options options_;
    const std::chrono::microseconds tick_takes_;
    support::TemporaryFolder folders_;
    std::uint32_t folder_ = 0; // number of the data folder: a kill leaves a new one
    std::uint32_t actions_left_;
    std::unique_ptr<Server> server_;
    Twins twins_;
    std::map<std::uint64_t, std::string> expected_; // the answers of the twins, by request id
    std::uint64_t runs_ = 0;
    std::string actions_;
    std::uint32_t lines_ = 0;
    std::optional<std::string> failure_;
};

} // namespace evod::histories
