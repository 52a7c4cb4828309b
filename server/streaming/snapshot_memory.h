// Snapshot memory: counts the memory of snapshots and their encodings. Several sessions share them, so they are counted
// where they are made, and as long as they exist.
//
// Owner        the server passes an implementation to SnapshotStreams. It must outlive all snapshots and encodings.
// Threads      the network thread.
#pragma once

#include "proto/codec/shared_bytes.h"

#include <cstddef>
#include <string>

namespace evod::streaming {

using codec::SharedBytes;

class SnapshotMemory {
  public:
    virtual void add(std::size_t bytes) = 0;
    virtual void remove(std::size_t bytes) = 0;

  protected:
    virtual ~SnapshotMemory() = default;
};

/// The memory of one object. set() changes its size; the destructor sets it to 0.
class SnapshotBytes {
  public:
    /// memory  nullptr: nothing is counted there.
    explicit SnapshotBytes(SnapshotMemory* memory) : memory_{memory} {}
    SnapshotBytes(const SnapshotBytes&) = delete;
    ~SnapshotBytes() { set(0); }
    void set(std::size_t bytes);
    std::size_t bytes() const { return bytes_; }
    SnapshotMemory* memory() const { return memory_; }

  private:
    SnapshotMemory* memory_;
    std::size_t bytes_ = 0;
};

/// The memory that the allocator needs for each object in addition to its size, on average.
constexpr std::size_t allocation_bytes = 16;

/// Returns bytes that are counted as long as a reference to them exists.
///
/// memory  nullptr: they are not counted.
SharedBytes counted(std::string bytes, SnapshotMemory* memory);
/// Memory of the result of counted().
std::size_t bytes_of(const SharedBytes& encoding);

} // namespace evod::streaming
