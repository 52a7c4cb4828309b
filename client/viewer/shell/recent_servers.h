// RecentServers: the addresses that evoview was connected with, the last one first, kept in a file of the user's own:
// $XDG_STATE_HOME/evod/recent_servers, or ~/.local/state/evod/recent_servers.
//
// The file holds an address a line and nothing else: never a token. It is written whole, readable by its owner alone,
// and takes the place of the one before in one step. A file that says anything else is left alone, and told of.
//
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

    /// Reads the file; one that is not there is empty.
    explicit RecentServers(std::filesystem::path file);

    /// Where it is kept; nullopt if neither variable says.
    static std::optional<std::filesystem::path> default_file();

    const std::vector<std::string>& addresses() const { return addresses_; }

    /// Puts it in front, and writes the file.
    void add(const core::Endpoint& server);

    /// What a person has to know of the file; empty if all is well.
    const std::string& problem() const { return problem_; }

  private:
    void read();
    void write();

    std::filesystem::path file_; // empty: they are not kept
    std::vector<std::string> addresses_;
    std::string problem_;
};

} // namespace evod::viewer
