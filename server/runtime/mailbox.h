// Mailbox: a queue of commands and queries (mail.h) for the simulation thread, in order of arrival.
//
// Threads      any thread adds mail. The simulation thread removes it between two ticks.
// Full         when it contains `mailbox_commands_max` entries, or half as many of one user, try_push() fails and the
//              sender receives REASON_SERVER_BUSY.
#pragma once

#include "server/base/quota.h"
#include "server/runtime/clock.h"
#include "server/runtime/mail.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace evod::runtime {

constexpr std::size_t mailbox_commands_max = 1024;

class Mailbox {
  public:
    explicit Mailbox(std::size_t capacity = mailbox_commands_max) : places_{capacity} {}

    /// Adds mail. Returns false if the mailbox, or the user's half of it, is full; `mail` is then unchanged.
    bool try_push(Mail&& mail, const std::string& user);
    /// Adds mail regardless of the capacity. Use it for mail that must not be lost and whose amount is bounded
    /// elsewhere.
    void push(Mail&& mail);

    /// Makes wait() return even if there is no mail.
    void wake();

    /// Whether mail or a wake() has arrived since the last drain(). It is cheap enough to be called in every tick.
    bool pending() const { return pending_.load(std::memory_order_acquire); }

    /// Removes and returns all entries, oldest first. The result reuses the memory of `emptied`.
    std::vector<Mail> drain(std::vector<Mail> emptied = {});

    /// The places that are held, by user.
    base::Quota places() const;

    /// Waits until there is mail, wake() is called, or the time `until` is reached; nullopt: no time limit.
    void wait(std::optional<Clock::time_point> until);

  private:
    void add(Mail&& mail, std::unique_lock<std::mutex> lock);

    std::atomic<bool> pending_ = false;
    mutable std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    base::Quota places_;
    std::vector<Mail> waiting_;
};

} // namespace evod::runtime
