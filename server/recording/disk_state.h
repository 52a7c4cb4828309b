// Disk state: whether run files can be written, and how many bytes wait to be written.
//
// Faults         of single runs, whose files cannot be written although the disk can (run_fault.h).
// Backpressure   if at least `waiting_bytes_max` bytes wait, has_room() is false and the caller produces no records.
// Threads        any. The storage thread changes the state, and calls the callback of when_changed().
#pragma once

#include "server/recording/run_fault.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace evod::recording {

/// How much a data folder may contain. Both may change while the server runs.
struct StorageLimits {
    std::optional<std::uint64_t> keep_runs = {};      // newest ended runs of each world that stay; nullopt: all
    std::optional<std::uint64_t> disk_bytes_max = {}; // of the whole folder; above it, nothing is written
};

/// The same, at most, of the worlds of a class.
constexpr std::uint64_t class_runs_kept = 16;

class DiskState {
  public:
    static constexpr std::size_t waiting_bytes_max = 64 << 20;

    /// Size of the data that waits to be written, without checkpoints.
    std::size_t waiting_bytes() const { return waiting_bytes_.load(std::memory_order_acquire); }
    bool has_room() const { return waiting_bytes() < waiting_bytes_max; }
    /// The reason why nothing can be written now; nullopt if writing works.
    std::optional<std::string> trouble() const;
    /// The runs whose files cannot be written now, or never again. A run is in the list until it ends.
    RunFaults faults() const;
    /// The storage thread calls `changed` when trouble(), faults() or has_room() has changed. `changed` must neither
    /// block nor call this object. When this function returns, the previous callback is not called any more.
    void when_changed(std::function<void()> changed);

    StorageLimits limits() const;
    void set_limits(const StorageLimits& limits);

    void added(std::size_t bytes) { waiting_bytes_.fetch_add(bytes, std::memory_order_relaxed); }
    void written(std::size_t bytes);
    /// why  the reason why nothing can be written; empty: writing works.
    void set_trouble(const std::string& why);
    void set_faults(RunFaults faults);

  private:
    std::atomic<std::size_t> waiting_bytes_ = 0;
    mutable std::mutex mutex_; // guards the members below
    std::string trouble_;
    RunFaults faults_;
    StorageLimits limits_;
    std::function<void()> when_changed_;
};

} // namespace evod::recording
