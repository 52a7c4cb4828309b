// Checks for CLI11 of options that are numbers: an empty text, or what was given and what is allowed; CLI11 names the
// option. Its own takes "nan" for a number in any range; of whole numbers see wire::WholeNumber.
#pragma once

#include "client/link/exact.h"
#include "proto/wire/whole_number.h"

#include <charconv>
#include <string>

namespace evod::link {

using wire::WholeNumber;

struct RealNumber {
    double min, max;

    std::string operator()(const std::string& word) const {
        double number = 0;
        const char* const end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, number);
        const bool good = read.ec == std::errc{} && read.ptr == end && number >= min && number <= max;
        return good ? std::string{} : "must be a number, " + exact(min) + " to " + exact(max) + ", not " + word;
    }
};

} // namespace evod::link
