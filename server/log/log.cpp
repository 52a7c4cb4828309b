#include "server/log/log.h"

#include "proto/text/printable.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <ctime>
#include <memory>

namespace evod::log {
namespace {

std::atomic<Format> format_in_use = Format::Text;

spdlog::level::level_enum to_spdlog(Level level) {
    return static_cast<spdlog::level::level_enum>(level);
}
static_assert(static_cast<int>(Level::Trace) == static_cast<int>(spdlog::level::trace) &&
              static_cast<int>(Level::Error) == static_cast<int>(spdlog::level::err));

std::string json_text(std::string_view text) {
    std::string quoted = "\"";
    while (!text.empty()) {
        const std::size_t count = text::character_bytes(text);
        const auto first = static_cast<unsigned char>(text[0]);
        // U+0080 to U+009F also control terminals.
        const unsigned control = count == 1 && (first < 0x20 || first == 0x7f) ? first
                                 : count == 2 && first == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0
                                     ? static_cast<unsigned char>(text[1])
                                     : 0x100u;
        if (count == 0) {
            quoted += "\\ufffd";
        } else if (control < 0x100) {
            quoted += fmt::format("\\u{:04x}", control);
        } else if (first == '"' || first == '\\') {
            (quoted += '\\') += text[0];
        } else {
            quoted += text.substr(0, count);
        }
        text.remove_prefix(std::max<std::size_t>(count, 1));
    }
    return quoted + '"';
}

} // namespace

void begin(Level least, Format format) {
    format_in_use = format;
    const char* const no_color = std::getenv("NO_COLOR"); // https://no-color.org
    const bool may_color = format == Format::Text && (no_color == nullptr || *no_color == '\0');
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "", std::make_shared<spdlog::sinks::stderr_color_sink_mt>(may_color ? spdlog::color_mode::automatic
                                                                            : spdlog::color_mode::never)));
    spdlog::set_pattern(format == Format::Json ? "%v" : "%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
    set_level(least);
}

void set_level(Level least) {
    spdlog::set_level(to_spdlog(least));
    spdlog::flush_on(to_spdlog(least));
}

Level level_named(std::string_view name) {
    return static_cast<Level>(std::ranges::find(level_names, name) - level_names.begin());
}

bool wanted(Level level) {
    return spdlog::should_log(to_spdlog(level));
}

void write(Level level, const Fields& fields, std::string_view message) {
    const std::string line = format_in_use == Format::Json
                                 ? json_line(std::chrono::system_clock::now(), level, fields, message)
                                 : plain_line(message);
    spdlog::log(to_spdlog(level), "{}", line);
}

std::string json_line(std::chrono::system_clock::time_point time, Level level, const Fields& fields,
                      std::string_view message) {
    const auto whole = std::chrono::floor<std::chrono::seconds>(time);
    const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(time - whole).count();
    const std::time_t since_1970 = std::chrono::system_clock::to_time_t(whole);
    std::tm utc{};
    ::gmtime_r(&since_1970, &utc);
    std::string line = fmt::format(R"({{"time":"{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z","level":"{}","message":{})",
                                   utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                                   milliseconds, level_names[static_cast<std::size_t>(level)], json_text(message));
    if (fields.session) {
        line += fmt::format(R"(,"session":{})", *fields.session);
    }
    for (const auto& [name, value] :
         {std::pair{"client", &fields.client}, std::pair{"world", &fields.world}, std::pair{"code", &fields.code}}) {
        if (!value->empty()) {
            line += fmt::format(R"(,"{}":{})", name, json_text(*value));
        }
    }
    return line + '}';
}

std::string plain_line(std::string_view message) {
    std::string line{message};
    std::ranges::replace_if(
        line, [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; }, '?');
    return line;
}

} // namespace evod::log
