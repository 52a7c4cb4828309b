// Pace: advances the worlds of a simulation loop, each when it is its turn, and takes their snapshots.
//
//   paced worlds that are due → a slice for the user with the least time
//
// Turns        paced worlds come first (world_pace.h), unless their user has had more time than another one who waits.
//              Worlds at full speed, and seeks, get slices: the user with the least time is next (time_shares.h), and
//              of his worlds the one that has waited longest. A slice ends when mail arrives or a paced world is due.
//              Therefore answers and paced worlds wait for at most one tick of another world.
//
// Owner        a simulation loop, on its thread.
// Determinism  the clock decides how many ticks are simulated. It does not influence what happens in them.
#pragma once

#include "server/base/executor.h"
#include "server/recording/recorder.h"
#include "server/runtime/clock.h"
#include "server/runtime/demand.h"
#include "server/runtime/loop_outputs.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/snapshot_times.h"
#include "server/runtime/time_shares.h"
#include "server/runtime/world_pace.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::runtime {

/// What a simulation loop works with. All of it must outlive the loop.
struct LoopTools {
    Mailbox& mailbox;
    StreamDemand& demand;
    base::Executor& executor;
    Clock& clock;
};

class Pace {
  public:
    static constexpr std::chrono::milliseconds slice{5};
    /// A world at full speed simulates ticks for about this time between two readings of the clock, because in a small
    /// world one tick takes only as long as one reading.
    static constexpr std::chrono::microseconds between_clock_readings{20};
    /// A shared world at full speed simulates ticks for about this time before its processes exchange results. Mail
    /// waits for as long.
    static constexpr std::chrono::milliseconds between_exchanges{15};

    /// Work that takes as much time as it can get: a world, or a seek.
    struct Contender {
        std::string_view user;              // whose account pays
        std::uint64_t* turn = nullptr;      // the number of its last slice
        simulation::Entry* world = nullptr; // nullptr: a seek
        std::uint64_t seek = 0;             // number of the seek
    };
    /// What depends on the loop.
    class Rules {
      public:
        virtual ~Rules() = default;
        /// Whether a build holds a world, so that it must neither advance nor count as running.
        virtual bool is_held(const simulation::Entry& world) const = 0;
        /// Whether a world must wait for the disk.
        virtual bool waits_for_disk(const simulation::Entry& world) const = 0;
        /// The user whose account pays for the time of a world.
        virtual std::string user_of(const simulation::Entry&) const = 0;
        virtual void after_tick(simulation::Entry&) {}
        virtual void advance_seek(std::uint64_t /*seek*/, const std::function<bool()>& /*stop*/) {}
    };

    /// All arguments must outlive this object. recorder: nullptr if runs are not stored.
    Pace(const LoopTools& tools, simulation::Laboratory& laboratory, recording::Recorder* recorder,
         const LoopOutputs& outputs, Rules& rules)
        : tools_{tools}, laboratory_{laboratory}, recorder_{recorder}, outputs_{outputs}, rules_{rules} {}

    /// Must be called when commands may have created, changed or deleted worlds.
    void follow_worlds();
    /// Makes the next snapshot of a world due at once.
    void show_change(const std::string& world);
    void set_demand(WorldDemands demand);

    /// Advances the worlds that are due, or one of the contenders.
    ///
    /// contenders  the seeks; worlds are added.
    /// returns     the time of the next call; nullopt: no world wants to advance.
    std::optional<Clock::time_point> advance(std::vector<Contender>& contenders);
    /// Whether a world would have to wait for other work.
    bool is_work_due(Clock::time_point now) const;
    /// Measures the speed of all worlds, and takes the snapshots that are due.
    void measure_and_show(Clock::time_point now);

  private:
    /// The data that the loop keeps about one world.
    struct WorldData {
        recording::RunRecorder* recorder = nullptr;
        std::shared_ptr<metrics::World> counted; // nullptr: no metrics
        std::string user;
        std::uint64_t turn = 0; // number of its last slice
        WorldPace pace;
        SnapshotTimes snapshots;
    };
    WorldData& data_of(const simulation::Entry& world) { return world_data_.find(world.name)->second; }
    const WorldData& data_of(const simulation::Entry& world) const { return world_data_.find(world.name)->second; }
    bool wants_tick(const simulation::Entry& world) const {
        return world.wants_tick() && !rules_.waits_for_disk(world) && !rules_.is_held(world);
    }
    void follow(simulation::Entry& world);

    /// The times at which paced worlds are due.
    struct Due {
        std::optional<Clock::time_point> next;    // of all
        std::optional<Clock::time_point> in_time; // of those that keep their pace
    };
    /// Advances the paced worlds that are due. Adds the other worlds that want ticks to the contenders.
    Due advance_paced(std::vector<Contender>& contenders);
    /// Whether another user, who has had less time, waits for some.
    bool has_more_than_its_share(const std::string& user, std::span<const Contender> contenders) const;
    /// Gives a slice to one contender. Returns the time at which they must be served again.
    std::optional<Clock::time_point> serve(std::vector<Contender>& contenders, const Due& due);
    void advance_slice(simulation::Entry& world, WorldData& data, Clock::time_point end);
    /// Advances a world by one tick or, if processes share it, by as many as it should before they exchange results.
    /// Returns the number of ticks.
    std::uint64_t advance(simulation::Entry& world, WorldData& data);
    /// Creates a checkpoint if one is due.
    ///
    /// spent  time that the last ticks and the work after them took.
    void make_due_checkpoint(const simulation::Entry& world, WorldData& data, Clock::duration spent);
    void measure_and_show(simulation::Entry& world, WorldData& data, Clock::time_point now);

    const LoopTools tools_;
    simulation::Laboratory& laboratory_;
    recording::Recorder* const recorder_;
    const LoopOutputs& outputs_;
    Rules& rules_;
    std::map<std::string, WorldData, std::less<>> world_data_; // by name of the world
    TimeShares shares_;
    std::uint64_t last_turn_ = 0;
    WorldDemands demand_;
    SnapshotPool pool_;
};

} // namespace evod::runtime
