#include "client/core/world_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evod::core {

namespace {

constexpr std::size_t no_match = static_cast<std::size_t>(-1);

bool follows(const evod::v1::SnapshotFrame& next, const evod::v1::SnapshotFrame& before) {
    return next.run_id() == before.run_id() && next.world() == before.world() && next.island() == before.island() &&
           next.generation() == before.generation() && next.tick() >= before.tick() &&
           next.simulated_s() - before.simulated_s() <= WorldView::blended_s_max;
}

/// Returns for each id in `ids` its index in `among`, or no_match. Both vectors are in ascending order.
std::vector<std::size_t> match(const std::vector<std::uint32_t>& ids, const std::vector<std::uint32_t>& among) {
    std::vector<std::size_t> indices(ids.size(), no_match);
    for (std::size_t i = 0, j = 0; i < ids.size(); ++i) {
        while (j < among.size() && among[j] < ids[i]) {
            ++j;
        }
        if (j < among.size() && among[j] == ids[i]) {
            indices[i] = j;
        }
    }
    return indices;
}

float between(float from, float to, double blend) {
    return static_cast<float>(from + (to - from) * blend);
}

} // namespace

void WorldView::add(std::shared_ptr<const codec::DecodedSnapshot> snapshot, Clock::time_point arrived) {
    if (previous_ && snapshot->about.tick() == latest_->about.tick() && follows(snapshot->about, latest_->about)) {
        match_ = match(snapshot->organisms.id, previous_->organisms.id);
        crate_match_ = match(snapshot->crates.id, previous_->crates.id);
        latest_ = std::move(snapshot);
        return;
    }
    if (latest_ && follows(snapshot->about, latest_->about)) {
        glide_ = std::min(std::chrono::duration<double>{arrived - latest_arrived_}, glide_max);
        match_ = match(snapshot->organisms.id, latest_->organisms.id);
        crate_match_ = match(snapshot->crates.id, latest_->crates.id);
        previous_ = std::move(latest_);
    } else {
        previous_ = nullptr;
    }
    latest_ = std::move(snapshot);
    latest_arrived_ = arrived;
}

void WorldView::clear() {
    *this = WorldView{};
}

double WorldView::blend_at(Clock::time_point now) const {
    if (!previous_ || glide_.count() <= 0) {
        return 1;
    }
    return std::clamp(std::chrono::duration<double>{now - latest_arrived_} / glide_, 0.0, 1.0);
}

const WorldView::Positions& WorldView::organisms_at(double blend) {
    organisms_.x_px.clear();
    organisms_.y_px.clear();
    if (latest_) {
        const auto& to = latest_->organisms;
        organisms_.x_px = to.x_px;
        organisms_.y_px = to.y_px;
        for (std::size_t i = 0; previous_ && i < to.id.size(); ++i) {
            if (const std::size_t j = match_[i]; j != no_match) {
                organisms_.x_px[i] = between(previous_->organisms.x_px[j], to.x_px[i], blend);
                organisms_.y_px[i] = between(previous_->organisms.y_px[j], to.y_px[i], blend);
            }
        }
    }
    return organisms_;
}

const WorldView::Positions& WorldView::crates_at(double blend) {
    crates_.x_px.clear();
    crates_.y_px.clear();
    if (latest_) {
        const auto& to = latest_->crates;
        crates_.x_px = to.x_px;
        crates_.y_px = to.y_px;
        for (std::size_t i = 0; previous_ && i < to.id.size(); ++i) {
            if (const std::size_t j = crate_match_[i]; j != no_match) {
                crates_.x_px[i] = between(previous_->crates.x_px[j], to.x_px[i], blend);
                crates_.y_px[i] = between(previous_->crates.y_px[j], to.y_px[i], blend);
            }
        }
    }
    return crates_;
}

} // namespace evod::core
