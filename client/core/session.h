// Session: one TCP connection to a server, from the look-up of the host name until the connection is closed. After a
// lost connection, Connection creates a new Session.
//
// Owner        Connection, which destroys it when it has ended.
// Threads      everything, including the handlers, runs on the single thread of the io_context.
// Bounded      the queue of frames to send has no limit; Connection observes the server's limits.
#pragma once

#include "client/core/connection.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::core {

class Session : public std::enable_shared_from_this<Session> {
  public:
    struct Ending {
        std::string reason;
        bool final = false;                           // another attempt to connect would fail too
        bool token_needed = false;                    // the server requires a (different) token
        std::optional<evod::v1::Status> refusal = {}; // nullopt: the session ended for another reason
    };
    struct Handlers {
        std::function<void(evod::v1::Welcome)> welcomed; // called once, before `received` and `snapshot_received`
        std::function<void(evod::v1::ServerMessage)> received;
        std::function<void(evod::v1::SnapshotFrame)> snapshot_received;
        std::function<void(Ending)> ended; // called once, after all other handlers
    };

    Session(boost::asio::io_context& io, const Options& options, Handlers handlers);
    ~Session() { cancel_look_up(); }

    void start();
    /// Queues a complete frame. Must not be called before `welcomed` was called.
    void send(std::string frame);
    /// Closes immediately; no handler is called afterwards.
    void close();

  private:
    void look_up();
    void looked_up(const boost::system::error_code& error,
                   const boost::asio::ip::tcp::resolver::results_type& addresses);
    void cancel_look_up();
    void connect(const boost::asio::ip::tcp::resolver::results_type& addresses);
    /// Performs the TLS handshake. Only for connections with TLS.
    void perform_handshake();
    void begin();
    void send_hello();
    void read();
    void handle_frames();
    void handle_control(std::span<const std::byte> body);
    void handle_first_message(const evod::v1::ServerMessage& message);
    Ending lost(const boost::system::error_code& error) const;
    Ending refused(const evod::v1::Status& status, const char* did, bool final) const;
    void write();
    void start_deadline(std::chrono::milliseconds timeout, std::string what);
    void end(Ending ending);

    boost::asio::io_context& io_;
    const Options options_;
    Handlers handlers_;
    struct LookUp;
    std::shared_ptr<LookUp> look_up_; // nullptr: not started
    boost::asio::ip::tcp::socket socket_;
    std::optional<boost::asio::ssl::context> tls_context_;
    std::optional<boost::asio::ssl::stream<boost::asio::ip::tcp::socket&>> tls_; // nullopt: without TLS
    std::string distrust_; // why this client does not trust the server's certificate; empty: no such reason is known
    boost::asio::steady_timer deadline_;
    codec::FrameReader reader_{codec::client_limits};
    std::vector<std::byte> received_;
    std::deque<std::string> to_send_; // the first frame is being written
    bool welcomed_ = false, ended_ = false;
    bool going_away_ = false;                 // the server has announced its shutdown
    std::optional<evod::v1::Status> goodbye_; // the server's reason for ending the session
};

} // namespace evod::core
