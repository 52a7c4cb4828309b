// PlayingServer: answers evoview like a server, and sends one snapshot that a test made.
#pragma once

#include "tests/unit/core/fake_server.h"
#include "tests/unit/viewer/world/population_pages.h"

#include <atomic>
#include <string>
#include <thread>
#include <utility>

namespace evod::viewer {

class PlayingServer {
  public:
    explicit PlayingServer(evod::v1::SnapshotFrame snapshot) : snapshot_{std::move(snapshot)} {
        thread_ = std::thread{[this] {
            try {
                serve(server_.accept_and_welcome(0, evod::v1::ROLE_VIEWER));
            } catch (const boost::system::system_error&) {
                // The client disconnected during a write, which is allowed.
            }
        }};
    }
    /// Waits for the client to disconnect; it must have connected.
    ~PlayingServer() { thread_.join(); }

    std::string address() const { return core::to_text(server_.endpoint()); }
    unsigned command_count() const { return command_count_; }

  private:
    void serve(core::FakeSession session) {
        for (auto message = session.read(); message.has_request(); message = session.read()) {
            const evod::v1::Request& request = message.request();
            evod::v1::ServerMessage answer;
            answer.mutable_response()->set_request_id(request.request_id());
            if (request.has_subscribe_snapshots()) {
                const auto& wanted = request.subscribe_snapshots();
                if (!wanted.world().empty() && wanted.world() != snapshot_.world()) {
                    session.refuse(request.request_id(), evod::v1::CODE_NOT_FOUND,
                                   "no world \"" + wanted.world() + "\"");
                    continue;
                }
                session.answer_subscription(request, 7);
                snapshot_.set_subscription_id(7);
                session.send(snapshot_);
                continue;
            }
            if (request.has_subscribe_events()) {
                session.answer_subscription(request, 8);
                continue;
            }
            if (request.has_get_population()) {
                // Ten organisms: those of the snapshot, and dead ones.
                *answer.mutable_response()->mutable_population() = page_of(0, 10, 10, snapshot_.generation());
                session.send(answer);
                continue;
            }
            const bool is_query = request.has_get_statistics() || request.has_get_parameters() ||
                                  request.has_get_history() || request.has_list_worlds() || request.has_describe();
            command_count_ += !is_query;
            auto& statistics = *answer.mutable_response()->mutable_statistics();
            auto& world = *statistics.mutable_world();
            world.set_name(snapshot_.world());
            world.set_run_id("00112233445566778899aabbccddeeff"); // of every snapshot in these tests
            world.set_tick(snapshot_.tick());
            world.set_state(snapshot_.state());
            *world.mutable_speed() = snapshot_.speed();
            world.add_gene_names("impulse");
            world.add_gene_names("food_radius");
            auto& last = *statistics.add_last();
            last.set_island(snapshot_.island());
            last.set_generation(snapshot_.generation() - 1);
            last.set_fitness_best(251.34);
            last.set_fitness_mean(160.2);
            session.send(answer);
        }
    }

    core::FakeServer server_;
    evod::v1::SnapshotFrame snapshot_;
    std::atomic<unsigned> command_count_ = 0;
    std::thread thread_;
};

} // namespace evod::viewer
