// Watch: the world and the island, or all of its islands, that are looked at, what is known of them, and the commands
// given to the world.
//
// All of it goes over one core::Connection, and nothing here waits: requests are sent, and update() takes in whatever
// has come since.
//
// Owner        the window, or the taking of one screenshot.
// Threads      used by the thread that draws; the connection has its own.
#pragma once

#include "client/core/connection.h"
#include "client/core/world_view.h"
#include "client/viewer/watch/past.h"
#include "client/viewer/watch/run_control.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::viewer {

class Watch {
  public:
    struct Wanted {
        core::Options connection; // to where, as whom
        std::string world;        // empty: the server's choice
        std::uint32_t island = 0;
        double rate_hz = 30;                               // of pictures
        bool all_islands = false;                          // or only `island`
        std::optional<std::uint64_t> past_generation = {}; // begin in the past of the world, with this generation
    };

    explicit Watch(Wanted wanted);

    /// Takes in pictures, events and answers. True if there is a new picture.
    bool update(core::WorldView::Clock::time_point now);

    // Commands. Who may not give them sends nothing, and is told why by a notice.
    void pause_or_resume();
    void step(std::uint64_t ticks);
    void faster();
    void slower();
    void real_time();
    void max_speed();
    void at_factor(double factor);
    void run_generations(std::uint64_t generations);
    void reset(std::optional<std::uint64_t> seed);
    /// Whether this session may run what it looks at; as long as nobody has said no, it may. Its own look at the past
    /// everybody may.
    bool may_command() const { return role_ != evod::v1::ROLE_VIEWER || opened_past(); }
    /// Why not, in a sentence without a full stop; empty if it may.
    std::string_view why_only_watching() const;
    /// Whether it may make worlds.
    bool may_create() const { return role_ == evod::v1::ROLE_ADMIN || role_ == evod::v1::ROLE_UNSPECIFIED; }

    // For panels.
    using Answer = std::function<void(const core::Result<evod::v1::Response>&)>;
    /// Sends a request; the handler is called by an update(), or never if another world is looked at before. What
    /// it says of a refusal is its own affair.
    void ask(evod::v1::Request request, Answer handler);
    /// Events of all worlds since the update before the last, oldest first.
    const std::vector<evod::v1::Event>& events() const { return new_events_; }

    // What is looked at.
    void turn_islands(int by);
    /// What of the island is shown; nullopt, as at first and with each new place: everything, in whole pictures.
    void set_view(std::optional<evod::v1::View> view);
    void choose_island(std::uint32_t island);
    /// Pictures of every island, and not only of the one that is chosen.
    void show_all_islands(bool all);
    void next_world();
    /// Asks the server which world comes after this one. The handler is called by an update() with its name; if there
    /// is none, a notice says what to do instead.
    void find_next_world(std::function<void(const std::string& world)> found);
    void look_at(std::string world, std::uint32_t island);
    /// Another number, which no other watch has, whenever something else is looked at: another world, its past or its
    /// present again, another island. What was asked about a place says nothing of the next.
    std::uint64_t place_number() const { return place_number_; }

    /// The organism that panels tell of and the camera may follow: an id of the generation that runs.
    void select(std::optional<std::uint32_t> organism) { selected_ = organism; }
    std::optional<std::uint32_t> selected() const { return selected_; }

    // The past of the world that is looked at, beside it: a world of its own, which this session opens and closes.
    void open_replay(evod::v1::RunMoment at);
    void return_to_present();
    /// To another moment of a world that shows the past. Of several asked for in quick succession the newest counts.
    void seek(evod::v1::RunMoment to);
    /// To the first moment of a generation so many after the one that is shown, or was last asked for.
    void turn_generations(int by);
    /// What there is to be seen, if the world shows the past: this watch's own look at it, or a run file's.
    const evod::v1::Replay* replay() const { return replay_ ? &*replay_ : nullptr; }
    /// Whether the past is one that return_to_present() leaves.
    bool opened_past() const { return present_.has_value(); }
    /// Whether a replay shows the last of its recording, and can only go back. A past goes on as its world does.
    bool at_the_end() const;
    /// The world that return_to_present() leads to; nullopt: no past was opened.
    const std::optional<std::string>& present() const { return present_; }
    /// Where a seek is going to; null if none is under way.
    const evod::v1::RunMoment* sought() const { return seeks_.target(); }

    /// A new world from the moment that is shown.
    void fork(const std::string& name);
    /// The newest fork made of what is shown, of its past or of its present; empty: none that is still there.
    const std::string& forked() const { return forked_; }

    // What is known.
    core::WorldView& view() { return views_[wanted_.island]; }
    core::WorldView& view_of(std::uint32_t island) { return views_[island]; }
    const codec::DecodedSnapshot* picture() const { return picture_of(wanted_.island); }
    const codec::DecodedSnapshot* picture_of(std::uint32_t island) const;
    bool all_islands() const { return wanted_.all_islands; }
    /// 1 before the first picture.
    std::uint32_t island_count() const;
    /// How many there are where on all of the island, now and then, while a view is set; else null.
    const std::shared_ptr<const codec::DecodedSnapshot>& overview() const { return overview_picture_; }
    const RunControl& control() const { return control_; }
    /// Of the run that is shown, in the order of genes everywhere; empty while nobody has told.
    const std::vector<std::string>& gene_names() const { return gene_names_; }
    /// Of the generation before, on this island; null in the first.
    const evod::v1::GenerationStatistics* last_generation() const;
    const std::string& world() const { return wanted_.world; } // empty: the server's choice
    /// The same, by its name as soon as that is known.
    const std::string& name() const { return control_.known() ? control_.world() : wanted_.world; }
    std::uint32_t island() const { return wanted_.island; }
    const core::Endpoint& server() const { return wanted_.connection.server; }
    /// Whether the server has answered everything, the questions of the beginning among it.
    bool all_answered() const { return connected_count_ > 0 && unanswered_.empty() && !opening_.valid(); }
    core::ConnectionStatus connection_status() const { return connection_.status(); }
    bool connected() const { return connection_status().state == core::State::Connected; }
    /// Why it is not, in a sentence; empty if nobody knows yet.
    std::string no_connection() const;
    /// How the world that is shown stands: "running", "waiting – Space runs", "at the end of the recording", "no
    /// connection".
    std::string state_words() const;
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
        std::future<core::Result<evod::v1::Response>> response;
    };

    void subscribe();
    void subscribe_overview();
    void send(std::optional<evod::v1::Request> request);
    bool is_allowed();
    template <class Wish>
    void command(Wish wish);
    void ask_state();
    void see(const evod::v1::WorldInfo& world);
    void send_seek(std::optional<evod::v1::RunMoment> to);
    void take_opened();
    void close_replay(const std::string& world);
    bool is_over();
    void take_answers();
    void take_command_answer(const core::Result<evod::v1::Response>& response);
    void take_statistics(const evod::v1::Statistics& statistics);
    std::optional<std::string> world_after_this(const evod::v1::WorldList& worlds);
    void take_event(const evod::v1::Event& event);

    Wanted wanted_;
    core::Connection connection_;
    core::SubscriptionHandle pictures_, events_;
    std::optional<core::SubscriptionHandle> overview_;
    std::shared_ptr<const codec::DecodedSnapshot> overview_picture_;
    std::optional<evod::v1::View> pictures_view_;
    std::map<std::uint32_t, core::WorldView> views_; // by island
    RunControl control_;
    std::vector<std::string> gene_names_;
    std::uint64_t place_number_;
    std::vector<evod::v1::GenerationStatistics> last_generation_; // one per island
    evod::v1::Storage storage_;
    std::vector<Unanswered> unanswered_;
    bool next_world_wanted_ = false; // once it is connected
    std::vector<evod::v1::Event> new_events_;
    std::optional<std::uint32_t> selected_;
    std::vector<std::string> notices_;
    std::uint64_t connected_count_ = 0;
    evod::v1::Role role_ = evod::v1::ROLE_UNSPECIFIED; // that the server has given us

    // The past.
    std::optional<evod::v1::Replay> replay_;
    Seeks seeks_;
    std::optional<std::string> present_;                    // the origin, while a past that was opened here is shown
    core::SubscriptionHandle past_events_;                  // of that past, which the events of all worlds leave out
    std::future<core::Result<evod::v1::Response>> opening_; // answers an OpenReplay
    std::string opening_of_;                                // what was looked at then
    std::optional<std::string> past_refusal_;               // of the past that was wanted from the beginning
    core::WorldView::Clock::time_point asked_{};            // how far the past reaches
    std::string forked_;
};

} // namespace evod::viewer
