// Watch: the world and the island that are looked at, what is known of them, and the commands given to the world.
//
// All of it goes over one link::Connection, and nothing here waits: requests are sent, and update() takes in whatever
// has come since.
//
// Owner        the window, or the taking of one screenshot.
// Threads      used by the thread that draws; the connection has its own.
#pragma once

#include "client/link/connection.h"
#include "client/link/world_view.h"
#include "client/viewer/run_control.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace evod::viewer {

class Watch {
  public:
    struct Wanted {
        link::Options connection; // to where, as whom
        std::string world;        // empty: the server's choice
        std::uint32_t island = 0;
        double rate_hz = 30; // of pictures
    };

    explicit Watch(Wanted wanted);

    /// Takes in pictures, events and answers. True if there is a new picture.
    bool update(link::WorldView::Clock::time_point now);

    // Commands.
    void pause_or_resume();
    void step(std::uint64_t ticks);
    void faster() { send(control_.faster()); }
    void slower() { send(control_.slower()); }
    void real_time() { send(control_.real_time()); }
    void max_speed() { send(control_.max_speed()); }

    // For panels.
    using Answer = std::function<void(const link::Result<evod::v1::Response>&)>;
    /// Sends a request; the handler is called by an update(), or never if another world is looked at before. What
    /// it says of a refusal is its own affair.
    void ask(evod::v1::Request request, Answer handler);
    /// Events of all worlds since the update before the last, oldest first.
    const std::vector<evod::v1::Event>& events() const { return new_events_; }

    // What is looked at.
    void turn_islands(int by);
    /// What of the island is shown; nullopt, as at first and with each new place: everything, in whole pictures.
    void set_view(std::optional<evod::v1::View> view);
    void next_world();

    /// The organism that panels tell of and the camera may follow: an id of the generation that runs.
    void select(std::optional<std::uint32_t> organism) { selected_ = organism; }
    std::optional<std::uint32_t> selected() const { return selected_; }

    // What is known.
    link::WorldView& view() { return view_; }
    const wire::Picture* picture() const { return view_.latest().get(); }
    /// How many there are where on all of the island, now and then, while a view is set; else null.
    const wire::Picture* overview() const { return overview_picture_.get(); }
    const RunControl& control() const { return control_; }
    /// Of the generation before, on this island; null in the first.
    const evod::v1::GenerationStatistics* last_generation() const;
    const std::string& world() const { return wanted_.world; } // empty: the server's choice
    std::uint32_t island() const { return wanted_.island; }
    const link::Endpoint& server() const { return wanted_.connection.server; }
    /// Whether the server has answered everything, the questions of the beginning among it.
    bool all_answered() const { return connected_count_ > 0 && unanswered_.empty(); }
    link::ConnectionStatus connection_status() const { return connection_.status(); }
    /// Why the server shows no pictures: what it said to the subscription. Nullopt if it does, or has not answered.
    std::optional<std::string> refusal() const;
    /// How it stands with the server's disk; without a state if it keeps nothing, or the world shows the past.
    const evod::v1::Storage& storage() const { return storage_; }
    /// Sentences for a person, each told once: refused commands, a server that goes away, …
    std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

  private:
    struct Unanswered {
        bool is_command;
        Answer handler; // empty: of the commands and questions of the watch itself
        std::future<link::Result<evod::v1::Response>> response;
    };

    void subscribe();
    void subscribe_overview();
    void look_at(std::string world, std::uint32_t island);
    void send(std::optional<evod::v1::Request> request);
    void ask_state();
    bool is_over();
    void take_answers();
    void take_command_answer(const link::Result<evod::v1::Response>& response);
    void take_statistics(const evod::v1::Statistics& statistics);
    void take_worlds(const evod::v1::WorldList& worlds);
    void take_event(const evod::v1::Event& event);

    Wanted wanted_;
    link::Connection connection_;
    link::SubscriptionHandle pictures_, events_;
    std::optional<link::SubscriptionHandle> overview_;
    std::shared_ptr<const wire::Picture> overview_picture_;
    std::optional<evod::v1::View> pictures_view_;
    link::WorldView view_;
    RunControl control_;
    std::vector<evod::v1::GenerationStatistics> last_generation_; // one per island
    evod::v1::Storage storage_;
    std::vector<Unanswered> unanswered_;
    std::vector<evod::v1::Event> new_events_;
    std::optional<std::uint32_t> selected_;
    std::vector<std::string> notices_;
    std::uint64_t connected_count_ = 0;
};

} // namespace evod::viewer
