// World builds: construct the worlds of CreateWorld, ResetWorld and ForkWorld. Another thread constructs the large
// ones, while the simulation thread advances the other worlds.
//
//   begin → construct, and read the original → finish → adopt, between two ticks
//
// Owner        the simulation loop, on the simulation thread.
// Threads      one build thread, which serves users in turn. It returns the worlds through the mailbox. While it reads
//              a world, that world neither advances nor changes, because the loop asks holds().
// Order        the loop keeps a command to a world that holds() names until that world is free. So a client sees the
//              same results as if the world had been constructed at once.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/runtime/mailbox.h"
#include "server/simulation/laboratory.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace evod::runtime {

class WorldBuilds {
  public:
    /// The simulation thread constructs worlds with at most this number of genes: it takes less than a millisecond.
    static constexpr std::uint64_t genes_built_at_once_max = 10'000;

    struct Order {
        std::string user = {};                 // whose turn of the build thread it takes
        std::string name = {};                 // of the world that will be adopted
        std::string original = {};             // the world that `construct` reads; empty if it reads none
        bool at_once = false;                  // on the simulation thread, also if the world is large
        simulation::Construction construction; // `construct` may throw std::bad_alloc
        /// Completes the world. It must not read any other world; may throw std::bad_alloc.
        std::function<BuiltWorld(simulation::World, base::Executor&)> finish = {};
        /// Adds the world to the laboratory, or reports why there is none.
        std::function<void(base::Result<BuiltWorld>)> adopt = {};
    };

    /// All arguments must outlive this object.
    WorldBuilds(Mailbox& mailbox, base::Executor& executor) : mailbox_{mailbox}, executor_{executor} {}

    /// Constructs a world. Calls `adopt` at once or, if the build thread constructs the world, in take().
    void begin(Order order);
    /// Whether a world is under construction or being read, so that it must neither advance nor receive commands. With
    /// an empty name: whether there is any such world, because the meaning of an empty name may change.
    bool holds(std::string_view world) const;
    /// Handles the mail of the build thread. Afterwards, holds() may be false for more worlds.
    void take(const WorldBuilt& mail);

  private:
    struct Build {
        std::string name, original;
        std::function<void(base::Result<BuiltWorld>)> adopt;
    };
    static base::Result<BuiltWorld> build(const Order& order, base::Executor& executor,
                                          const std::function<void()>& has_read);

    Mailbox& mailbox_;
    base::Executor& executor_;
    std::map<std::uint64_t, Build> builds_; // key: number of the build
    std::uint64_t last_number_ = 0;
    jobs::JobQueue jobs_{{.name = "world build"}}; // last member, because its jobs use the mailbox
};

} // namespace evod::runtime
