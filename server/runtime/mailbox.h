// Mailbox: a queue of commands and queries (mail.h) for the simulation thread, in order of arrival.
//
// Threads      any thread adds mail. The simulation thread removes it between two ticks.
// Full         when it contains `mailbox_commands_max` entries, try_push() fails and the sender receives
//              REASON_SERVER_BUSY.
#pragma once

#include "server/runtime/clock.h"
#include "server/runtime/mail.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <vector>

namespace evod::runtime {

constexpr std::size_t mailbox_commands_max = 1024;

class Mailbox {
  public:
    explicit Mailbox(std::size_t capacity = mailbox_commands_max) : capacity_{capacity} {}

    /// Adds mail. Returns false if the mailbox is full; `mail` is then unchanged.
    bool try_push(Mail&& mail);
    /// Adds mail regardless of the capacity. Use it for mail that must not be lost and whose amount is bounded
    /// elsewhere.
    void push(Mail&& mail);

    /// Makes wait() return even if there is no mail.
    void wake();

    /// Whether mail or a wake() has arrived since the last drain(). It is cheap enough to be called in every tick.
    bool pending() const { return pending_.load(std::memory_order_acquire); }

    /// Removes and returns all entries, oldest first. The result reuses the memory of `emptied`.
    std::vector<Mail> drain(std::vector<Mail> emptied = {});

    struct FillLevel {
        std::size_t waiting = 0, capacity = 0;
    };
    FillLevel fill() const;

    /// Waits until there is mail, wake() is called, or the time `until` is reached; nullopt: no time limit.
    void wait(std::optional<Clock::time_point> until);

  private:
    bool push(Mail&& mail, std::size_t capacity);

    const std::size_t capacity_;
    std::atomic<bool> pending_ = false;
    mutable std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    std::vector<Mail> waiting_;
};

} // namespace evod::runtime
