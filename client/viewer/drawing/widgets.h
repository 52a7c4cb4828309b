// Widgets: helpers that all panels use, and the register by which a script finds widgets on the screen.
//
// mark() registers a widget by name. After the frame, find() returns it. The name is the label that users read. If two
// panels have widgets with the same label, "Panel/name" is unique. A choice of an open drop-down has the name
// "drop-down: choice".
//
// Owner        WidgetPositions belongs to the Gui; the rest are functions.
// Needs        called between Gui::begin() and Gui::draw().
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/palette.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::viewer {

/// A widget of the last complete frame, as a script finds it.
struct MarkedWidget {
    enum class Kind { Other, Field, CheckBox, DropDown };
    Kind kind = Kind::Other;
    std::string panel{}, name{};        // panel: empty if the widget belongs to no panel
    std::vector<std::string> aliases{}; // further names
    Rectangle place{};
    unsigned id = 0; // of Dear ImGui; 0: a text, or a group of widgets
    bool enabled = true;
    bool visible = true;                // false: scrolled out of sight
    std::string note{};                 // the text that explains the widget while the mouse rests on it
    std::optional<std::string> value{}; // of a field or drop-down as text; "on" or "off" of a check box
    std::vector<std::string> choices{}; // of a drop-down; empty while it is closed

    Point centre() const { return place.centre(); }
    /// "Panel/name", which is unique.
    std::string full_name() const { return panel.empty() ? name : panel + "/" + name; }
};

/// Stores the widgets of the last complete frame, and the widget on which the mouse rests.
class WidgetPositions {
  public:
    /// Call after the last widget of a frame was built.
    ///
    /// hovered  the widget of Dear ImGui under the mouse; 0: none
    void end_frame(unsigned hovered);
    /// Assigns the widgets registered after this call to the panel with this title, or to no panel if `title` is empty.
    void begin_panel(std::string_view title) { panel_ = title; }
    /// Registers a widget in the current panel; add() sets its panel.
    void add(MarkedWidget widget);
    /// Registers a choice of an open drop-down as "drop-down: choice".
    ///
    /// alias  another name of the choice; empty: none
    void add_choice(std::string_view drop_down, std::string_view choice, std::string_view alias, MarkedWidget widget);
    /// Adds a name to the widget that was registered last.
    void add_alias(std::string_view alias);
    /// Stores the note of the widget that was registered last, if it has this id.
    void explain(unsigned id, std::string_view note);

    /// Returns the widgets with this name or alias, such as "Apply" or "Parameters/Apply".
    std::vector<const MarkedWidget*> find(std::string_view name) const;
    /// The widget of Dear ImGui that was under the mouse in the last complete frame; 0: none.
    unsigned hovered() const { return hovered_id_; }

    /// Scrolls the widget with this name into view in the next frame.
    void reveal(std::string name) { wanted_ = std::move(name); }
    /// Returns whether reveal() was called for a widget with this name in the current panel.
    bool is_wanted(std::string_view name) const;

    /// Returns whether the mouse has rested on the widget with this corner long enough to show its note. Must be called
    /// in every frame in which the mouse is on the widget. After a click, returns false until the mouse has left the
    /// widget, so that the note does not cover the effect of the click.
    bool mouse_rests(Point corner, double now_s, bool clicked);

  private:
    std::string panel_, wanted_;
    std::vector<MarkedWidget> shown_, building_;
    unsigned hovered_id_ = 0;
    Point hovered_;
    double hovered_since_s_ = 0, hovered_last_s_ = -1;
    bool clicked_ = false; // a click happened since hovered_since_s_
};

namespace widgets {

/// Registers the widget that was drawn last under this name.
void mark(std::string_view name);
/// Adds a name to the widget that was registered last.
void alias(std::string_view name);
/// Registers the field or slider that was drawn last, with its value. A script compares the value with the one it set.
void mark_field(std::string_view name, std::string value);
void mark_field(std::string_view name, double value);

/// Draws an ImGui::Button() and registers it with mark().
bool button(const char* label);

/// Ends an ImGui popup, with a button "Cancel" that closes it.
void end_popup_with_cancel();
/// Draws an ImGui::Checkbox() and registers it as a check box.
///
/// name  the name to register, if it differs from the label
bool checkbox(const char* label, bool& on, std::string_view name = {});

/// Calls ImGui::BeginCombo() and registers the widget as a drop-down. Call choice() for each entry before
/// ImGui::EndCombo().
///
/// name  the name to register, if it differs from the label
bool begin_drop_down(const char* label, const char* chosen, std::string_view name = {});
/// Draws an ImGui::Selectable() and registers it as a choice of the drop-down with this name.
///
/// alias  another name of the choice; empty: none
bool choice(std::string_view drop_down, const std::string& name, bool chosen, std::string_view alias = {});

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
