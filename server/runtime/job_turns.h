// Job turns: bounds the number of background jobs that compute at once, and divides their time equally among users.
//
// A job computes only while it has a turn. It gives the turn back while it waits for its client, and passes it on after
// `slice` if another job waits. The waiting job of the user with the least time comes next (time_shares.h). So a short
// job waits for about one slice, however many long jobs other users have.
//
// Threads      the threads of the job queues. A job that waits for a turn blocks its thread.
#pragma once

#include "server/base/stop_check.h"
#include "server/runtime/clock.h"
#include "server/runtime/time_shares.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <stop_token>
#include <string>

namespace evod::runtime {

class JobTurns {
  public:
    static constexpr std::chrono::milliseconds slice{10};
    /// Of the threads of background jobs. Linux gives such a thread a tenth of a processor that a live world also
    /// wants.
    static constexpr int niceness = 10;
    /// Returns a number of turns with which some processors are left for the simulation and for packing.
    static std::size_t count_for(std::size_t processors);

    /// turn_count  jobs that compute at once, >= 1.
    /// clock       is called by one thread at a time. Must outlive this object.
    JobTurns(std::size_t turn_count, Clock& clock) : clock_{clock}, free_{turn_count} {}

    /// The turn of one job. The job's thread calls all functions.
    class Turn {
      public:
        /// Waits for the turn.
        ///
        /// user  whose account pays for the time.
        /// stop  ends a wait; the job must then end without computing. `turns` and `stop` must outlive this object.
        Turn(JobTurns& turns, std::string user, const std::stop_token& stop);
        ~Turn() { give_back(); }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

        /// Must be called often. Passes the turn on if another job comes next, and waits until it comes back.
        ///
        /// returns  false: the job is stopped.
        bool go_on();
        /// go_on() for work that knows nothing of turns. Must not outlive this object.
        base::StopCheck stop_check() {
            return base::StopCheck{[this] { return !go_on(); }};
        }
        /// Gives the turn back while the job waits for something else.
        void give_back();
        /// Waits for the turn again.
        void take();

      private:
        friend class JobTurns;
        void wait(std::unique_lock<std::mutex>& lock);

        JobTurns& turns_;
        const std::string user_;
        const std::stop_token& stop_;
        // turns_.mutex_ guards the members below.
        std::condition_variable_any granted_;
        bool is_held_ = false;
        Clock::time_point since_; // until then, the time is accounted
    };

    /// The number of jobs that wait for a turn.
    std::size_t waiting_count() const { return waiting_count_; }

  private:
    // These functions need the lock.
    void account(Turn& turn);
    void free(Turn& turn);
    void grant_free_turns();
    /// The job that comes next; end() if none waits.
    std::deque<Turn*>::iterator next();

    Clock& clock_;
    std::atomic<std::size_t> waiting_count_ = 0;
    std::mutex mutex_;                  // guards the members below, and changes of waiting_count_
    std::size_t free_;                  // turns that no job has
    std::deque<Turn*> waiting_;         // in the order of their arrival
    Clock::time_point contended_since_; // since when jobs have waited; meaningless if none waits
    TimeShares shares_;
};

} // namespace evod::runtime
