// ParameterEdits: the parameters of a world, what a person is changing of them, and the transactions that come of it.
//
// All of it is made from what the server says, the registry and the set: a parameter that is added there appears here.
// Edits are collected, and sent as one SetParameters that holds whole or not at all; it names the revision that the
// person saw, so that nobody's change in between is lost. What was sent can be undone, with a transaction of its own.
//
// Owner        the panel that draws it, or a test.
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

/// A real or a count as a number, and back: a count is rounded, and put within what can be told of it. The range is not
/// looked at: the server says what is wrong with a value.
double number_of(const evod::v1::ParameterValue& value);
evod::v1::ParameterValue value_of(const evod::v1::ParameterDescription& parameter, double number);

/// Whether a slider over the range is of use only if every tenfold takes the same room.
bool spans_decades(const evod::v1::ParameterDescription& parameter);

/// "0.01 to 1", "roulette, tournament", "on or off".
std::string allowed_text(const evod::v1::ParameterDescription& parameter);

/// Whether every word of `search` is in its name, unit or help; case does not matter, _ is a space.
bool matches(const evod::v1::ParameterDescription& parameter, std::string_view search);

/// A stretch of the registry under one heading.
struct ParameterGroup {
    std::string_view title;
    std::size_t first, end; // indices
};

/// The registry in its order, cut where a topic begins. A parameter that is new to this program belongs to the topic
/// that the server has put it in.
std::vector<ParameterGroup> group(std::span<const evod::v1::ParameterDescription> registry);

class ParameterEdits {
  public:
    // What the server says.

    /// The registry; another one forgets everything.
    void describe(std::vector<evod::v1::ParameterDescription> registry);
    /// Another world, or another run: all but the registry is forgotten.
    void forget();
    /// The complete set.
    void see(const evod::v1::ParameterSet& set);
    /// Somebody's change, perhaps one's own.
    /// returns  false if changes before it were missed, and the set has to be asked for.
    bool see(const evod::v1::ParametersChanged& changed);

    bool known() const { return !registry_.empty() && revision_ > 0; }
    const std::vector<evod::v1::ParameterDescription>& registry() const { return registry_; }
    std::uint64_t revision() const { return revision_; }
    /// Whether something waits for a generation or a reset.
    bool has_pending() const;

    // One parameter, by index in the registry.

    const evod::v1::ParameterValue& holds(std::size_t i) const { return states_[i].value; }
    /// What will hold in the end, as far as the server knows.
    const evod::v1::ParameterValue& asked_for(std::size_t i) const;
    /// That, or what it is being changed to.
    const evod::v1::ParameterValue& shown(std::size_t i) const;
    bool is_pending(std::size_t i) const { return states_[i].pending.has_value(); }
    bool is_edited(std::size_t i) const { return states_[i].edit.has_value(); }
    /// Who else changed it last; empty: nobody has since it was seen or set here.
    const std::string& changed_by(std::size_t i) const { return states_[i].changed_by; }
    /// What the server found wrong with the value last sent; null if nothing.
    const evod::v1::Violation* violation(std::size_t i) const;

    // Editing.

    // Each of these takes away what is told of the last refusal: that was about other values.

    /// The value that is asked for already is no edit.
    void edit(std::size_t i, evod::v1::ParameterValue value);
    void revert(std::size_t i);
    void revert_all();
    std::size_t edit_count() const;

    // Transactions, one at a time. Every request that is returned must be followed by one answered().

    bool busy() const { return !sent_.changes.empty(); }
    /// All edits as one. Nullopt without any, and while another is under way.
    std::optional<evod::v1::Request> apply(const std::string& world);
    /// The former values of the last transaction that was not undone; what others have changed since is left to them.
    std::optional<evod::v1::Request> undo(const std::string& world);
    std::optional<evod::v1::Request> redo(const std::string& world);
    bool can_undo() const { return !busy() && !done_.empty(); }
    bool can_redo() const { return !busy() && !undone_.empty(); }

    /// response  null: nobody knows whether it was done
    /// returns   whether the set has to be asked for.
    bool answered(const evod::v1::Response* response);

    /// Why the last transaction was refused, as far as no parameter's violation() tells; empty if it was not.
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
    std::vector<State> states_;                             // as the registry
    std::uint64_t revision_ = 0;                            // 0: no set has been seen
    Transaction sent_;
    std::vector<std::vector<Change>> done_, undone_; // the last is the newest
    std::string problem_;
};

} // namespace evod::viewer
