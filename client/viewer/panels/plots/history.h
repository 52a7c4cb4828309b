// History: collects the statistics of all finished generations of a run that the server still keeps, and the changes of
// its parameters, and updates them.
//
// Earlier generations are requested page by page. Events add each generation that ends. If generations may have been
// missed (dropped events, a broken connection, a hidden panel), they are requested again. Changes of parameters are
// requested when an event reports one. When another run begins, the history is cleared.
//
// Owner        PlotsPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/plots/history_table.h"
#include "client/viewer/panels/plots/layout.h"
#include "evod/v1/session.pb.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

class History {
  public:
    /// Sets the run; clears the history if the world or the run has changed.
    void set_run(const std::string& world, const std::string& run_id);
    void set_run(const evod::v1::WorldInfo& world);

    /// Processes an event. Ignores events of other worlds, except a report of dropped events.
    void apply_event(const evod::v1::Event& event);

    /// Records that all generations of this run up to `generation` have ended. A snapshot reports this number.
    void set_ended(std::uint64_t generation);

    /// Makes next_query() request the missing generations. Call when events may have been missed.
    void refresh() { missing_ = again_ = true; }

    struct Query {
        std::uint64_t number; // to be passed to receive()
        evod::v1::Request request;
    };
    /// Returns the query to send now; nullopt if nothing is missing or an answer is pending. After sending a query,
    /// call receive() or cancel() exactly once.
    std::optional<Query> next_query();

    /// Takes the answer to query `number`. Null: the query failed, and next_query() returns it again.
    void receive(std::uint64_t number, const evod::v1::History* answer);

    /// Returns whether a query is unanswered.
    bool pending() const { return asked_ != answered_; }
    /// Forgets the pending query. Its answer will be ignored.
    void cancel();

    /// Sets the names of the run's genes. Ignores an empty list.
    void set_gene_names(const std::vector<std::string>& names);

    const std::string& world() const { return world_; }
    const std::string& run_id() const { return run_id_; }
    /// Returns whether the table contains every generation that is known to have ended.
    bool complete() const { return !run_id_.empty() && !missing_; }
    const HistoryTable& table() const { return table_; }
    /// Returns the changes of parameters in the run, by generation.
    std::span<const Mark> changes() const { return changes_; }
    /// Returns a number that changes whenever the table changes.
    std::uint64_t revision() const { return revision_; }

  private:
    template <class Generations>
    void add(const Generations& generations);
    /// Replaces the changes from generation `first` on by those in a page that begins with this generation.
    void add_changes(std::uint64_t first, const evod::v1::History& page);

    std::string world_, run_id_;
    HistoryTable table_;
    std::vector<Mark> changes_;
    std::uint64_t changes_until_ = 0; // up to this generation, changes_ is complete
    std::uint64_t whole_until_ = 0; // up to this generation, the table contains every generation that the server keeps
    bool missing_ = true;
    bool again_ = false;                     // generations may have been missed since the last query
    std::uint64_t asked_ = 0, answered_ = 0; // numbers of the last queries sent and answered
    std::uint64_t ended_ = 0;                // the last generation that is known to have ended
    std::uint64_t ended_when_asked_ = 0;     // value of ended_ when the first page was requested
    std::optional<std::uint64_t> next_page_;
    std::uint64_t revision_ = 0;
};

} // namespace evod::viewer
