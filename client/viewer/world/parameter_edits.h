// ParameterEdits: the parameters of a world, the edits to them that are not sent yet, and transactions with undo.
//
// Everything follows the server's registry and parameter set: a parameter that the server adds appears here. Edits are
// collected and sent as one SetParameters, which the server applies as a whole or not at all. The request contains the
// revision that the edits are based on, so the server refuses it if another client has changed a parameter since. A
// transaction is undone by another transaction.
//
// Owner        the parameters panel.
// Threads      none.
#pragma once

#include "evod/v1/session.pb.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

bool same(const evod::v1::ParameterValue& a, const evod::v1::ParameterValue& b);

/// "0.15", "25", "on", "roulette".
std::string to_text(const evod::v1::ParameterValue& value);

/// A real or a count as a number, and back. A count is rounded and clamped to 32 bits. The range of the parameter is not
/// checked: the server reports a value out of range.
double number_of(const evod::v1::ParameterValue& value);
evod::v1::ParameterValue value_of(const evod::v1::ParameterDescription& parameter, double number);

/// Whether a slider over the range needs a logarithmic scale.
bool spans_decades(const evod::v1::ParameterDescription& parameter);

/// "0.01 to 1", "roulette, tournament", "on or off".
std::string allowed_text(const evod::v1::ParameterDescription& parameter);

/// Whether every word of `search` is in its name, unit or help; case does not matter, _ is a space.
bool matches(const evod::v1::ParameterDescription& parameter, std::string_view search);

/// A part of the registry under one heading.
struct ParameterGroup {
    std::string_view title;
    std::size_t first, end; // indices
};

/// Groups the registry by topic, in its order. A parameter that this program does not know belongs to the topic of the
/// parameter before it.
std::vector<ParameterGroup> group(std::span<const evod::v1::ParameterDescription> registry);

class ParameterEdits {
  public:
    // What the server reports.

    /// Sets the registry, and forgets everything else.
    void describe(std::vector<evod::v1::ParameterDescription> registry);
    /// Forgets everything but the registry: another world or run is shown.
    void forget();
    /// Takes in the complete set.
    void update(const evod::v1::ParameterSet& set);
    /// Takes in a change, by this or another client.
    /// returns  false if an earlier change was missed, and the complete set has to be requested.
    bool update(const evod::v1::ParametersChanged& changed);

    bool known() const { return !registry_.empty() && revision_ > 0; }
    const std::vector<evod::v1::ParameterDescription>& registry() const { return registry_; }
    std::uint64_t revision() const { return revision_; }
    /// Whether a change waits for the next generation or a reset.
    bool has_pending() const;

    // One parameter, by index in the registry.

    const evod::v1::ParameterValue& holds(std::size_t i) const { return states_[i].value; }
    /// The pending value, or else the current one.
    const evod::v1::ParameterValue& asked_for(std::size_t i) const;
    /// The edited value, or else asked_for().
    const evod::v1::ParameterValue& shown(std::size_t i) const;
    bool is_pending(std::size_t i) const { return states_[i].pending.has_value(); }
    bool is_edited(std::size_t i) const { return states_[i].edit.has_value(); }
    /// The client that changed it last; empty: no other client has since it was received or set here.
    const std::string& changed_by(std::size_t i) const { return states_[i].changed_by; }
    /// Why the server refused the value sent last; null if it did not.
    const evod::v1::Violation* violation(std::size_t i) const;

    // Editing. Each of these clears the violations and the problem of the last refusal, which was about other values.

    /// A value equal to asked_for() is not an edit.
    void edit(std::size_t i, evod::v1::ParameterValue value);
    void revert(std::size_t i);
    void revert_all();
    std::size_t edit_count() const;

    // Transactions, one at a time. The caller sends each request that is returned, and calls answered() once for it.

    bool busy() const { return !sent_.changes.empty(); }
    /// Sends all edits. Nullopt without an edit, and while a transaction is under way.
    std::optional<evod::v1::Request> apply(const std::string& world);
    /// Restores the values before the last transaction that was not undone, except those that others changed since.
    std::optional<evod::v1::Request> undo(const std::string& world);
    std::optional<evod::v1::Request> redo(const std::string& world);
    bool can_undo() const { return !busy() && !done_.empty(); }
    bool can_redo() const { return !busy() && !undone_.empty(); }

    /// response  null: no answer; the outcome is unknown
    /// returns   whether the complete set has to be requested.
    bool answered(const evod::v1::Response* response);

    /// Why the last transaction was refused, as far as no parameter's violation() says so; empty if it was not.
    const std::string& problem() const { return problem_; }

  private:
    struct State {
        evod::v1::ParameterValue value;
        std::optional<evod::v1::ParameterValue> pending, edit;
        std::string changed_by;
        std::optional<evod::v1::Violation> violation;
    };
    struct Change {
        std::size_t parameter;
        evod::v1::ParameterValue before, after;
    };
    enum class Kind { Apply, Undo, Redo };
    struct Transaction {
        Kind kind = Kind::Apply;
        std::vector<Change> changes;
    };

    void forget_refusal();
    std::optional<evod::v1::Request> send(const std::string& world, Kind kind, std::vector<Change> changes);
    std::optional<evod::v1::Request> send_back(const std::string& world, Kind kind,
                                               std::vector<std::vector<Change>>& from);
    void take(const evod::v1::ParameterState& state);
    void take_done();
    void take_refusal(const evod::v1::Status& status);

    std::vector<evod::v1::ParameterDescription> registry_;
    std::map<std::string, std::size_t, std::less<>> index_; // by name
    std::vector<State> states_;                             // in the order of the registry
    std::uint64_t revision_ = 0;                            // 0: no set was received
    Transaction sent_;
    std::vector<std::vector<Change>> done_, undone_; // the newest at the end
    std::string problem_;
};

} // namespace evod::viewer
