// The scenarios of proto/vectors/sessions.json, performed with ProtocolState. The file explains its steps.
#include "client/core/protocol_state.h"

#include <boost/json.hpp>
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

namespace evod::core {
namespace {

using namespace std::chrono_literals;
namespace json = boost::json;

json::array read_scenarios() {
    std::ifstream file{EVOD_SOURCE_FOLDER + std::string{"/proto/vectors/sessions.json"}};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    return json::parse(text).at("scenarios").as_array();
}

template <class Message>
Message message_of(const json::value& fields) {
    Message message;
    const auto status = google::protobuf::util::JsonStringToMessage(json::serialize(fields), &message);
    EXPECT_TRUE(status.ok()) << status.ToString();
    return message;
}

std::string text_of(const v1::Status& status) {
    return "refused " + v1::Code_Name(status.code()) +
           (status.reason() == 0 ? "" : " " + v1::Reason_Name(status.reason()));
}

std::string name_in(const json::value& value) {
    return std::string{value.as_string()};
}

/// A client and the server's end of its session.
class Player {
  public:
    explicit Player(const json::array& steps) {
        for (const json::value& step : steps) {
            if (const json::value* const name = step.as_object().if_contains("forget")) {
                forgotten_.insert(name_in(*name));
            }
        }
        perform();
    }

    void play(const json::value& step) {
        const auto& [key, value] = *step.as_object().begin();
        if (key == "open") {
            begin_session();
            v1::ServerMessage message;
            *message.mutable_welcome() = message_of<v1::Welcome>(value);
            message.mutable_welcome()->set_protocol_version(codec::protocol_version);
            receive(message);
        } else if (key == "refuse" || key == "goodbye") {
            if (key == "refuse") {
                begin_session();
            }
            v1::ServerMessage message;
            *message.mutable_goodbye()->mutable_status() = message_of<v1::Status>(value);
            receive(message);
        } else if (key == "lose") {
            protocol_.lost({.reason = "the connection was lost"}, now_);
        } else if (key == "request") {
            request(name_in(value.at("name")), message_of<v1::Request>(value.at("fields")));
        } else if (key == "forget") {
            now_ += short_timeout;
            protocol_.advance(now_);
        } else if (key == "subscribe") {
            const SubscriptionHandle handle{static_cast<std::uint32_t>(handles_.size() + 1)};
            handles_[name_in(value.at("name"))] = handle;
            protocol_.subscriptions().add(handle, message_of<v1::Request>(value.at("fields")));
        } else if (key == "unsubscribe") {
            protocol_.subscriptions().remove(handles_.at(name_in(value)));
        } else if (key == "set_view") {
            protocol_.subscriptions().set_view(handles_.at(name_in(value.at("name"))),
                                               message_of<v1::View>(value.at("view")));
        } else if (key == "sent") {
            expect_sent(value.as_array());
        } else if (key == "answer") {
            v1::ServerMessage message;
            *message.mutable_response() = message_of<v1::Response>(value.at("fields"));
            message.mutable_response()->set_request_id(ids_.at(name_in(value.at("name"))));
            receive(message);
        } else if (key == "results") {
            expect_results(value.as_object());
        } else if (key == "session") {
            EXPECT_EQ(session(), name_in(value));
        } else {
            ADD_FAILURE() << "unknown step " << key;
        }
        perform();
    }

  private:
    static constexpr std::chrono::milliseconds short_timeout = 10s;

    void perform() {
        output_ = protocol_.take_output();
        sent_ += output_.bytes;
        for (Outcome& outcome : output_.outcomes) {
            outcome.handler(std::move(outcome.result));
        }
    }

    void begin_session() {
        if (output_.status.state == State::Lost) {
            now_ = output_.wake_at;
            protocol_.advance(now_);
            perform();
        }
        ASSERT_TRUE(output_.connection_wanted);
        protocol_.opened(now_);
        perform();
        ASSERT_TRUE(read().has_hello());
    }

    void receive(const v1::ServerMessage& message) {
        const std::string frame = codec::encode_frame(codec::Channel::Control, message);
        protocol_.received(std::as_bytes(std::span{frame}), now_);
    }

    void request(const std::string& name, v1::Request request) {
        results_[name] = "waiting";
        const auto handler = [this, name](const Result<v1::Response>& result) {
            ASSERT_EQ(results_[name], "waiting") << "each handler is called once";
            results_[name] = result ? accepted(*result) ? "answered" : text_of(result->status())
                             : result.error().kind == Error::Kind::NoConnection ? "lost"
                                                                                : result.error().what;
        };
        protocol_.request(std::move(request), handler, forgotten_.contains(name) ? short_timeout : 100h, now_);
    }

    /// The next message that the client has sent; an empty one if there is none.
    v1::ClientMessage read() {
        reader_.feed(std::as_bytes(std::span{sent_}));
        sent_.clear();
        const auto frame = reader_.next().value();
        return frame ? codec::parse_body<v1::ClientMessage>(frame->body).value() : v1::ClientMessage{};
    }

    void expect_sent(const json::array& expected) {
        for (const json::value& one : expected) {
            v1::Request request = read().request();
            EXPECT_EQ(request.client_key(), "a key");
            const std::string name = name_in(one.at("name"));
            if (const auto known = ids_.find(name); known != ids_.end()) {
                EXPECT_EQ(request.request_id(), known->second) << name;
            } else {
                EXPECT_TRUE(std::ranges::none_of(ids_, [&](const auto& entry) {
                    return entry.second == request.request_id();
                })) << name;
                ids_[name] = request.request_id();
            }
            request.clear_request_id();
            request.clear_client_key();
            const auto wanted = message_of<v1::Request>(one.at("fields"));
            EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(request, wanted))
                << name << ": " << request.ShortDebugString();
        }
        const v1::ClientMessage more = read();
        EXPECT_FALSE(more.has_request()) << more.ShortDebugString();
    }

    void expect_results(const json::object& expected) {
        for (const auto& [key, result] : expected) {
            const std::string name{key};
            EXPECT_EQ(handles_.contains(name) ? subscription(handles_.at(name)) : results_.at(name), name_in(result))
                << name;
        }
    }

    std::string subscription(SubscriptionHandle handle) const {
        const auto answer = output_.answers.find(handle);
        return answer == output_.answers.end() ? "waiting"
               : accepted(answer->second)      ? "accepted"
                                               : text_of(answer->second.status());
    }

    std::string session() const {
        switch (output_.status.state) {
        case State::Connected:
            return "open";
        case State::Failed:
            return "gives up";
        default:
            return output_.wake_at - now_ < options_.backoff_max / 2 ? "retries soon" : "retries late";
        }
    }

    const Options options_{.reconnect = true};
    TimePoint now_{};
    ProtocolState protocol_{options_, "a key", 1, now_};
    ProtocolState::Output output_;
    std::string sent_;
    codec::FrameReader reader_{codec::server_limits};
    std::set<std::string> forgotten_;
    std::map<std::string, std::string> results_;
    std::map<std::string, std::uint64_t> ids_;
    std::map<std::string, SubscriptionHandle> handles_;
};

bool applies(const json::object& scenario) {
    const json::value* const only = scenario.if_contains("only");
    return only == nullptr || std::ranges::any_of(only->at("clients").as_array(),
                                                  [](const json::value& client) { return client == "cpp"; });
}

TEST(Sessions, EndAsInTheOtherClients) {
    const json::array scenarios = read_scenarios();
    EXPECT_FALSE(scenarios.empty());
    for (const json::value& scenario : scenarios) {
        if (!applies(scenario.as_object())) {
            continue;
        }
        SCOPED_TRACE(name_in(scenario.at("name")));
        const json::array& steps = scenario.at("steps").as_array();
        Player player{steps};
        for (std::size_t i = 0; i < steps.size() && !testing::Test::HasFatalFailure(); ++i) {
            SCOPED_TRACE("step " + std::to_string(i + 1));
            player.play(steps[i]);
        }
    }
}

} // namespace
} // namespace evod::core
