// Session: one TCP connection to a server, from looking up its name to the end. Connection makes a new one after a
// loss.
//
// Owner        Connection, which drops it when it has ended.
// Threads      all on the io_context's one thread; handlers are called there too.
// Bounded      what is sent is queued here without a limit: Connection keeps to the server's.
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
        bool final = false;                           // trying again is of no use
        bool token_needed = false;                    // without another token
        std::optional<evod::v1::Status> refusal = {}; // of which the reason tells
    };
    struct Handlers {
        std::function<void(evod::v1::Welcome)> welcomed; // once, before any of the next two
        std::function<void(evod::v1::ServerMessage)> received;
        std::function<void(evod::v1::SnapshotFrame)> pictured;
        std::function<void(Ending)> ended; // once, and nothing after it
    };

    Session(boost::asio::io_context& io, const Options& options, Handlers handlers);
    ~Session() { give_up_look_up(); }

    void start();
    /// Queues a whole frame. Only after `welcomed`.
    void send(std::string frame);
    /// Closes at once; no handler is called any more.
    void close();

  private:
    void look_up();
    void looked_up(const boost::system::error_code& error,
                   const boost::asio::ip::tcp::resolver::results_type& addresses);
    void give_up_look_up();
    void connect(const boost::asio::ip::tcp::resolver::results_type& addresses);
    /// Only if there is to be TLS.
    void shake_hands();
    void begin();
    void say_hello();
    void read();
    void take_frames();
    void take_control(std::span<const std::byte> body);
    void take_first(const evod::v1::ServerMessage& message);
    Ending lost(const boost::system::error_code& error) const;
    Ending refused(const evod::v1::Status& status, const char* did, bool final) const;
    void write();
    void expect_within(std::chrono::milliseconds timeout, std::string what);
    void end(Ending ending);

    boost::asio::io_context& io_;
    const Options options_;
    Handlers handlers_;
    struct LookUp;
    std::shared_ptr<LookUp> look_up_; // nullptr: none was begun
    boost::asio::ip::tcp::socket socket_;
    std::optional<boost::asio::ssl::context> tls_context_;
    std::optional<boost::asio::ssl::stream<boost::asio::ip::tcp::socket&>> tls_; // nullopt: in the clear
    std::string disbelief_;                                                      // in the server's certificate, and why
    boost::asio::steady_timer deadline_;
    codec::FrameReader reader_{codec::client_limits};
    std::vector<std::byte> received_;
    std::deque<std::string> to_send_; // the first is being written
    bool welcomed_ = false, ended_ = false;
    bool going_away_ = false;                 // the server has said so
    std::optional<evod::v1::Status> goodbye_; // why the server ends the session
};

} // namespace evod::core
