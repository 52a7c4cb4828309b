// BreedingPanel: the glass box: how a generation was bred, step by step, and what theory says of it.
//
// While it is shown it asks for the breeding of each generation that comes, or for the one that is chosen.
//
// Threads      none; used by the thread that draws.
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
    std::span<const Key> keys() const override;
    bool takes_keys() const override { return shown_.has_value(); }
    void build(Context& context) override;

  private:
    using Time = core::WorldView::Clock::time_point;

    void choose(const Context& context);
    void ask(const Context& context);
    void take(const evod::v1::Breeding& breeding);
    void show_coming();
    void hold_world(ViewedWorld& world);

    void build_generation(const Context& context);
    void build_transport(const Gui& gui);
    void take_keys();
    void build_stage(const Context& context);
    void build_theory(const Gui& gui);

    std::optional<BreedingRecord> shown_, coming_; // what comes is shown when its first page is here
    std::optional<Comparison> comparison_;         // of what is shown; nullopt until all of it is known
    Stepper stepper_;
    std::string error_; // why there is no more to be shown
    Poll poll_;

    std::uint64_t newest_ = 0; // generation that was bred from; 0: none yet
    std::uint64_t chosen_ = 0;
    bool follow_ = true, play_each_ = false;
    Time next_look_{}; // for a newer generation

    GenerationHold hold_;
};

} // namespace evod::viewer
