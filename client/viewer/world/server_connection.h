// ServerConnection: the connection of a viewed world to its server, with the unanswered requests and the notices that
// the window shows.
//
// No function blocks. send() returns at once, and take_answers() calls the handlers of the answers that have arrived.
//
// Owner        ViewedWorld.
// Threads      used by the thread that draws; core::Connection has its own thread.
#pragma once

#include "client/core/connection.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::viewer {

/// Why a session with another role than admin may not create worlds.
constexpr std::string_view no_creation_text = "Only the role admin may create and delete worlds";

class ServerConnection {
  public:
    using AnswerHandler = std::function<void(const core::Result<evod::v1::Response>&)>;

    explicit ServerConnection(core::Options options);

    /// Sends a request. When the answer has arrived, take_answers() calls the handler, unless drop_answers() was called
    /// in between. The handler itself must report a refusal.
    void send(evod::v1::Request request, AnswerHandler handler,
              std::chrono::milliseconds timeout = core::Connection::default_timeout);
    void take_answers();
    /// Drops all unanswered requests: their handlers will not be called.
    void drop_answers() { unanswered_.clear(); }
    /// Returns whether every request has been answered. False until the first connection is established.
    bool all_answered() const { return connected_count_ > 0 && unanswered_.empty(); }

    /// Returns the server's Welcome message, once for each established connection; nullopt otherwise.
    std::optional<evod::v1::Welcome> take_welcome();
    bool was_connected() const { return connected_count_ > 0; }
    core::ConnectionStatus status() const { return connection_.status(); }
    bool connected() const { return status().state == core::State::Connected; }
    /// Returns why there is no connection, as a sentence. Empty while connected, and until the first attempt has
    /// failed.
    std::string problem() const;
    const core::Endpoint& endpoint() const { return options_.server; }
    bool uses_tls() const { return options_.tls.has_value(); }
    /// Gives access to the connection, for subscriptions.
    core::Connection& connection() { return connection_; }
    const core::Connection& connection() const { return connection_; }

    /// Returns whether the role of this session forbids commands. False until the server has reported the role.
    bool read_only() const { return role_ == evod::v1::ROLE_VIEWER; }
    /// Returns whether this session may create worlds. True until the server has reported the role.
    bool may_create() const { return role_ == evod::v1::ROLE_ADMIN || role_ == evod::v1::ROLE_UNSPECIFIED; }

    /// Adds a notice: a sentence that the window shows for some seconds.
    void notice(std::string text) { notices_.push_back(std::move(text)); }
    /// Adds a notice if the request was refused or not answered. Returns whether the request was accepted.
    bool report_if_refused(const core::Result<evod::v1::Response>& response);
    /// Returns and removes the notices since the last call, oldest first.
    std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

  private:
    struct Unanswered {
        AnswerHandler handler;
        std::future<core::Result<evod::v1::Response>> response;
    };

    core::Options options_;
    core::Connection connection_;
    std::vector<Unanswered> unanswered_;
    std::uint64_t connected_count_ = 0; // value at the last take_welcome()
    evod::v1::Role role_ = evod::v1::ROLE_UNSPECIFIED;
    std::vector<std::string> notices_;
};

/// Returns why a request was refused or not answered, as a sentence; empty if it was accepted.
std::string refusal_of(const core::Result<evod::v1::Response>& response);

} // namespace evod::viewer
