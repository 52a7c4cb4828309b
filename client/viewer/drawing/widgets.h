// Widgets: helpers that all panels use, and the register by which a script finds widgets on the screen.
//
// mark() registers a widget by name; find() returns it in the next frame, as long as the widget is drawn. Names are the
// labels that users read. "Panel/name" is unique where two panels have the same label. A choice of an open drop-down
// has the name "drop-down: choice".
//
// Owner        Spots belongs to the Gui; the rest are functions.
// Needs        called between Gui::begin() and Gui::draw().
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/palette.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// The positions of the widgets of the last complete frame, and the widget on which the mouse rests.
class Spots {
  public:
    void begin_frame();
    /// Widgets registered from here on belong to the panel of this title; empty: to none.
    void begin_panel(std::string_view title) { panel_ = title; }
    void add(std::string_view name, Point centre);
    void add_drop_down(std::string_view name, Point centre);
    /// A visible choice of an open drop-down.
    void add_choice(std::string_view drop_down, std::string_view choice, Point centre);

    /// name  "Apply", or "Parameters/Apply"
    std::optional<Point> find(const std::string& name) const;
    /// The visible choices of the drop-down of this name, empty while it is closed; null if there is no such drop-down.
    const std::vector<std::string>* choices(const std::string& name) const;

    /// Whether the mouse has rested long enough on the widget with this corner to show its note. Called in every frame
    /// in which the mouse is on it. After a click the answer is no until the mouse has left the widget, so that the
    /// note does not cover the effect of the click.
    bool lingers(Point corner, double now_s, bool clicked);

  private:
    struct Spot {
        Point centre;
        std::optional<std::vector<std::string>> choices; // nullopt: not a drop-down
    };
    template <class Do>
    void each_name(std::string_view name, Do act);

    std::string panel_;
    std::map<std::string, Spot> shown_, building_;
    Point hovered_;
    double hovered_since_s_ = 0, hovered_last_s_ = -1;
    bool clicked_ = false; // since hovered_since_s_
};

namespace widgets {

/// Registers the last widget under this name; does nothing if the widget is clipped.
void mark(std::string_view name);

/// ImGui::Button(), marked.
bool button(const char* label);

/// ImGui::Checkbox(), marked.
bool checkbox(const char* label, bool& on);

/// ImGui::BeginCombo(), marked as a drop-down. Call choice() for each entry between it and ImGui::EndCombo().
///
/// name  to register if it differs from the label
bool begin_drop_down(const char* label, const char* chosen, std::string_view name = {});
/// ImGui::Selectable(), marked as a choice of the drop-down of this name.
bool choice(std::string_view drop_down, const std::string& name, bool chosen);

/// Whether a mouse button is pressed in this frame on the current window or on a widget in it.
bool window_pressed();

/// Small text in a muted colour, or in the given one, wrapped at the edge of the panel.
void say(std::string_view text, Colour colour = palette::text_quiet);

/// Whether the mouse rests on the last widget, so that its note is due.
bool wants_note();
/// Shows a note at the mouse, in lines of a readable length.
void note(std::string_view text);
/// Shows the note if wants_note().
void explain(std::string_view text);

} // namespace widgets
} // namespace evod::viewer
