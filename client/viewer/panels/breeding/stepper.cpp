#include "client/viewer/panels/breeding/stepper.h"

#include <algorithm>
#include <cmath>

namespace evod::viewer {

void Stepper::load(std::uint32_t picks, std::uint32_t descendants) {
    picks_ = picks;
    descendants_ = descendants;
    go_to(0);
}

Moment Stepper::moment() const {
    if (position_ == 0) {
        return {BreedingStage::Scaling, 0};
    }
    if (position_ <= picks_) {
        return {BreedingStage::Picking, position_ - 1};
    }
    if (position_ <= picks_ + descendants_) {
        return {BreedingStage::Breeding, position_ - 1 - picks_};
    }
    return {BreedingStage::Done, 0};
}

std::uint32_t Stepper::begin_of(BreedingStage stage) const {
    switch (stage) {
    case BreedingStage::Scaling:
        return 0;
    case BreedingStage::Picking:
        return 1;
    case BreedingStage::Breeding:
        return 1 + picks_;
    case BreedingStage::Done:
        break;
    }
    return last_position();
}

void Stepper::stop() {
    playing_ = false;
    due_ = 0;
}

void Stepper::go_to(std::uint32_t position) {
    stop();
    position_ = std::min(position, last_position());
}

void Stepper::step() {
    go_to(at_end() ? position_ : position_ + 1);
}

void Stepper::back() {
    go_to(at_begin() ? 0 : position_ - 1);
}

void Stepper::next_stage() {
    for (const BreedingStage stage : {BreedingStage::Picking, BreedingStage::Breeding, BreedingStage::Done}) {
        if (begin_of(stage) > position_) {
            return go_to(begin_of(stage));
        }
    }
    stop();
}

void Stepper::previous_stage() {
    for (const BreedingStage stage : {BreedingStage::Breeding, BreedingStage::Picking, BreedingStage::Scaling}) {
        if (begin_of(stage) < position_) {
            return go_to(begin_of(stage));
        }
    }
    stop();
}

void Stepper::play() {
    if (at_end()) {
        position_ = 0;
    }
    playing_ = true;
}

void Stepper::play_or_stop() {
    playing_ ? stop() : play();
}

void Stepper::set_speed(double steps_per_s) {
    steps_per_s_ = std::clamp(steps_per_s, speed_min, speed_max);
}

void Stepper::advance(double seconds) {
    if (!playing_) {
        return;
    }
    due_ += seconds * steps_per_s_;
    const double whole = std::floor(due_);
    due_ -= whole;
    const std::uint32_t left = last_position() - position_;
    if (whole >= left) {
        return go_to(last_position());
    }
    position_ += static_cast<std::uint32_t>(whole);
}

} // namespace evod::viewer
