// Log: prints messages for the operator on standard error, either as sentences or as one JSON object per line.
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

/// What a message is about, as separate fields of a JSON line. The message itself must also contain this information.
struct Fields {
    std::optional<std::uint64_t> session = {};
    std::string client = {}, world = {}, code = {}; // empty: unknown
};

/// Sets the least severe level that is logged, and the format. Before the first call they are Level::Info and
/// Format::Text.
void begin(Level least, Format format);
/// Changes the least severe level that is logged. May be called on any thread, at any time after begin().
void set_level(Level least);
Level level_named(std::string_view name); // name: one of level_names

bool wanted(Level level);
void write(Level level, const Fields& fields, std::string_view message);

/// Formats {"time":"2025-01-31T23:59:59.123Z","level":"info","message":"…","session":3,…}. The time is in UTC. Unknown
/// fields are omitted. Invalid UTF-8 becomes U+FFFD.
std::string json_line(std::chrono::system_clock::time_point time, Level level, const Fields& fields,
                      std::string_view message);
/// Replaces control characters, except line ends, with '?'.
std::string plain_line(std::string_view message);

/// A function object that formats and writes a message.
template <Level level>
struct LogFunction {
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
inline constexpr LogFunction<Level::Trace> trace;
inline constexpr LogFunction<Level::Debug> debug;
inline constexpr LogFunction<Level::Info> info;
inline constexpr LogFunction<Level::Warn> warn;
inline constexpr LogFunction<Level::Error> error;

} // namespace evod::log
