// RecentServers: stores the addresses of the servers to which evoview was connected, newest first, in the file
// $XDG_STATE_HOME/evod/recent_servers or ~/.local/state/evod/recent_servers.
//
// The file contains one address per line and never a token. Each write replaces the file atomically. Only its owner may
// read it. If the file has any other content, RecentServers does not overwrite it, and problem() reports it.
//
// Owner        StartScreen.
// Threads      none.
#pragma once

#include "client/core/connection.h"

#include <filesystem>
#include <string>
#include <vector>

namespace evod::viewer {

class RecentServers {
  public:
    static constexpr std::size_t kept_max = 10;

    /// Reads the file. A missing file counts as empty.
    explicit RecentServers(std::filesystem::path file);

    const std::vector<std::string>& addresses() const { return addresses_; }

    /// Moves the server to the front of the list, or adds it there, and writes the file.
    void add(const core::Endpoint& server);

    /// What is wrong with the file, as a sentence; empty if nothing is wrong.
    const std::string& problem() const { return problem_; }

  private:
    void read();
    void write();

    std::filesystem::path file_; // empty: addresses are not stored
    std::vector<std::string> addresses_;
    std::string problem_;
};

} // namespace evod::viewer
