// Widgets: what panels share, and how a script finds what is on the screen.
//
// A widget that mark() was called for can be found by its name in the next frame, for as long as it is drawn. Names are
// those that a person reads; where two panels have the same, "Panel/name" tells them apart. What an open drop-down
// offers has the name "drop-down: choice".
//
// Needs        the Gui, whose frame it is.
// Threads      none.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/palette.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// Where the widgets of the last whole frame are, and on which the mouse rests.
class Spots {
  public:
    void begin_frame();
    /// What is marked from here on stands in the panel of this title; empty: in none.
    void begin_panel(std::string_view title) { panel_ = title; }
    void add(std::string_view name, Point centre);
    void add_drop_down(std::string_view name, Point centre);
    /// Of a drop-down that is open, where it can be seen.
    void add_choice(std::string_view drop_down, std::string_view choice, Point centre);

    /// name  "Apply", or "Parameters/Apply"
    std::optional<Point> find(const std::string& name) const;
    /// What a drop-down of this name offers where that can be seen, so nothing while it is closed; null if there is no
    /// such drop-down.
    const std::vector<std::string>* choices(const std::string& name) const;

    /// Whether the mouse has been on the widget with this corner for a while, as it is again now. Who clicks on it
    /// knows it, and wants to see what comes of that: then it does not, until the mouse has been elsewhere.
    bool lingers(Point corner, double now_s, bool clicked);

  private:
    struct Spot {
        Point centre;
        std::optional<std::vector<std::string>> choices; // nullopt: it is no drop-down
    };
    template <class Do>
    void each_name(std::string_view name, Do act);

    std::string panel_;
    std::map<std::string, Spot> shown_, building_;
    Point hovered_;
    double hovered_since_s_ = 0, hovered_last_s_ = -1;
    bool clicked_ = false; // since then
};

namespace widgets {

/// The widget made last has this name; nothing if it is clipped away.
void mark(std::string_view name);

/// ImGui::Button(), marked.
bool button(const char* label);

/// ImGui::Checkbox(), marked.
bool checkbox(const char* label, bool& on);

/// ImGui::BeginCombo(), marked as a drop-down. What is offered between it and ImGui::EndCombo() is each a choice().
///
/// name  what stands beside it, where the label does not
bool begin_drop_down(const char* label, const char* chosen, std::string_view name = {});
/// ImGui::Selectable(), marked as what the drop-down of this name offers.
bool choice(std::string_view drop_down, const std::string& name, bool chosen);

/// Whether a button of the mouse goes down in this frame on the window that is being made, or on what is in it.
bool window_pressed();

/// Small text in a quiet colour, or in the given one; wrapped at the edge of the panel.
void say(std::string_view text, Colour colour = palette::text_quiet);

/// Whether the mouse rests on the widget made last, so that a note is wanted.
bool wants_note();
/// A note at the mouse, in lines of a readable length.
void note(std::string_view text);
/// The note, if it is wanted.
void explain(std::string_view text);

} // namespace widgets
} // namespace evod::viewer
