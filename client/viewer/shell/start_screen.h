// StartScreen: asks the user for the server to connect to: a recent server or an address, a token, and TLS.
//
// Tokens stay in this process: the screen shows dots in place of a token, and no file contains it.
//
// Owner        run().
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/shell/recent_servers.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/shell/settings.h"

#include <array>
#include <optional>
#include <string>

namespace evod::viewer {

class StartScreen {
  public:
    /// initial  the contents of the fields when the screen opens
    StartScreen(Screen& screen, const core::Options& initial);

    /// Shows the screen until the user has chosen a server. Returns nullopt if the user closed the window.
    std::optional<core::Options> run();

    /// Sets the text in which the screen states why there is no connection. Empty: the user opened the screen.
    void set_reason(std::string reason) { reason_ = std::move(reason); }

    /// Adds a server to the list of recent servers.
    void remember(const core::Endpoint& server);

  private:
    void build(const Gui& gui);
    void build_recent();
    bool build_fields(const Gui& gui);
    /// Chooses the server that the fields describe. If a field is invalid, sets the reason that the screen shows.
    void choose();

    template <std::size_t size>
    using Field = std::array<char, size>;

    Screen& screen_;
    core::Options options_; // includes the options for which there is no field
    RecentServers recent_;
    Field<300> address_{};
    Field<4096> token_{};
    Field<4096> ca_{};
    bool tls_ = false;
    std::string reason_;
    std::optional<core::Options> chosen_;
    bool closing_ = false;
};

} // namespace evod::viewer
