// NewWorldDialog: asks for the experiment, name, seed and first population of a new world, and creates it.
//
// The experiment is a preset or the parameters of the viewed world. Its text can be edited before it is sent.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/world/new_world.h"
#include "client/viewer/world/poll.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// Explains a button that opens the dialog.
constexpr std::string_view new_world_text =
    "Creates a world from an experiment, a seed, and perhaps a population of the freezer.";

class NewWorldDialog {
  public:
    /// Opens the dialog in the next frame.
    ///
    /// beside      show the new world in the other half of the window
    /// population  name of the frozen population with which the world begins; empty: drawn from the seed
    void open(bool beside, std::string population = {});
    /// Builds the dialog while it is open. Call it once per frame, outside of every window.
    void build(Panel::Context& context);

  private:
    void begin(Panel::Context& context);
    void choose(std::optional<std::size_t> preset);
    void request_names(ViewedWorld& world);
    void build_experiments(const ViewedWorld& world, float scale);
    void build_fields(const Panel::Context& context);
    void build_population(const Panel::Context& context);
    void build_end(Panel::Context& context);
    void send(Panel::Context& context);

    /// What answers of the server set. Handlers hold weak references, because a new server means a new dialog.
    struct Answers {
        std::vector<std::string> names; // of all worlds
        std::string shown_json;         // the parameters of the viewed world; empty until they have arrived
        std::string problem;            // why the world cannot be created; empty: nothing is known
        bool sent = false, created = false;
    };
    std::shared_ptr<Answers> answers_ = std::make_shared<Answers>();

    bool opening_ = false, beside_ = false, name_edited_ = false;
    std::optional<std::size_t> preset_ = 0; // index of presets(); nullopt: the parameters of the viewed world
    NewWorldForm wanted_;                   // without the population, which is read when it is sent
    std::string population_;                // name of a file in the freezer; empty: drawn from the seed
};

} // namespace evod::viewer
