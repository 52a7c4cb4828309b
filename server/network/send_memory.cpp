#include "server/network/send_memory.h"

#include "server/base/assert.h"

#include <algorithm>
#include <utility>

namespace evod::network {

SendMemory::Counted::Counted(SendMemory& owner, SharedBytes bytes) : owner_{&owner}, bytes_{std::move(bytes)} {
    EVOD_ASSERT(bytes_ != nullptr);
    const bool is_first = ++owner_->holders_[bytes_.get()] == 1;
    owner_->add(bytes_per_holder + (is_first ? frame_bytes() : 0));
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
        owner_->remove(frame_bytes());
    }
    owner_->remove(bytes_per_holder);
    bytes_.reset();
}

std::size_t SendMemory::Counted::share() const {
    return bytes_ ? bytes_per_holder + frame_bytes() / owner_->holders_.at(bytes_.get()) : 0;
}

void SendMemory::Reservation::set(std::size_t bytes) {
    if (bytes > bytes_) {
        owner_.add(bytes - bytes_);
    } else {
        owner_.remove(bytes_ - bytes);
    }
    bytes_ = bytes;
}

void SendMemory::add(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ <= check_above_ || std::exchange(reported_, true)) {
        return;
    }
    check_();
}

void SendMemory::remove(std::size_t bytes) {
    bytes_ -= bytes;
    check_above_ = std::min(check_above_, next_check());
}

void SendMemory::rearm() {
    reported_ = false;
    check_above_ = next_check();
}

std::size_t SendMemory::next_check() const {
    const std::size_t later = std::max(bytes_max_ / 2, bytes_ + bytes_max_ / 32);
    return bytes_ <= bytes_max_ ? std::min(later, bytes_max_) : later;
}

} // namespace evod::network
