// First world: what a server does with its worlds at its start. It creates the first world, or compares it with the
// stored one, and gives a world the commands of the options --speed and --start.
//
// Owner        the server.
// Threads      the network thread, before any client is served.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/network/server_options.h"
#include "server/replay/archive.h"

#include <functional>
#include <optional>
#include <string>

namespace evod::network {

class FirstWorld {
  public:
    /// Decides what to do. Refused if the stored world of this name is another one than the user requested, or if it is
    /// ambiguous to which world the first commands apply.
    ///
    /// options  must outlive the object.
    /// archive  the stored worlds; nullptr: runs are not stored.
    static base::Result<FirstWorld> choose(const LiveWorlds& options, const replay::Archive* archive);

    /// The seed of the first world; nullopt if that world does not exist.
    std::optional<base::Seed> seed() const { return seed_; }

    /// Sends the commands that create and begin the world, in order. Logs to which worlds --speed and --start do not
    /// apply.
    void begin(const std::function<void(v1::Request)>& send) const;

  private:
    FirstWorld(const LiveWorlds& options, const replay::Archive* archive);
    /// Compares the requested world with the stored world of its name.
    base::Result<void> compare_with_stored(const replay::Archive& archive) const;
    /// Finds the world to which the first commands apply.
    base::Result<void> find_begun(const replay::Archive& archive);
    v1::Request creation() const;

    const LiveWorlds* options_;
    bool is_created_;
    std::optional<base::Seed> seed_;
    std::string begun_; // name of the world to which the first commands apply
    bool begun_is_damaged_ = false;
    std::size_t other_count_ = 0; // stored worlds to which the first commands do not apply
};

} // namespace evod::network
