// StartScreen: where to go and as whom: recent servers, an address, a token, TLS.
//
// Tokens stay in this process: they are shown as dots, and written nowhere.
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
    /// begin_with  what the fields say at first
    StartScreen(Screen& screen, const core::Options& begin_with);

    /// Until a person has chosen; nullopt if the window was closed.
    std::optional<core::Options> run();

    /// Why it is shown again: there is no connection. Empty: a person wants it.
    void tell(std::string reason) { reason_ = std::move(reason); }

    /// A server that there was a connection with.
    void remember(const core::Endpoint& server);

  private:
    void build(const Gui& gui);
    void build_recent();
    bool build_fields(const Gui& gui);
    /// Takes the fields as the choice, or says what is wrong with them.
    void choose();

    template <std::size_t size>
    using Field = std::array<char, size>;

    Screen& screen_;
    core::Options options_; // what the fields do not say
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
