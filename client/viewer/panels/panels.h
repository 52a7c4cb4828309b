// Panels: every panel there is, each shown or hidden with a key, F2 and up, or the strip of their names.
//
// Threads      none; used by the thread that draws.
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

/// As many panels as there are keys: F1 is the help.
constexpr std::size_t panel_key_count = 11;
/// "F2" for the first; empty for those beyond the keys.
std::string panel_key(std::size_t index);

class Panels {
  public:
    Panels();

    /// Shows or hides panel `index`; one that is not there is nothing.
    void toggle(std::size_t index);
    bool shown(std::size_t index) const { return index < places_.size() && places_[index].shown; }
    /// Hides the one that was used last of those that are shown; false if none is.
    bool close_front();
    /// Whether a key is for the panel that has the keyboard, and not for the window.
    bool take(const sf::Event::KeyEvent& key) const;
    /// Another server: what the panels know is forgotten, those that are shown stay.
    void begin_session();

    /// Shows the panel of that title.
    void show(std::string_view title);

    /// Of all panels, in the order of their keys.
    const std::vector<std::string_view>& titles() const { return titles_; }
    std::span<const Panel::Key> keys_of(std::size_t index) const { return places_[index].panel->keys(); }

    /// The strip of names and the panels that are shown, between Gui::begin() and Gui::draw().
    ///
    /// room  of the window: panels stand in it until a person moves them
    void build(Panel::Context context, Rectangle room);

  private:
    struct Place {
        std::unique_ptr<Panel> panel;
        bool shown = false;
        int built = -1;           // the last frame of Dear ImGui in which it was
        Rectangle at{}, put_at{}; // where it is, and was put; of no width: nowhere yet
    };
    void build_strip(const Gui& gui);
    Rectangle place_for(std::size_t index, float scale) const;
    void use(std::size_t index);

    std::vector<Place> places_;
    std::vector<std::string_view> titles_;
    Rectangle room_;
    std::vector<std::size_t> used_;       // indices, those of late at the end
    std::optional<std::size_t> keyboard_; // the panel that has it
};

} // namespace evod::viewer
