// Session: one TCP connection to a server, with TLS if the options require it, from the look-up of the host name until
// the connection is closed. It passes received bytes and the loss of the connection to the ProtocolState. After a lost
// connection, Connection creates a new Session.
//
// Owner        Connection, which destroys it when it has ended.
// Threads      everything runs on the single thread of the io_context, except the look-up of the host name.
// Bounded      the queue of bytes to send has no limit; ProtocolState observes the server's limits.
#pragma once

#include "client/core/protocol_state.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>

namespace evod::core {

class Session : public std::enable_shared_from_this<Session> {
  public:
    /// changed  the session calls this function after each call to `protocol`.
    Session(std::shared_ptr<boost::asio::io_context> io, const Options& options, ProtocolState& protocol,
            std::function<void()> changed);

    void start();
    void send(std::string bytes);
    /// Closes immediately. Afterwards the session calls neither `protocol` nor `changed`.
    void close();

  private:
    using Addresses = boost::asio::ip::tcp::resolver::results_type;
    void handle_addresses(const boost::system::error_code& error, const Addresses& addresses);
    /// Loads the certificates and the key for TLS. Returns an error message that names the unusable file; empty on
    /// success.
    std::string load_tls_files();
    void perform_handshake();
    void begin();
    void read();
    void write();
    Ending lost(const boost::system::error_code& error) const;
    void end(Ending ending);

    const std::shared_ptr<boost::asio::io_context> io_; // the thread that looks up the host name may outlive it
    const Options options_;
    ProtocolState& protocol_;
    const std::function<void()> changed_;
    boost::asio::ip::tcp::socket socket_;
    std::optional<boost::asio::ssl::context> tls_context_;
    std::optional<boost::asio::ssl::stream<boost::asio::ip::tcp::socket&>> tls_; // nullopt: without TLS
    std::string distrust_; // why this client does not trust the server's certificate; empty: no such reason is known
    std::vector<std::byte> received_;
    std::deque<std::string> to_send_; // the first element is being written
    bool has_received_ = false, ended_ = false;
};

} // namespace evod::core
