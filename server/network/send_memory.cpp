#include "server/network/send_memory.h"

#include "server/base/assert.h"

#include <utility>

namespace evod::network {

SendMemory::Counted::Counted(SendMemory& owner, SharedBytes bytes) : owner_{&owner}, bytes_{std::move(bytes)} {
    EVOD_ASSERT(bytes_ != nullptr);
    if (++owner_->holders_[bytes_.get()] == 1) {
        owner_->add(bytes_->size());
    }
}

SendMemory::Counted::Counted(Counted&& other) noexcept
    : owner_{std::exchange(other.owner_, nullptr)}, bytes_{std::exchange(other.bytes_, nullptr)} {}

SendMemory::Counted& SendMemory::Counted::operator=(Counted&& other) noexcept {
    if (this != &other) {
        release();
        owner_ = std::exchange(other.owner_, nullptr);
        bytes_ = std::exchange(other.bytes_, nullptr);
    }
    return *this;
}

void SendMemory::Counted::release() {
    if (!bytes_) {
        return;
    }
    const auto holders = owner_->holders_.find(bytes_.get());
    if (--holders->second == 0) {
        owner_->holders_.erase(holders);
        owner_->bytes_ -= bytes_->size();
    }
    bytes_.reset();
}

std::size_t SendMemory::Counted::share() const {
    return bytes_ ? bytes_->size() / owner_->holders_.at(bytes_.get()) : 0;
}

void SendMemory::Reservation::set(std::size_t bytes) {
    if (bytes > bytes_) {
        owner_.add(bytes - bytes_);
    } else {
        owner_.bytes_ -= bytes_ - bytes;
    }
    bytes_ = bytes;
}

void SendMemory::add(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ <= bytes_max_ || std::exchange(reported_, true)) {
        return;
    }
    exceeded_();
}

} // namespace evod::network
