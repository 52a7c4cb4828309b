// History: the statistics of a world's run, from its first generation that the server still knows to the last that has
// ended, kept up to date.
//
// The past is asked for page by page, what ends from then on is told by events. Whatever may have been missed (events
// were dropped, the line broke, nobody listened) is asked for; another run begins anew.
//
// Threads      none.
#pragma once

#include "client/viewer/panels/plots/history_table.h"
#include "evod/v1/session.pb.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class History {
  public:
    /// Whose history it is; another world or run than before begins anew.
    void see_run(const std::string& world, const std::string& run_id);
    void see_run(const evod::v1::WorldInfo& world);

    /// Of any world; those of others are passed over.
    void see_event(const evod::v1::Event& event);

    /// So many generations of this run have ended, as pictures tell.
    void see_ended(std::uint64_t generation);

    /// Events may have been missed.
    void poll_interval() { missing_ = again_ = true; }

    struct Question {
        std::uint64_t number; // for take()
        evod::v1::Request request;
    };
    /// What is to be asked now; nullopt: nothing, or a question is unanswered. Each is followed by one take(), or by
    /// give_up().
    std::optional<Question> question();

    /// The answer to a question, or null if there was none or a refusal: then it will be asked again.
    void take(std::uint64_t number, const evod::v1::History* answer);

    /// Whether a question is unanswered.
    bool waits() const { return asked_ != answered_; }
    /// There will be no answer.
    void give_up();

    /// Of the run; none: nothing is told.
    void set_gene_names(const std::vector<std::string>& names);

    const std::string& world() const { return world_; }
    const std::string& run_id() const { return run_id_; }
    /// Whether all that is known to have ended is here.
    bool complete() const { return !run_id_.empty() && !missing_; }
    const HistoryTable& table() const { return table_; }
    /// Changes whenever the table does.
    std::uint64_t revision() const { return revision_; }

  private:
    template <class Generations>
    void add(const Generations& generations);

    std::string world_, run_id_;
    HistoryTable table_;
    std::uint64_t whole_until_ = 0; // up to this generation all is here that the server knows
    bool missing_ = true;
    bool again_ = false;                     // something was missed since the last question
    std::uint64_t asked_ = 0, answered_ = 0; // numbers of questions
    std::uint64_t ended_ = 0;                // the last generation that is known to have ended
    std::uint64_t ended_when_asked_ = 0;     // the same when the first page was asked for
    std::optional<std::uint64_t> next_page_;
    std::uint64_t revision_ = 0;
};

} // namespace evod::viewer
