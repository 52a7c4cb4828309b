#include "server/network/buffers.h"

#include "server/base/assert.h"

#include <utility>

namespace evod::network {

Buffers::Held::Held(Buffers& buffers, SharedBytes bytes) : buffers_{&buffers}, bytes_{std::move(bytes)} {
    EVOD_ASSERT(bytes_ != nullptr);
    if (++buffers_->holders_[bytes_.get()] == 1) {
        buffers_->add(bytes_->size());
    }
}

Buffers::Held::Held(Held&& other) noexcept
    : buffers_{std::exchange(other.buffers_, nullptr)}, bytes_{std::exchange(other.bytes_, nullptr)} {}

Buffers::Held& Buffers::Held::operator=(Held&& other) noexcept {
    if (this != &other) {
        let_go();
        buffers_ = std::exchange(other.buffers_, nullptr);
        bytes_ = std::exchange(other.bytes_, nullptr);
    }
    return *this;
}

void Buffers::Held::let_go() {
    if (!bytes_) {
        return;
    }
    const auto holders = buffers_->holders_.find(bytes_.get());
    if (--holders->second == 0) {
        buffers_->holders_.erase(holders);
        buffers_->bytes_ -= bytes_->size();
    }
    bytes_.reset();
}

std::size_t Buffers::Held::share() const {
    return bytes_ ? bytes_->size() / buffers_->holders_.at(bytes_.get()) : 0;
}

void Buffers::Own::set(std::size_t bytes) {
    if (bytes > bytes_) {
        buffers_.add(bytes - bytes_);
    } else {
        buffers_.bytes_ -= bytes_ - bytes;
    }
    bytes_ = bytes;
}

void Buffers::add(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ <= bytes_max_ || std::exchange(told_, true)) {
        return;
    }
    over_();
}

} // namespace evod::network
