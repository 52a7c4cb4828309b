#include "client/viewer/text/numbers.h"

#include "proto/text/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace evod::viewer {

std::string print(const char* format, ...) {
    std::va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    std::string text(static_cast<std::size_t>(std::max(std::vsnprintf(nullptr, 0, format, arguments), 0)), '\0');
    std::vsnprintf(text.data(), text.size() + 1, format, again);
    va_end(again);
    va_end(arguments);
    return text;
}

std::string with_separators(std::uint64_t number) {
    return with_separators(std::to_string(number));
}

std::string with_separators(std::string printed) {
    const bool negative = printed.starts_with('-');
    const std::size_t begin = negative ? 1 : 0;
    const std::size_t end = std::min(printed.find_first_not_of("0123456789", begin), printed.size());
    for (std::size_t at = end; at > begin + 3; at -= 3) {
        printed.insert(at - 3, ",");
    }
    return negative ? "−" + printed.substr(1) : printed;
}

std::string shown_number(double number) {
    if (!std::isfinite(number)) {
        return "–";
    }
    const double size = std::abs(number);
    if (size != 0 && (size >= 1e12 || size < 1e-4)) {
        return with_separators(print("%.6g", number));
    }
    const int digits = size >= 1 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 1;
    std::string text = print("%.*f", std::max(0, 6 - digits), number);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') {
            text.pop_back();
        }
    }
    return with_separators(text == "-0" ? "0" : std::move(text));
}

std::string three_digits(double number) {
    const double size = std::abs(number);
    if (!std::isfinite(number) || size >= 1e12) {
        return shown_number(number);
    }
    return with_separators(print(size >= 999.5 ? "%.0f" : "%.3g", number));
}

std::string shown_fitness(double fitness) {
    return std::isfinite(fitness) ? with_separators(text::fitness_text(fitness)) : "–";
}

std::string shown_tenths(double number) {
    return print("%.1f", number);
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional{number} : std::nullopt;
}

std::optional<std::uint64_t> number_in(std::string_view field, std::string_view text, std::uint64_t least,
                                       std::uint64_t most, std::string& problem) {
    const auto number = whole_number(text);
    if (number && *number >= least && *number <= most) {
        problem.clear();
        return number;
    }
    problem = std::string{field} + ": got \"" + std::string{text} + "\", allowed whole numbers from " +
              with_separators(least) + " to " + with_separators(most);
    return std::nullopt;
}

double nice_step(double least) {
    if (!(least > 0)) {
        return 1;
    }
    const double ten = std::pow(10, std::floor(std::log10(least) + 1e-9));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (least <= factor * ten * (1 + 1e-9)) {
            return factor * ten;
        }
    }
    return 10 * ten;
}

} // namespace evod::viewer
