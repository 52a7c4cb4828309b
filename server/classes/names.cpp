#include "server/classes/names.h"

#include "proto/text/printable.h"
#include "server/classes/class.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <vector>

namespace evod::classes {
namespace {

// Words that a child may carry before the class: no judgement, no colour of skin, no animal that is an insult in
// English or German.
constexpr std::array<std::string_view, words_of_a_kind> adjectives = {
    "red",    "blue",   "green", "golden", "silver", "orange", "violet", "amber",  "coral",  "copper", "indigo",
    "pearl",  "ruby",   "jade",  "mint",   "royal",  "sunny",  "windy",  "snowy",  "misty",  "starry", "lunar",
    "solar",  "polar",  "brave", "bright", "calm",   "clever", "cosmic", "daring", "eager",  "early",  "fair",
    "famous", "fast",   "fine",  "fresh",  "gentle", "glad",   "grand",  "happy",  "honest", "jolly",  "keen",
    "kind",   "lively", "lucky", "magic",  "merry",  "mighty", "modern", "noble",  "proud",  "quick",  "quiet",
    "rapid",  "ready",  "smart", "smooth", "steady", "strong", "swift",  "tidy",   "warm"};
constexpr std::array<std::string_view, words_of_a_kind> animals = {
    "fox",       "otter",    "lynx",    "badger",  "beaver",   "hare",      "squirrel",  "hedgehog",
    "marten",    "deer",     "elk",     "bison",   "moose",    "wolf",      "bear",      "panda",
    "koala",     "tiger",    "lion",    "puma",    "jaguar",   "cheetah",   "zebra",     "giraffe",
    "gazelle",   "antelope", "dolphin", "seal",    "walrus",   "penguin",   "puffin",    "heron",
    "crane",     "stork",    "swan",    "robin",   "wren",     "finch",     "lark",      "kestrel",
    "falcon",    "hawk",     "eagle",   "owl",     "raven",    "magpie",    "kiwi",      "toucan",
    "parrot",    "ibis",     "salmon",  "trout",   "turtle",   "gecko",     "newt",      "frog",
    "dragonfly", "beetle",   "cricket", "firefly", "ladybird", "bumblebee", "butterfly", "starfish"};

/// Reads the code points of a text. Returns nullopt if it is not valid UTF-8.
std::optional<std::vector<char32_t>> code_points(std::string_view utf8) {
    std::vector<char32_t> points;
    while (!utf8.empty()) {
        const std::size_t count = text::character_bytes(utf8);
        if (count == 0) {
            return std::nullopt;
        }
        const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(utf8[i]); };
        char32_t point = count == 1 ? byte(0) : byte(0) & (0x7fU >> count);
        for (std::size_t i = 1; i < count; ++i) {
            point = point << 6 | (byte(i) & 0x3fU);
        }
        points.push_back(point);
        utf8.remove_prefix(count);
    }
    return points;
}

void append(std::string& utf8, char32_t point) {
    const auto put = [&](char32_t byte) { utf8 += static_cast<char>(byte); };
    if (point < 0x80) {
        put(point);
    } else if (point < 0x800) {
        put(0xc0 | point >> 6);
        put(0x80 | (point & 0x3f));
    } else if (point < 0x10000) {
        put(0xe0 | point >> 12);
        put(0x80 | (point >> 6 & 0x3f));
        put(0x80 | (point & 0x3f));
    } else {
        put(0xf0 | point >> 18);
        put(0x80 | (point >> 12 & 0x3f));
        put(0x80 | (point >> 6 & 0x3f));
        put(0x80 | (point & 0x3f));
    }
}

struct Points {
    char32_t first, last;
};

template <std::size_t count>
bool is_in(char32_t point, const std::array<Points, count>& ranges) {
    return std::ranges::any_of(ranges, [&](Points range) { return range.first <= point && point <= range.last; });
}

// Unicode's White_Space without the control characters and line ends.
constexpr std::array<Points, 6> spaces = {
    {{0x20, 0x20}, {0xa0, 0xa0}, {0x1680, 0x1680}, {0x2000, 0x200a}, {0x202f, 0x202f}, {0x205f, 0x205f}}};
constexpr char32_t ideographic_space = 0x3000;

// Characters that control, that change the direction of text, or that show nothing (Unicode's Default_Ignorable), and
// those without a meaning of their own (private use).
constexpr std::array<Points, 24> unfit = {
    {{0, 0x1f},          {0x7f, 0x9f},       {0xad, 0xad},       {0x34f, 0x34f},     {0x61c, 0x61c},
     {0x115f, 0x1160},   {0x17b4, 0x17b5},   {0x180b, 0x180f},   {0x200b, 0x200f},   {0x2028, 0x202e},
     {0x2060, 0x206f},   {0x2800, 0x2800},   {0x3164, 0x3164},   {0xe000, 0xf8ff},   {0xfdd0, 0xfdef},
     {0xfe00, 0xfe0f},   {0xfeff, 0xfeff},   {0xffa0, 0xffa0},   {0xfff0, 0xfffb},   {0xfffe, 0xffff},
     {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff}, {0xf0000, 0x10ffff}}};

char32_t lower_case_of(char32_t point) {
    const auto is = [&](char32_t first, char32_t last) { return first <= point && point <= last; };
    if (is('A', 'Z') || (is(0xc0, 0xde) && point != 0xd7) || is(0x391, 0x3a9) || is(0x410, 0x42f)) {
        return point + 0x20;
    }
    if (is(0x400, 0x40f)) {
        return point + 0x50;
    }
    // Pairs of an upper and a lower case letter; in the middle of Latin Extended-A the upper one is odd.
    if (is(0x139, 0x148) || is(0x179, 0x17e)) {
        return point % 2 == 1 ? point + 1 : point;
    }
    if ((is(0x100, 0x177) && point != 0x130 && point != 0x138) || is(0x1e00, 0x1eff) || is(0x48a, 0x4bf)) {
        return point % 2 == 0 ? point + 1 : point;
    }
    return point;
}

/// Letters of the Latin-1 range as people write them without accents, from U+00DF.
constexpr std::array<std::string_view, 33> plain_letters = {
    "ss", "a", "a", "a", "a", "ae", "a",  "ae", "c",  "e", "e", "e", "e",  "i", "i",  "i", "i",
    "d",  "n", "o", "o", "o", "o",  "oe", "",   "oe", "u", "u", "u", "ue", "y", "th", "y"};

} // namespace

bool is_class_name(std::string_view name) {
    const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
    return !name.empty() && name.size() <= class_name_bytes_max && is_letter(name[0]) &&
           std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-'; });
}

base::Result<std::string> cleaned_member_name(std::string_view given, const std::string& field) {
    const auto refused = [&](const std::string& got) {
        base::Refusal why = refusal(base::RefusalCode::InvalidArgument,
                                    field + ": " + text::violation_text(got, std::string{member_name_allowed}));
        why.violations = {{field, std::string{member_name_allowed}, got}};
        return why;
    };
    constexpr std::size_t bytes_max = 1000;
    if (given.size() > bytes_max) {
        return refused(std::to_string(given.size()) + " bytes");
    }
    const auto points = code_points(given);
    if (!points) {
        return refused("bytes that are not UTF-8");
    }
    std::string name;
    std::size_t count = 0;
    bool after_space = false;
    for (const char32_t point : *points) {
        if (is_in(point, unfit)) {
            constexpr std::string_view digits = "0123456789ABCDEF";
            std::string hex;
            for (int shift = point > 0xffff ? 20 : 12; shift >= 0; shift -= 4) {
                hex += digits[point >> shift & 15];
            }
            return refused("the character U+" + hex);
        }
        if (is_in(point, spaces) || point == ideographic_space) {
            after_space = count > 0;
            continue;
        }
        if (after_space) {
            name += ' ';
            ++count;
        }
        after_space = false;
        append(name, point);
        ++count;
    }
    if (count > member_name_characters_max) {
        return refused(std::to_string(count) + " characters");
    }
    return name;
}

std::string folded(std::string_view name) {
    std::string lower;
    for (const char32_t point : code_points(name).value_or(std::vector<char32_t>{})) {
        append(lower, lower_case_of(point));
    }
    return lower;
}

std::string slug_of(std::string_view member_name) {
    constexpr std::size_t bytes_max = 24;
    std::string slug;
    for (const char32_t point : code_points(folded(member_name)).value_or(std::vector<char32_t>{})) {
        if ((point >= 'a' && point <= 'z') || (point >= '0' && point <= '9')) {
            slug += static_cast<char>(point);
        } else if (point >= 0xdf && point <= 0xff) {
            slug += plain_letters[point - 0xdf];
        } else if (!slug.empty() && slug.back() != '-') {
            slug += '-';
        }
    }
    slug.resize(std::min(slug.size(), bytes_max));
    while (!slug.empty() && slug.back() == '-') {
        slug.pop_back();
    }
    return slug.empty() ? "member" : slug;
}

std::string made_up_name(std::uint64_t number) {
    const std::uint64_t pair = number % made_up_names;
    return std::string{adjectives[pair / animals.size()]} + "-" + std::string{animals[pair % animals.size()]};
}

} // namespace evod::classes
