// Settings: stores the sidebar, the places of detached panels and the view options in a file, from one start of evoview
// to the next.
//
// The file has the format of Dear ImGui's settings files: sections of lines "name=value". Unknown sections and lines
// are ignored. If the file cannot be read or written, evoview starts with the defaults.
//
// Owner        Screen.
// Needs        a Gui, from construction to destruction.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/island/island_view.h"
#include "client/viewer/panels/panels.h"

#include <filesystem>
#include <optional>
#include <string>

namespace evod::viewer {

/// Returns the path of a file in $XDG_STATE_HOME/evod or ~/.local/state/evod; nullopt if neither XDG_STATE_HOME nor
/// HOME is set.
std::optional<std::filesystem::path> in_state_folder(const char* name);

class Settings {
  public:
    /// Reads the file and passes the settings to `panels`, which must outlive this object. If `file` is nullopt, stores
    /// nothing.
    Settings(std::optional<std::filesystem::path> file, Panels& panels);
    /// Writes the file.
    ~Settings();
    Settings(const Settings&) = delete;
    Settings& operator=(const Settings&) = delete;

    /// The view options that were read from the file and will be written to it.
    ViewOptions& view() { return view_; }

  private:
    void add_sidebar();
    void add_view();

    std::optional<std::filesystem::path> file_;
    Panels& panels_;
    ViewOptions view_;
};

} // namespace evod::viewer
