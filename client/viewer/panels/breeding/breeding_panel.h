// BreedingPanel: the glass box. It shows step by step how a generation was bred, beside the predictions of theory.
//
// While the panel is open, it requests the breeding of each new generation, or of the generation that the user chose.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/comparison.h"
#include "client/viewer/panels/breeding/generation_hold.h"
#include "client/viewer/panels/breeding/stepper.h"
#include "client/viewer/panels/panel.h"
#include "client/viewer/world/poll.h"

#include <optional>
#include <string>

namespace evod::viewer {

class BreedingPanel : public Panel {
  public:
    std::string_view title() const override { return "Glass box"; }
    Size first_size() const override { return {900, 620}; }
    float width_min() const override { return 640; }
    std::span<const Key> keys() const override;
    bool takes_keys() const override { return shown_.has_value(); }
    void build(Context& context) override;

  private:
    using Time = core::SnapshotInterpolator::Clock::time_point;

    void choose(const Context& context);
    void request(const Context& context);
    void receive(const evod::v1::Breeding& breeding);
    void show_next();
    void hold_world(ViewedWorld& world);

    void build_generation(const Context& context);
    void build_transport(const Gui& gui);
    void take_keys();
    void build_stage(const Context& context);
    void build_theory(const Gui& gui);

    std::optional<BreedingRecord> shown_, next_; // next_ replaces shown_ when the first page of next_ has arrived
    std::optional<Comparison> comparison_;       // for shown_; nullopt until all contenders have arrived
    Stepper stepper_;
    std::string error_; // why no further data can be shown
    Poll poll_;

    std::uint64_t newest_ = 0; // the last generation that has bred; 0: none yet
    std::uint64_t chosen_ = 0;
    bool follow_ = true, play_each_ = false;
    Time next_change_{}; // earliest time to show a newer generation

    GenerationHold hold_;
};

} // namespace evod::viewer
