// Registry: the server's descriptions of its parameters. Also converts words of the command line into parameter values.
#pragma once

#include "client/core/change_text.h"
#include "evod/v1/commands.pb.h"

#include <boost/system/result.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace evod::ctl {

/// Errors in words of the command line, one line for each error.
struct Mistakes {
    std::vector<std::string> lines;
    void add(const Mistakes& more) { lines.insert(lines.end(), more.lines.begin(), more.lines.end()); }
};
[[noreturn]] void throw_exception_from_error(const Mistakes& mistakes, const boost::source_location& where);

template <class T>
using Checked = boost::system::result<T, Mistakes>;

class Registry {
  public:
    explicit Registry(const v1::Description& description)
        : parameters_{description.parameters().begin(), description.parameters().end()} {}

    const std::vector<v1::ParameterDescription>& parameters() const { return parameters_; }
    const v1::ParameterDescription* find(std::string_view name) const;
    std::vector<std::string> names() const;

    /// Returns the error for an unknown name: "mutation_chanse: unknown parameter; did you mean mutation_chance?"
    std::string unknown(std::string_view name) const;

    /// Parses words of the form name=value. Does not check ranges: the server checks them and reports all violations
    /// together.
    Checked<std::vector<v1::ParameterAssignment>> assignments(const std::vector<std::string>& words) const;

  private:
    std::vector<v1::ParameterDescription> parameters_;
};

/// Parses a value according to the kind of the parameter. A count may be written as 1e6. A flag is true, on, yes or 1,
/// or false, off, no or 0. A choice is given by its name.
Checked<v1::ParameterValue> parse_value(const v1::ParameterDescription& parameter, std::string_view word);

using core::to_text; // formats a value as a user types it
/// Returns the allowed values: "0 to 1", "true or false", "roulette, tournament".
std::string allowed(const v1::ParameterDescription& parameter);
/// Returns when a change of the parameter takes effect: "next tick", "next generation", "reset".
std::string effect_of(const v1::ParameterDescription& parameter);

} // namespace evod::ctl
