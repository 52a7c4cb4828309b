#include "client/core/snapshot_interpolator.h"

#include <algorithm>
#include <utility>

namespace evod::core {

namespace {

bool follows(const evod::v1::SnapshotFrame& next, const evod::v1::SnapshotFrame& before) {
    return next.run_id() == before.run_id() && next.world() == before.world() && next.island() == before.island() &&
           next.generation() == before.generation() && next.tick() >= before.tick() &&
           next.simulated_s() - before.simulated_s() <= SnapshotInterpolator::blended_s_max;
}

/// Returns for each entity its index in `among`, or no_match. Both lists are sorted by id.
std::vector<std::uint32_t> match(const codec::Entities& entities, const codec::Entities& among) {
    std::vector<std::uint32_t> indices(entities.x.size(), Positions::no_match);
    for (std::size_t i = 0, j = 0; i < indices.size(); ++i) {
        while (j < among.x.size() && among.id_of(j) < entities.id_of(i)) {
            ++j;
        }
        if (j < among.x.size() && among.id_of(j) == entities.id_of(i)) {
            indices[i] = static_cast<std::uint32_t>(j);
        }
    }
    return indices;
}

} // namespace

void SnapshotInterpolator::add(std::shared_ptr<const codec::ReceivedSnapshot> snapshot, Clock::time_point arrived) {
    const bool continues = latest_ && follows(snapshot->about, latest_->about);
    if (!(continues && previous_ && snapshot->about.tick() == latest_->about.tick())) {
        glide_ = std::min(std::chrono::duration<double>{arrived - latest_arrived_}, glide_max);
        previous_ = continues ? std::move(latest_) : nullptr;
        latest_arrived_ = arrived;
    }
    latest_ = std::move(snapshot);
    if (previous_) {
        match_ = match(latest_->entities->organisms, previous_->entities->organisms);
        crate_match_ = match(latest_->entities->crates, previous_->entities->crates);
    }
}

void SnapshotInterpolator::clear() {
    *this = SnapshotInterpolator{};
}

double SnapshotInterpolator::blend_at(Clock::time_point now) const {
    if (!previous_ || glide_.count() <= 0) {
        return 1;
    }
    return std::clamp(std::chrono::duration<double>{now - latest_arrived_} / glide_, 0.0, 1.0);
}

Positions SnapshotInterpolator::at(Kind kind, std::span<const std::uint32_t> match, double blend) const {
    if (!latest_) {
        return {};
    }
    return {.entities = &(latest_->entities.get()->*kind),
            .previous = previous_ ? &(previous_->entities.get()->*kind) : nullptr,
            .match = match,
            .blend = blend};
}

} // namespace evod::core
