// Log: prints messages for the operator on standard output, either as sentences or as one JSON object per line.
//
//   log::info({.session = 3, .client = "anna"}, "session {}: {} connected", 3, "anna");
//
// Threads      any.
// Untrusted    this module sanitises text from clients: it cannot end a line or control a terminal.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace evod::log {

enum class Level { Trace, Debug, Info, Warn, Error };
constexpr std::array<const char*, 5> level_names{"trace", "debug", "info", "warn", "error"};
enum class Format { Text, Json };

/// The subject of a message; unknown fields are empty. The sentence also contains the subject.
struct Fields {
    std::optional<std::uint64_t> session = {};
    std::string client = {}, world = {}, code = {}; // empty: unknown
};

/// Sets the level and format of all later messages. Before the first call, messages are text from Level::Info on.
void begin(Level least, Format format);
Level level_named(std::string_view name); // name: one of level_names

bool wanted(Level level);
void write(Level level, const Fields& fields, std::string_view message);

/// Formats {"time":"2025-01-31T23:59:59.123Z","level":"info","message":"…","session":3,…}. The time is in UTC. Unknown
/// fields are omitted. Invalid UTF-8 becomes U+FFFD.
std::string json_line(std::chrono::system_clock::time_point time, Level level, const Fields& fields,
                      std::string_view message);
/// Replaces control characters, except line ends, by '?'.
std::string plain_line(std::string_view message);

template <Level level>
struct Says {
    template <class... Arguments>
    void operator()(const Fields& fields, fmt::format_string<Arguments...> text, Arguments&&... arguments) const {
        if (wanted(level)) {
            write(level, fields, fmt::format(text, std::forward<Arguments>(arguments)...));
        }
    }
    template <class... Arguments>
    void operator()(fmt::format_string<Arguments...> text, Arguments&&... arguments) const {
        (*this)(Fields{}, text, std::forward<Arguments>(arguments)...);
    }
};
inline constexpr Says<Level::Trace> trace;
inline constexpr Says<Level::Debug> debug;
inline constexpr Says<Level::Info> info;
inline constexpr Says<Level::Warn> warn;
inline constexpr Says<Level::Error> error;

} // namespace evod::log
