#include "server/streaming/snapshot_memory.h"

#include <memory>
#include <utility>

namespace evod::streaming {
namespace {

struct CountedString {
    CountedString(std::string content, SnapshotMemory* memory) : bytes{std::move(content)}, counted{memory} {}

    std::string bytes;
    SnapshotBytes counted;
};

} // namespace

void SnapshotBytes::set(std::size_t bytes) {
    if (memory_ != nullptr && bytes > bytes_) {
        memory_->add(bytes - bytes_);
    } else if (memory_ != nullptr && bytes < bytes_) {
        memory_->remove(bytes_ - bytes);
    }
    bytes_ = bytes;
}

SharedBytes counted(std::string bytes, SnapshotMemory* memory) {
    const auto made = std::make_shared<CountedString>(std::move(bytes), memory);
    const SharedBytes shared{made, &made->bytes};
    made->counted.set(bytes_of(shared));
    return shared;
}

std::size_t bytes_of(const SharedBytes& encoding) {
    constexpr std::size_t of_object = sizeof(CountedString) + 2 * allocation_bytes; // with the counts of references
    const bool is_within = encoding->capacity() < sizeof(std::string) / 2;
    return of_object + (is_within ? 0 : encoding->capacity() + allocation_bytes);
}

} // namespace evod::streaming
