// Panels: contains all panels. The user shows and hides a panel with its key (F2 to F12), or by its button in the strip
// at the top of the window.
//
// Owner        the stage.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"

#include <SFML/Window/Event.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// Number of panels that have a key, F2 to F12. F1 shows the help.
constexpr std::size_t panel_key_count = 11;
/// The name of the panel's key: "F2" for the first panel; empty for panels without a key.
std::string panel_key(std::size_t index);

class Panels {
  public:
    Panels();

    /// Shows or hides panel `index`; ignores an index beyond the last panel.
    void toggle(std::size_t index);
    bool shown(std::size_t index) const { return index < places_.size() && places_[index].shown; }
    /// Hides the visible panel that was used last. Returns false if no panel is visible.
    bool close_front();
    /// Whether the panel with the keyboard focus handles this key. If not, the key goes to the main window.
    bool handles(const sf::Event::KeyEvent& key) const;
    /// Call when evoview has connected to another server. Every panel clears its data; visible panels stay visible.
    void begin_session();

    /// Shows the panel with this title.
    void show(std::string_view title);

    /// The titles of all panels, in the order of their keys.
    const std::vector<std::string_view>& titles() const { return titles_; }
    std::span<const Panel::Key> keys_of(std::size_t index) const { return places_[index].panel->keys(); }

    /// Builds the strip of names and the visible panels. Call between Gui::begin() and Gui::draw().
    ///
    /// room  the part of the window in which panels are placed until the user moves them.
    void build(Panel::Context context, Rectangle room);

  private:
    struct Place {
        std::unique_ptr<Panel> panel;
        bool shown = false;
        int built = -1;           // the last frame of Dear ImGui in which it was built
        Rectangle at{}, put_at{}; // current place, and the place chosen by place_for(); width 0: none yet
    };
    void build_strip(const Gui& gui);
    Rectangle place_for(std::size_t index, float scale) const;
    void use(std::size_t index);

    std::vector<Place> places_;
    std::vector<std::string_view> titles_;
    Rectangle room_;
    std::vector<std::size_t> used_;       // panel indices, the most recently used last
    std::optional<std::size_t> keyboard_; // index of the panel with the keyboard focus
};

} // namespace evod::viewer
