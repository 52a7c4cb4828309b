// RecentServers: the addresses of servers that evoview was connected to, the newest first, in the file
// $XDG_STATE_HOME/evod/recent_servers, or ~/.local/state/evod/recent_servers.
//
// The file contains one address per line and never a token. Each write replaces it atomically; only its owner may read
// it. A file with any other content is not overwritten, and problem() reports it.
//
// Owner        StartScreen.
// Threads      none.
#pragma once

#include "client/core/connection.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class RecentServers {
  public:
    static constexpr std::size_t kept_max = 10;

    /// Reads the file; a missing file is treated as empty.
    explicit RecentServers(std::filesystem::path file);

    /// The path of the file; nullopt if neither environment variable is set.
    static std::optional<std::filesystem::path> default_file();

    const std::vector<std::string>& addresses() const { return addresses_; }

    /// Moves or adds the server to the front, and writes the file.
    void add(const core::Endpoint& server);

    /// What is wrong with the file, as a sentence; empty if nothing is.
    const std::string& problem() const { return problem_; }

  private:
    void read();
    void write();

    std::filesystem::path file_; // empty: addresses are not saved
    std::vector<std::string> addresses_;
    std::string problem_;
};

} // namespace evod::viewer
