// BreedingPanel: the glass box. It shows step by step how a generation was bred, beside the predictions of theory.
//
// While the panel is open, it requests the breeding of each new generation, or of the generation that the user chose.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/bets.h"
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
    static constexpr std::string_view name = "Glass box";
    std::string_view title() const override { return name; }
    Size first_size() const override { return {900, 620}; }
    float width_min() const override { return 640; }
    float height_min() const override { return 520; }
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

    /// Steps to the first pick of the sought organism as soon as this pick has been received.
    void seek_pick();
    /// Returns the number of picks made until the moment shown.
    std::uint32_t picks_made() const;
    bool picks_complete() const;

    void build_generation(const Context& context);
    void build_options(const Context& context);
    void build_transport(const Gui& gui);
    void take_keys();
    void build_stage(const Context& context);
    void build_first_step(const Gui& gui);
    void build_bets(const Gui& gui);
    void build_score();
    void build_picking(const Gui& gui, std::uint32_t index);
    void build_theory(const Gui& gui);

    std::optional<BreedingRecord> shown_, next_; // next_ replaces shown_ when the first page of next_ has arrived
    std::optional<Comparison> comparison_;       // for shown_; nullopt until all contenders have arrived
    Stepper stepper_;
    std::string error_; // why no further data can be shown
    Poll poll_;

    std::uint64_t newest_ = 0; // the generation before the shown one; 0: none yet
    std::uint64_t last_ = 0;   // the last generation that has bred; in a replay, it may be later than the shown one
    std::uint64_t chosen_ = 0;
    bool follow_ = true, play_each_ = false;
    Time next_change_{}; // earliest time to show a newer generation

    std::optional<std::uint32_t> sought_; // show the first pick of this organism; nullopt: no request

    bool betting_ = false;     // the user bets before the first pick
    bool bets_closed_ = false; // a pick of this breeding has been shown
    Bets bets_;
    bool field_active_ = false; // a field was in use in the last frame
    bool theory_shown_ = false; // in a narrow panel: show the theory in place of the step

    GenerationHold hold_;
};

} // namespace evod::viewer
