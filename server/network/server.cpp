#include "server/network/server.h"

#include "server/network/limits.h"
#include "server/network/random_ids.h"
#include "server/protocol/events.h"
#include "server/runtime/worker_pool.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <spdlog/spdlog.h>

#include <csignal>
#include <utility>

namespace evod::network {

base::Result<std::unique_ptr<Server>> Server::open(ServerOptions options) {
    std::unique_ptr<Server> server{new Server{std::move(options)}};
    auto listener = Listener::open(server->context_, server->options_.bind_address, server->options_.port);
    if (!listener)
        return listener.error();
    server->listener_ = *std::move(listener);
    std::signal(SIGPIPE, SIG_IGN); // whoever read the log may go; the server stays
    // From now on: whoever reads that the server listens may send them.
    server->signals_.add(SIGINT);
    server->signals_.add(SIGTERM);
    return server;
}

Server::Server(ServerOptions options)
    : options_{std::move(options)}
    , executor_{runtime::make_executor(options_.threads)}
    , outbox_{[this] { asio::post(context_, [this] { deliver(); }); }}
    , streams_{sessions_, demand_, mailbox_}
    , dispatcher_{mailbox_, outbox_, demand_, streams_} {
    host_.instance_id = to_text(draw_run_id());
    host_.handle = [this](Session& session, v1::Request request) { dispatcher_.handle(session, std::move(request)); };
    host_.ended = [this](Session& session) {
        --connections_;
        const bool watched = !session.snapshots.empty() || !session.events.empty();
        sessions_.erase(session.number());
        if (watched)
            streams_.update_demand();
    };
}

Server::~Server() = default;

void Server::run() {
    for (simulation::Command& command : options_.first_commands)
        mailbox_.try_push(
            runtime::CommandMail{std::move(command), [](const simulation::Laboratory&, const simulation::Command&,
                                                        const base::Result<simulation::Applied>& applied) {
                                     if (!applied)
                                         spdlog::error("cannot begin as asked: {}", to_text(applied.error()));
                                 }});
    simulation_ = std::make_unique<runtime::SimulationThread>(
        mailbox_, demand_, *executor_, clock_,
        runtime::LoopOutputs{
            .events =
                [this](const simulation::Laboratory& laboratory, std::vector<simulation::Event> events) {
                    if (!demand_.events_wanted())
                        return;
                    for (const simulation::Event& event : events)
                        outbox_.event([this, told = protocol::to_proto(event, laboratory)]() mutable {
                            streams_.tell(std::move(told));
                        });
                },
            .picture = [this](runtime::SnapshotPtr snapshot) { outbox_.picture(std::move(snapshot)); }});

    signals_.async_wait([this](boost::system::error_code error, int signal) {
        if (error)
            return;
        spdlog::info("{}: going away", signal == SIGINT ? "SIGINT" : "SIGTERM");
        go_away();
    });
    asio::co_spawn(context_, listener_->accept([this](tcp::socket socket) { accepted(std::move(socket)); }),
                   asio::detached);
    context_.run();
}

void Server::stop() {
    asio::post(context_, [this] { go_away(); });
}

void Server::accepted(tcp::socket socket) {
    const auto session = std::make_shared<Session>(std::move(socket), host_, ++session_number_);
    ++connections_;
    if (going_away_)
        return session->start(base::Refusal{
            .code = base::RefusalCode::Unavailable, .message = "the server is going away", .violations = {}});
    if (sessions_.size() >= sessions_max)
        return session->start(
            base::Refusal{.code = base::RefusalCode::ResourceExhausted,
                          .message = "the server has " + std::to_string(sessions_max) + " sessions already",
                          .violations = {}});
    sessions_.emplace(session->number(), session);
    session->start();
}

void Server::deliver() {
    runtime::Outbox::Taken taken = outbox_.take();
    for (runtime::Delivery& delivery : taken.deliveries)
        delivery();
    if (taken.dropped_events > 0)
        streams_.count_dropped_events(taken.dropped_events);
    const auto now = clock_.now();
    for (const auto& picture : taken.pictures)
        streams_.show(picture, now);
}

void Server::go_away() {
    if (std::exchange(going_away_, true))
        return;
    signals_.cancel();
    listener_->close();
    dispatcher_.refuse_all();
    // What was admitted is still answered.
    simulation_->stop();
    deliver();
    v1::Event event;
    event.mutable_server_going_away();
    const SharedBytes frame = encode_event(std::move(event));
    for (const auto& [number, session] : sessions_) {
        if (session->greeted())
            session->event(frame);
        session->finish();
    }
}

} // namespace evod::network
