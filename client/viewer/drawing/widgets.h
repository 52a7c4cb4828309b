// Widgets: helpers that all panels use, and the register by which a script finds widgets on the screen.
//
// mark() registers a widget by name. In the next frame, find() returns its position if it was drawn. The name is the
// label that users read. If two panels have widgets with the same label, "Panel/name" is unique. A choice of an open
// drop-down has the name "drop-down: choice".
//
// Owner        WidgetPositions belongs to the Gui; the rest are functions.
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

/// Stores the positions of the widgets of the last complete frame, and the widget on which the mouse rests.
class WidgetPositions {
  public:
    void begin_frame();
    /// Assigns the widgets registered after this call to the panel with this title, or to no panel if `title` is empty.
    void begin_panel(std::string_view title) { panel_ = title; }
    void add(std::string_view name, Point centre);
    void add_drop_down(std::string_view name, Point centre);
    /// Registers a visible choice of an open drop-down.
    void add_choice(std::string_view drop_down, std::string_view choice, Point centre);

    /// Returns the centre of the widget with this name, such as "Apply" or "Parameters/Apply". Returns nullopt if the
    /// last complete frame did not contain the widget.
    std::optional<Point> find(const std::string& name) const;
    /// Returns the visible choices of the drop-down with this name: an empty list while the drop-down is closed; null
    /// if there is no such drop-down.
    const std::vector<std::string>* choices(const std::string& name) const;

    /// Returns whether the mouse has rested on the widget with this corner long enough to show its note. Must be called
    /// in every frame in which the mouse is on the widget. After a click, returns false until the mouse has left the
    /// widget, so that the note does not cover the effect of the click.
    bool mouse_rests(Point corner, double now_s, bool clicked);

  private:
    struct Widget {
        Point centre;
        std::optional<std::vector<std::string>> choices; // nullopt: the widget is not a drop-down
    };
    template <class Do>
    void for_each_name(std::string_view name, Do act);

    std::string panel_;
    std::map<std::string, Widget> shown_, building_;
    Point hovered_;
    double hovered_since_s_ = 0, hovered_last_s_ = -1;
    bool clicked_ = false; // a click happened since hovered_since_s_
};

namespace widgets {

/// Registers the widget that was drawn last under this name. Does nothing if the widget is clipped.
void mark(std::string_view name);

/// Draws an ImGui::Button() and registers it with mark().
bool button(const char* label);

/// Draws an ImGui::Checkbox() and registers it with mark().
bool checkbox(const char* label, bool& on);

/// Calls ImGui::BeginCombo() and registers the widget as a drop-down. Call choice() for each entry before
/// ImGui::EndCombo().
///
/// name  the name to register, if it differs from the label
bool begin_drop_down(const char* label, const char* chosen, std::string_view name = {});
/// Draws an ImGui::Selectable() and registers it as a choice of the drop-down with this name.
bool choice(std::string_view drop_down, const std::string& name, bool chosen);

/// Returns whether a mouse button is pressed in this frame on the current window or on one of its widgets.
bool window_pressed();

/// Writes small text in `colour`, wrapped at the edge of the panel.
void small_text(std::string_view text, Colour colour = palette::text_quiet);

/// Returns whether the mouse has rested on the last widget long enough to show its note.
bool wants_note();
/// Shows a note at the mouse, in lines of a readable length.
void note(std::string_view text);
/// Shows the note of the last widget if wants_note().
void explain(std::string_view text);

} // namespace widgets
} // namespace evod::viewer
