// StartScreen: asks for the server to connect to: recent servers, an address, a token, TLS.
//
// Tokens stay in this process: the screen shows them as dots, and no file contains them.
//
// Owner        run().
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/shell/recent_servers.h"
#include "client/viewer/shell/screen.h"

#include <array>
#include <optional>
#include <string>

namespace evod::viewer {

class StartScreen {
  public:
    /// initial  the first content of the fields
    StartScreen(Screen& screen, const core::Options& initial);

    /// Returns when a person has chosen a server; nullopt if the window was closed.
    std::optional<core::Options> run();

    /// Sets the problem that the screen shows: why there is no connection. Empty: a person opened the screen.
    void set_reason(std::string reason) { reason_ = std::move(reason); }

    /// Adds a server to the recent ones.
    void remember(const core::Endpoint& server);

  private:
    void build(const Gui& gui);
    void build_recent();
    bool build_fields(const Gui& gui);
    /// Chooses the server in the fields, or sets the problem with them.
    void choose();

    template <std::size_t size>
    using Field = std::array<char, size>;

    Screen& screen_;
    core::Options options_; // with what the fields do not contain
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
