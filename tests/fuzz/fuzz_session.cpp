// Fuzzes sessions: a script of client actions on a server without threads, port and disk. Clients connect, send a
// Hello, send requests with valid and invalid fields, send bytes in pieces, read or do not read, acknowledge and
// disconnect. The script also advances the simulation and the clock. watched_server.h and watching_client.h check the
// invariants after every step. In the end every request is answered, every session has ended after its client, and
// every world equals its twin.
//
// An action is one byte for the kind (low half) and the client (high half), the bytes of its arguments, and one byte
// for what follows.
#include "server/log/log.h"
#include "server/network/session.h"
#include "server/parameters/model_parameters.h"
#include "tests/fuzz/script.h"
#include "tests/fuzz/valid_snapshot.h"
#include "tests/fuzz/watched_server.h"
#include "tests/fuzz/watching_client.h"

#include <sys/socket.h>

#include <array>
#include <chrono>
#include <memory>
#include <vector>

namespace evod::fuzz {
namespace {

using namespace std::chrono_literals;

/// Small and short by default.
void make_light(v1::CreateWorld& create, Script& script) {
    struct Given {
        const char* name;
        std::uint32_t value;
    };
    for (const auto& [name, value] :
         {Given{"population_size", 2u + script.take() % 4}, Given{"food_count", 4}, Given{"poison_count", 3},
          Given{"generation_s", 1}, Given{"island_width_px", 200}, Given{"island_height_px", 150}}) {
        bool given = false;
        for (const v1::ParameterAssignment& there : create.parameters()) {
            given = given || there.name() == name;
        }
        if (given) {
            continue;
        }
        v1::ParameterAssignment& assignment = *create.add_parameters();
        assignment.set_name(name);
        assignment.mutable_value()->set_count(value);
    }
    for (v1::IslandPopulation& population : *create.mutable_population()) {
        population.mutable_genes()->Resize(6 * (2 + script.take() % 4), 100);
    }
}

class Play {
  public:
    explicit Play(std::span<const std::uint8_t> bytes) : script_{bytes} {}

    void run() {
        while (!script_.over()) {
            act();
            go_on();
        }
        end();
    }

  private:
    void act() {
        const auto what = script_.take();
        if (clients_.empty() || what % 16 == 0) {
            return open();
        }
        WatchingClient& client = *clients_[what / 16 % clients_.size()];
        switch (what % 16) {
        case 1:
            return say_hello(client);
        default:
            return ask(client);
        case 7:
            return client.say(last_asked_);
        case 8:
            return client.say(frame(script_.take_bytes(script_.take())));
        case 9:
            return client.say(script_.take_bytes(script_.take()));
        case 10:
            return acknowledge(client);
        case 11:
            client.hear(1 + 16 * script_.take());
            return;
        case 12:
            if (script_.take() % 2 == 0) {
                client.finish();
            } else {
                std::erase_if(clients_, [&](const auto& one) { return one.get() == &client; });
            }
            return;
        case 13:
            return clock().advance(script_.one_of({1ms, 8ms, 17ms, 50ms, 300ms, 1000ms, 2500ms, 6000ms, 11'000ms}));
        case 14:
            for (int passes = script_.take() % 8; passes > 0; --passes) {
                server_.pass();
            }
            return;
        }
    }

    /// By default everything is sent, read, processed, answered and received.
    void go_on() {
        const auto how = script_.take();
        for (const auto& client : clients_) {
            client->send((how & 1) != 0 ? how >> 4 : SIZE_MAX);
        }
        if ((how & 2) == 0) {
            server_.poll();
        }
        if ((how & 4) == 0) {
            server_.pass();
        }
        if ((how & 8) == 0) {
            server_.poll();
            for (const auto& client : clients_) {
                while (client->hear(SIZE_MAX)) {
                }
            }
        }
    }

    void open() {
        constexpr std::size_t clients_max = 8;
        const auto how = script_.take();
        if (clients_.size() == clients_max) {
            return;
        }
        const bool refused = how % 16 == 15 || server_.going_away();
        std::array<int, 2> ends{};
        require(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
        if (how % 16 >= 8) { // a small socket buffer, so that data has to wait
            const int bytes = 1;
            require(::setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes) == 0); // the smallest possible
        }
        clients_.push_back(std::make_unique<WatchingClient>(ends[0], answers_, refused));
        if (refused) {
            server_.accept(ends[1], base::refusal(base::RefusalCode::Unavailable, "not now"));
        } else {
            server_.accept(ends[1]);
        }
        constexpr const char* tokens[] = {"admin", "controller", "viewer", "admin", "unknown"};
        if (how / 16 < std::size(tokens)) {
            v1::ClientMessage message;
            message.mutable_hello()->set_protocol_version(1);
            message.mutable_hello()->set_token(tokens[how / 16]);
            clients_.back()->say(message);
        }
    }

    void say_hello(WatchingClient& client) {
        v1::ClientMessage message;
        fill(*message.mutable_hello(), script_);
        client.say(message);
    }

    void ask(WatchingClient& client) {
        v1::ClientMessage message;
        v1::Request& request = *message.mutable_request();
        const auto how = script_.take();
        const auto& kinds = *v1::Request::descriptor()->FindOneofByName("kind");
        if (const int kind = script_.take() % (kinds.field_count() + 1); kind < kinds.field_count()) {
            fill(*request.GetReflection()->MutableMessage(&request, kinds.field(kind)), script_);
        }
        if (request.has_create_world() && how / 64 != 3) {
            make_light(*request.mutable_create_world(), script_);
        }
        const std::string keys[] = {"k1", "k2", "k3", "", std::string(65, 'k')};
        request.set_client_key(keys[how % 8 % std::size(keys)]);
        request.set_request_id(how / 8 % 8 < 6 ? client.next_request_id() : script_.take() % 4);
        last_asked_ = codec::encode_frame(codec::Channel::Control, message);
        client.say(last_asked_);
    }

    void acknowledge(WatchingClient& client) {
        const auto which = script_.take();
        v1::ClientMessage message;
        if (const auto newest = client.newest_snapshot(which / 4)) {
            *message.mutable_acknowledge_snapshot() = *newest;
            if (which % 4 == 1) {
                message.mutable_acknowledge_snapshot()->set_sequence(newest->sequence() + 1);
            } else if (which % 4 == 2) {
                message.mutable_acknowledge_snapshot()->set_sequence(newest->sequence() - 1);
            }
        } else {
            fill(*message.mutable_acknowledge_snapshot(), script_);
        }
        client.say(message);
    }

    static std::string frame(const std::string& body) {
        const auto header = codec::encode_header(
            {.channel = codec::Channel::Control, .body_bytes = static_cast<std::uint32_t>(body.size())});
        return std::string{reinterpret_cast<const char*>(header.data()), header.size()} + body;
    }

    void end() {
        // Every client is served meanwhile. A frame that is cut off stays incomplete.
        constexpr int rounds_max = 1000;
        for (int round = 0;; ++round) {
            require(round < rounds_max);
            server_.poll();
            server_.pass();
            server_.poll();
            bool quiet = true;
            for (const auto& client : clients_) {
                client->send(SIZE_MAX);
                while (client->hear(SIZE_MAX)) {
                }
                quiet = quiet && (client->closed() || client->finished() || client->unsent_bytes() == 0) &&
                        is_through(*client);
            }
            if (quiet) {
                break;
            }
        }
        server_.compare_with_twins();
        clients_.clear();
        for (int round = 0; server_.connection_count() > 0; ++round) {
            require(round < rounds_max);
            server_.poll();
        }
    }

    bool is_through(const WatchingClient& client) const {
        if (client.closed()) {
            // No session is closed without a reason, and a half-closed client gets all answers.
            require(client.end_announced() || client.may_have_stalled() || server_.going_away() ||
                    (client.finished() && (client.refused() || client.all_answered())));
            return true;
        }
        if (client.end_announced() || server_.going_away() || client.refused() || client.finished()) {
            return false; // the end is still to come
        }
        return client.all_answered();
    }

    Script script_;
    WatchedServer server_;
    Answers answers_;
    std::vector<std::unique_ptr<WatchingClient>> clients_;
    std::string last_asked_;
};

} // namespace
} // namespace evod::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod;
    [[maybe_unused]] static const bool quiet = (log::begin(log::Level::Error, log::Format::Text), true);
    fuzz::clock() = support::ManualClock{};
    fuzz::clock().per_look = std::chrono::milliseconds{1};
    fuzz::Play{{data, size}}.run();
    return 0;
}
