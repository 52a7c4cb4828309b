// ParameterEdits: the parameters of a world, and the edits that have not been sent.
//
// All parameters come from the server's registry, so a parameter that is added to the server appears here. Edits are
// collected and sent as one SetParameters request; the server applies all of them or none. The request contains the
// revision on which the edits are based. If another client has changed a parameter since, the server therefore rejects
// the request.
//
// Owner        the parameters panel.
// Threads      none.
#pragma once

#include "evod/v1/session.pb.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

bool same(const evod::v1::ParameterValue& a, const evod::v1::ParameterValue& b);

/// Returns the value as text: "0.15", "25", "on", "roulette".
std::string to_text(const evod::v1::ParameterValue& value);

/// Converts a real or a count to a number, and a number to a real or a count. A count is rounded and clamped to 32
/// bits. The parameter's range is not checked here: the server rejects a value out of range.
double number_of(const evod::v1::ParameterValue& value);
evod::v1::ParameterValue value_of(const evod::v1::ParameterDescription& parameter, double number);

/// Returns whether the range is so large that its slider needs a logarithmic scale.
bool spans_decades(const evod::v1::ParameterDescription& parameter);

/// Returns the allowed values as text: "0.01 to 1", "roulette, tournament", "on or off".
std::string allowed_text(const evod::v1::ParameterDescription& parameter);

/// Returns the name for people, without the unit at its end: "Mutation chance", "Tick" for tick_s.
std::string label_of(const evod::v1::ParameterDescription& parameter);
/// Returns the name of a choice for people: "stochastic universal".
std::string label_of_choice(std::string_view choice);
/// Returns the unit after a number, with a space before it: " px", " island" after 1, " islands" after 2. Empty if
/// there is no unit, or if it is too long for a field.
std::string unit_text(const evod::v1::ParameterDescription& parameter, double number);

/// Returns whether the parameter or the title of its group contains every word of `search`: in the name, the unit, the
/// help, the choices or their help. Case is ignored; _ counts as a space.
bool matches(const evod::v1::ParameterDescription& parameter, std::string_view group, std::string_view search);

/// Parameters that are shown under one heading.
struct ParameterGroup {
    std::string title;
    std::vector<std::size_t> members; // parameter indices
};

/// Returns the parameters that users change most often, in the order of the registry.
ParameterGroup most_used(std::span<const evod::v1::ParameterDescription> registry);

/// Groups the registry by topic, in the order of the registry.
std::vector<ParameterGroup> group(std::span<const evod::v1::ParameterDescription> registry);

class ParameterEdits {
  public:
    // The following functions store and return data reported by the server.

    /// Sets the registry and clears everything else.
    void describe(std::vector<evod::v1::ParameterDescription> registry);
    /// Clears everything except the registry. Call when another world or run is shown.
    void forget();
    /// Stores a complete parameter set.
    void update(const evod::v1::ParameterSet& set);
    /// Stores a change by this or another client.
    ///
    /// returns  false if an earlier change was missed; the caller must then request the complete set.
    bool update(const evod::v1::ParametersChanged& changed);

    bool known() const { return !registry_.empty() && revision_ > 0; }
    const std::vector<evod::v1::ParameterDescription>& registry() const { return registry_; }
    std::uint64_t revision() const { return revision_; }

    // The following functions return data of one parameter; `i` is its index in the registry.

    const evod::v1::ParameterValue& current_value(std::size_t i) const { return states_[i].value; }
    /// Returns the pending value; if there is none, the current value.
    const evod::v1::ParameterValue& requested_value(std::size_t i) const;
    /// Returns the edited value; if there is none, requested_value().
    const evod::v1::ParameterValue& shown(std::size_t i) const;
    bool is_pending(std::size_t i) const { return states_[i].pending.has_value(); }
    bool is_edited(std::size_t i) const { return states_[i].edit.has_value(); }
    /// Returns the client that last changed this parameter. Empty if no other client has changed it since the value was
    /// received or set here.
    const std::string& client_of_last_change(std::size_t i) const { return states_[i].client_of_last_change; }
    /// Returns why the server rejected the value that was sent last; null if the server accepted it.
    const evod::v1::Violation* violation(std::size_t i) const;

    // The following functions edit values. Each of them clears the violations and the problem of the last refusal,
    // because they are about earlier values.

    /// Edits a value. A value equal to requested_value() removes the edit.
    void edit(std::size_t i, evod::v1::ParameterValue value);
    void revert_all();
    std::size_t edit_count() const;

    bool busy() const { return !sent_.empty(); }
    /// Returns the request that sends all edits. The caller must send it and call answered() exactly once for it.
    /// Returns nullopt if there is no edit or a request is pending.
    std::optional<evod::v1::Request> apply(const std::string& world);
    /// response  the server's answer to the pending request; null: no answer arrived
    /// returns   whether the caller must request the complete set.
    bool answered(const evod::v1::Response* response);

    /// Returns why the last request was refused; empty if it was accepted. A reason that concerns one parameter is
    /// in violation().
    const std::string& problem() const { return problem_; }

  private:
    struct State {
        evod::v1::ParameterValue value;
        std::optional<evod::v1::ParameterValue> pending, edit;
        std::string client_of_last_change;
        std::optional<evod::v1::Violation> violation;
    };
    struct Sent {
        std::size_t parameter;
        evod::v1::ParameterValue value;
    };

    std::optional<std::size_t> index_of(std::string_view name) const;
    void forget_refusal();
    void take(const evod::v1::ParameterState& state);
    void take_refusal(const evod::v1::Status& status);

    std::vector<evod::v1::ParameterDescription> registry_;
    std::vector<State> states_;  // one per parameter, in the order of the registry
    std::uint64_t revision_ = 0; // 0: no set has been received
    std::vector<Sent> sent_;     // the values in the pending request
    std::string problem_;
};

/// Returns whether any change takes effect only in the next generation or at a reset.
bool has_pending(const ParameterEdits& edits);

} // namespace evod::viewer
