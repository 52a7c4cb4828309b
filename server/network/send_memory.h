// SendMemory: counts the memory that the server holds for its sessions, so that one limit applies to all sessions
// together: data that waits to be sent, requests and their answers in preparation, subscriptions with their snapshots,
// and replays.
//
// If several sessions share the same bytes, these bytes exist once and are counted once.
//
// Owner        the server. The sessions use it on the network thread.
// Full         above half of `bytes_max`, which is the most that one user may hold, it calls `check` from time to time.
//              That must close sessions until each user, and all together, are within their limits.
#pragma once

#include "proto/codec/shared_bytes.h"
#include "server/streaming/snapshot_memory.h"

#include <cstddef>
#include <functional>
#include <unordered_map>

namespace evod::network {

using codec::SharedBytes;

/// Memory of a frame in addition to its bytes, and of each place that holds it.
constexpr std::size_t bytes_per_frame = 120, bytes_per_holder = 40;

class SendMemory final : public streaming::SnapshotMemory {
  public:
    /// check  called once when the sum exceeds half of the limit. It is called again only after rearm(), when the sum
    ///        has grown by a part of the limit, or exceeds it. It must not release memory before it returns.
    SendMemory(std::size_t bytes_max, std::function<void()> check)
        : bytes_max_{bytes_max}, check_{std::move(check)}, check_above_{bytes_max / 2} {}

    /// A reference to shared bytes. SendMemory counts the bytes as long as a reference exists.
    class Counted {
      public:
        Counted() = default;
        Counted(SendMemory& owner, SharedBytes bytes);
        Counted(Counted&& other) noexcept;
        Counted& operator=(Counted&& other) noexcept;
        ~Counted() { release(); }

        explicit operator bool() const { return bytes_ != nullptr; }
        const std::string& operator*() const { return *bytes_; }
        const std::string* operator->() const { return bytes_.get(); }

        /// The memory of the frame divided by the number of objects that share it.
        std::size_t share() const;

      private:
        void release();
        std::size_t frame_bytes() const { return bytes_->size() + bytes_per_frame; }

        SendMemory* owner_ = nullptr;
        SharedBytes bytes_;
    };

    /// Memory that only one session uses. set() changes its size.
    class Reservation {
      public:
        explicit Reservation(SendMemory& owner) : owner_{owner} {}
        Reservation(const Reservation&) = delete;
        ~Reservation() { set(0); }
        void set(std::size_t bytes);
        std::size_t bytes() const { return bytes_; }

      private:
        SendMemory& owner_;
        std::size_t bytes_ = 0;
    };

    void add(std::size_t bytes) override;
    void remove(std::size_t bytes) override;

    std::size_t bytes() const { return bytes_; }
    std::size_t bytes_max() const { return bytes_max_; }
    /// Number of bytes by which the limit is exceeded.
    std::size_t excess() const { return bytes_ > bytes_max_ ? bytes_ - bytes_max_ : 0; }
    /// Allows `check` to be called again.
    void rearm();

  private:
    /// The sum above which the next check is due. A check walks all sessions, so it waits for some growth.
    std::size_t next_check() const;

    const std::size_t bytes_max_;
    const std::function<void()> check_;
    std::unordered_map<const std::string*, std::size_t> holders_; // numbers of the places that hold a frame
    std::size_t bytes_ = 0, check_above_;
    bool reported_ = false;
};

} // namespace evod::network
