// PlayingServer: answers evoview as a server would, and shows it the one picture that a test has made.
#pragma once

#include "tests/unit/core/fake_server.h"
#include "tests/unit/viewer/watch/population_pages.h"

#include <atomic>
#include <string>
#include <thread>
#include <utility>

namespace evod::viewer {

class PlayingServer {
  public:
    explicit PlayingServer(evod::v1::SnapshotFrame picture) : picture_{std::move(picture)} {
        thread_ = std::thread{[this] {
            try {
                serve(server_.accept_and_welcome(0, evod::v1::ROLE_VIEWER));
            } catch (const boost::system::system_error&) {
                // The client left while it was being written to, as it may.
            }
        }};
    }
    /// Waits for the client to leave; it must have come.
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
                if (!wanted.world().empty() && wanted.world() != picture_.world()) {
                    session.refuse(request.request_id(), evod::v1::CODE_NOT_FOUND,
                                   "no world \"" + wanted.world() + "\"");
                    continue;
                }
                session.answer_subscription(request, 7);
                picture_.set_subscription_id(7);
                session.send(picture_);
                continue;
            }
            if (request.has_subscribe_events()) {
                session.answer_subscription(request, 8);
                continue;
            }
            if (request.has_get_population()) {
                // Ten of them: those that the picture shows, and dead ones.
                *answer.mutable_response()->mutable_population() = page_of(0, 10, 10, picture_.generation());
                session.send(answer);
                continue;
            }
            command_count_ += !request.has_get_statistics();
            auto& statistics = *answer.mutable_response()->mutable_statistics();
            auto& world = *statistics.mutable_world();
            world.set_name(picture_.world());
            world.set_run_id("00112233445566778899aabbccddeeff"); // of every picture that the tests show
            world.set_tick(picture_.tick());
            world.set_state(picture_.state());
            *world.mutable_speed() = picture_.speed();
            world.add_gene_names("impulse");
            world.add_gene_names("food_radius");
            auto& last = *statistics.add_last();
            last.set_island(picture_.island());
            last.set_generation(picture_.generation() - 1);
            last.set_fitness_best(251.34);
            last.set_fitness_mean(160.2);
            session.send(answer);
        }
    }

    core::FakeServer server_;
    evod::v1::SnapshotFrame picture_;
    std::atomic<unsigned> command_count_ = 0;
    std::thread thread_;
};

} // namespace evod::viewer
