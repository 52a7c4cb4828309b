#include "proto/wire/delta_codec.h"

#include "proto/wire/compression.h"
#include "proto/wire/framing.h"
#include "proto/wire/little_endian.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace evod::wire {

namespace {

using Column = std::vector<std::uint32_t>; // of numbers with or without a sign; arithmetic is modulo 2^32
using Numbers = std::span<const std::uint32_t>;

constexpr std::uint8_t some_are_gone = 1, some_have_come = 2; // in a section's parts
constexpr std::uint8_t with_exceptions = 128;                 // in a column's width
constexpr std::uint64_t exception_bytes = 8;
constexpr std::uint32_t size_bytes = 2; // of a radius, health, half width or half height

constexpr float steps_per_px = 16;

/// What entities of a kind have, and what of it can change.
struct Kind {
    const char* name;
    Entities Scene::*entities;
    Footing::Displacements Footing::*displacements; // of those that move
    std::uint32_t (evod::v1::SnapshotFrame::*count)() const;
    bool ids, sizes, health;
};

const std::array<Kind, 5> kinds{{
    {"organisms", &Scene::organisms, &Footing::organisms, &evod::v1::SnapshotFrame::organism_count, true, true, true},
    {"food", &Scene::food, nullptr, &evod::v1::SnapshotFrame::food_count, true, false, false},
    {"poison", &Scene::poison, nullptr, &evod::v1::SnapshotFrame::poison_count, true, false, false},
    {"crates", &Scene::crates, &Footing::crates, &evod::v1::SnapshotFrame::crate_count, false, true, false},
    {"obstacles", &Scene::obstacles, nullptr, &evod::v1::SnapshotFrame::obstacle_count, false, true, false},
}};

/// How far something moves in `ticks` that moved by `displacement` in base_ticks, if it goes on as it did.
class Foretold {
  public:
    Foretold(std::uint16_t ticks, std::uint16_t base_ticks)
        : ticks_{ticks}, base_ticks_{std::max<std::uint16_t>(base_ticks, 1)} {}

    std::uint32_t operator()(std::uint32_t displacement) const {
        if (ticks_ == base_ticks_) {
            return displacement;
        }
        const std::int64_t way = std::int64_t{static_cast<std::int32_t>(displacement)} * ticks_;
        const std::int64_t rounded_down = way / base_ticks_ - (way % base_ticks_ < 0 ? 1 : 0);
        return static_cast<std::uint32_t>(rounded_down);
    }

  private:
    std::int64_t ticks_, base_ticks_;
};

// ---- which entities of two pictures are the same ---------------------------------------------------------------

struct Pairing {
    Column gone; // indices in the base, rising
    Column come; // indices in the next picture, rising
};

template <class Same>
Pairing pair_by_id(const Entities& base, const Entities& next, const Same& same) {
    Pairing pairing;
    std::uint32_t i = 0, j = 0;
    const auto base_count = static_cast<std::uint32_t>(base.id.size());
    const auto next_count = static_cast<std::uint32_t>(next.id.size());
    while (i < base_count || j < next_count) {
        if (j == next_count || (i < base_count && base.id[i] < next.id[j])) {
            pairing.gone.push_back(i++);
        } else if (i == base_count || next.id[j] < base.id[i]) {
            pairing.come.push_back(j++);
        } else {
            if (!same(i, j)) {
                pairing.gone.push_back(i);
                pairing.come.push_back(j);
            }
            ++i;
            ++j;
        }
    }
    return pairing;
}

/// An organism stays the same while it has its id and its radius, an item while it lies where it lay. Boxes are the
/// same where follows() holds.
Pairing pair(const Kind& kind, const Entities& base, const Entities& next) {
    if (!kind.ids) {
        return {};
    }
    if (kind.displacements) {
        return pair_by_id(base, next, [&](auto i, auto j) { return base.width[i] == next.width[j]; });
    }
    return pair_by_id(base, next, [&](auto i, auto j) { return base.x[i] == next.x[j] && base.y[i] == next.y[j]; });
}

/// Calls stayed(base index, next index) for those that are in both, in their order.
template <class Stayed>
void each_that_stayed(const Pairing& pairing, std::size_t base_count, const Stayed& stayed) {
    auto gone = pairing.gone.begin();
    auto come = pairing.come.begin();
    std::size_t j = 0;
    for (std::size_t i = 0; i < base_count; ++i) {
        if (gone != pairing.gone.end() && *gone == i) {
            ++gone;
            continue;
        }
        for (; come != pairing.come.end() && *come == j; ++come) {
            ++j;
        }
        stayed(i, j++);
    }
}

Column at(Numbers column, Numbers indices) {
    Column chosen(indices.size());
    std::transform(indices.begin(), indices.end(), chosen.begin(), [&](std::uint32_t i) { return column[i]; });
    return chosen;
}

// ---- encoding --------------------------------------------------------------------------------------------------

class BodyWriter {
  public:
    template <std::unsigned_integral Number>
    void number(Number value) {
        store(value, grow(sizeof value));
    }

    /// Whole numbers of sizeof(Number) bytes.
    template <std::unsigned_integral Number>
    void plain(Numbers values) {
        char* const to = grow(values.size() * sizeof(Number));
        for (std::size_t i = 0; i < values.size(); ++i) {
            store(static_cast<Number>(values[i]), to + i * sizeof(Number));
        }
    }

    /// The lowest byte of each, then the next of each: those that are all but the same stand together.
    void planes(Numbers values, std::uint32_t bytes) {
        for (std::uint32_t plane = 0; plane < bytes; ++plane) {
            char* const to = grow(values.size());
            for (std::size_t i = 0; i < values.size(); ++i) {
                to[i] = static_cast<char>(values[i] >> (8 * plane));
            }
        }
    }

    /// Signed numbers, in the width that takes the fewest bytes.
    void column(Numbers values) {
        // How many need more than 0, 1, 2 bytes.
        std::uint64_t not_zero = 0, above_8_bits = 0, above_16_bits = 0;
        for (const std::uint32_t value : values) {
            not_zero += value != 0;
            above_8_bits += value + 0x80U > 0xffU;
            above_16_bits += value + 0x8000U > 0xffffU;
        }
        struct Form {
            std::uint64_t width, exceptions;
            std::uint64_t bytes(std::uint64_t count) const {
                return count * width + (exceptions > 0 ? 4 + exceptions * exception_bytes : 0);
            }
        };
        const std::array<Form, 4> forms{{{0, not_zero}, {1, above_8_bits}, {2, above_16_bits}, {4, 0}}};
        const Form form = *std::min_element(forms.begin(), forms.end(), [&](const Form& a, const Form& b) {
            return a.bytes(values.size()) < b.bytes(values.size());
        });
        number(static_cast<std::uint8_t>(form.width | (form.exceptions > 0 ? with_exceptions : 0)));
        if (form.width == 0) {
            exceptions(values, form.exceptions, [](std::uint32_t value) { return value != 0; });
        } else if (form.width == 1) {
            const auto fits_not = [](std::uint32_t value) { return value + 0x80U > 0xffU; };
            exceptions(values, form.exceptions, fits_not);
            fitting<std::uint8_t>(values, fits_not);
        } else if (form.width == 2) {
            const auto fits_not = [](std::uint32_t value) { return value + 0x8000U > 0xffffU; };
            exceptions(values, form.exceptions, fits_not);
            fitting<std::uint16_t>(values, fits_not);
        } else {
            plain<std::uint32_t>(values);
        }
    }

    void rising_column(Numbers values) {
        Column steps(values.size());
        std::uint32_t before = std::numeric_limits<std::uint32_t>::max(); // -1
        for (std::size_t i = 0; i < values.size(); ++i) {
            steps[i] = values[i] - before - 1;
            before = values[i];
        }
        column(steps);
    }

    std::string take() { return std::move(body_); }

  private:
    template <class Condition>
    void exceptions(Numbers values, std::uint64_t count, const Condition& is_exception) {
        if (count == 0) {
            return;
        }
        number(static_cast<std::uint32_t>(count));
        Column indices, exceptional;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (is_exception(values[i])) {
                indices.push_back(static_cast<std::uint32_t>(i));
                exceptional.push_back(values[i]);
            }
        }
        plain<std::uint32_t>(indices);
        plain<std::uint32_t>(exceptional);
    }
    template <std::unsigned_integral Number, class Condition>
    void fitting(Numbers values, const Condition& is_exception) {
        char* const to = grow(values.size() * sizeof(Number));
        for (std::size_t i = 0; i < values.size(); ++i) {
            store(is_exception(values[i]) ? Number{0} : static_cast<Number>(values[i]), to + i * sizeof(Number));
        }
    }
    char* grow(std::size_t bytes) {
        body_.resize(body_.size() + bytes);
        return body_.data() + body_.size() - bytes;
    }

    std::string body_;
};

/// gone  indices in the base; come: indices in `entities`; displacements: of `entities`, null: those that come stand.
void write_parts(BodyWriter& writer, const Kind& kind, const Entities& entities, std::uint32_t position_bytes,
                 const Pairing& pairing, const Footing::Displacements* displacements) {
    const Column& come = pairing.come;
    writer.number(
        static_cast<std::uint8_t>((pairing.gone.empty() ? 0 : some_are_gone) | (come.empty() ? 0 : some_have_come)));
    if (!pairing.gone.empty()) {
        writer.number(static_cast<std::uint32_t>(pairing.gone.size()));
        writer.rising_column(pairing.gone);
    }
    if (come.empty()) {
        return;
    }
    writer.number(static_cast<std::uint32_t>(come.size()));
    if (kind.ids) {
        writer.rising_column(at(entities.id, come));
    }
    writer.planes(at(entities.x, come), position_bytes);
    writer.planes(at(entities.y, come), position_bytes);
    if (kind.sizes) {
        writer.planes(at(entities.width, come), size_bytes);
        writer.planes(at(entities.height, come), size_bytes);
    }
    if (kind.displacements) {
        const Column still(displacements ? 0 : come.size());
        writer.column(displacements ? at(displacements->x, come) : still);
        writer.column(displacements ? at(displacements->y, come) : still);
    }
}

// ---- decoding --------------------------------------------------------------------------------------------------

/// Reads what a body should hold. After the first thing that is wrong everything is empty or 0.
class BodyReader {
  public:
    explicit BodyReader(std::string_view body) : rest_{body} {}

    const std::optional<Damage>& damage() const { return damage_; }
    std::size_t rest_bytes() const { return rest_.size(); }

    void refuse(const std::string& why) {
        if (!damage_) {
            damage_ = Damage{"a snapshot's body " + why};
        }
    }

    template <std::unsigned_integral Number>
    Number number() {
        return take(sizeof(Number)) ? load<Number>(taken_) : Number{0};
    }

    template <std::unsigned_integral Number>
    Column plain(std::size_t count) {
        return numbers<Number>(count, [](Number value) { return std::uint32_t{value}; });
    }

    Column positions(std::size_t count, std::uint32_t position_bytes) {
        return position_bytes == 2 ? plain<std::uint16_t>(count) : plain<std::uint32_t>(count);
    }

    Column planes(std::size_t count, std::uint32_t bytes) {
        if (!take(count * bytes)) {
            return {};
        }
        Column values(count);
        for (std::uint32_t plane = 0; plane < bytes; ++plane) {
            const char* const from = taken_ + plane * count;
            for (std::size_t i = 0; i < count; ++i) {
                values[i] |= std::uint32_t{static_cast<unsigned char>(from[i])} << (8 * plane);
            }
        }
        return values;
    }

    /// The caller sees to it that there is memory for `count` numbers.
    Column column(std::size_t count) {
        const auto width = number<std::uint8_t>();
        Column indices, values;
        if (width & with_exceptions) {
            const auto exception_count = number<std::uint32_t>();
            indices = plain<std::uint32_t>(exception_count);
            values = plain<std::uint32_t>(exception_count);
        }
        Column result;
        switch (width & ~with_exceptions) {
        case 0:
            result.resize(damage_ ? 0 : count);
            break;
        case 1:
            result = numbers<std::uint8_t>(count, [](std::uint8_t value) { return widened(std::int8_t(value)); });
            break;
        case 2:
            result = numbers<std::uint16_t>(count, [](std::uint16_t value) { return widened(std::int16_t(value)); });
            break;
        case 4:
            result = plain<std::uint32_t>(count);
            break;
        default:
            refuse("has a column of width " + std::to_string(width & ~with_exceptions) + ", not 0, 1, 2 or 4");
        }
        for (std::size_t i = 0; i < indices.size() && !damage_; ++i) {
            if (indices[i] >= count) {
                refuse("has an exception for number " + std::to_string(indices[i]) + " of " + std::to_string(count));
            } else {
                result[indices[i]] = values[i];
            }
        }
        return damage_ ? Column{} : result;
    }

    /// Numbers below `end`.
    Column rising_column(std::size_t count, std::uint64_t end) {
        Column steps = column(count);
        std::uint64_t next = 0;
        for (std::uint32_t& value : steps) {
            next += value;
            if (next >= end) {
                refuse("has an id or index that is too large");
                return {};
            }
            value = static_cast<std::uint32_t>(next++);
        }
        return steps;
    }

  private:
    static std::uint32_t widened(std::int32_t value) { return static_cast<std::uint32_t>(value); }

    bool take(std::size_t bytes) {
        if (damage_ || rest_.size() < bytes) {
            refuse("ends too early");
            return false;
        }
        taken_ = rest_.data();
        rest_.remove_prefix(bytes);
        return true;
    }
    template <std::unsigned_integral Number, class Convert>
    Column numbers(std::size_t count, const Convert& convert) {
        if (!take(count * sizeof(Number))) {
            return {};
        }
        Column values(count);
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = convert(load<Number>(taken_ + i * sizeof(Number)));
        }
        return values;
    }

    std::string_view rest_;
    const char* taken_ = nullptr;
    std::optional<Damage> damage_;
};

/// `column` without what stands at the rising `indices`.
Column without(Column column, Numbers indices) {
    if (indices.empty() || column.empty()) {
        return column;
    }
    std::size_t kept = indices.front(), next = 0;
    for (std::size_t i = kept; i < column.size(); ++i) {
        if (next < indices.size() && indices[next] == i) {
            ++next;
        } else {
            column[kept++] = column[i];
        }
    }
    column.resize(kept);
    return column;
}

void add(Column& to, Numbers what) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        to[i] += what[i];
    }
}

struct Section {
    Entities entities;
    Footing::Displacements displacements;
};

/// Every column of a section that may hold something.
std::array<Column*, 7> columns_of(Section& section) {
    return {&section.entities.id,     &section.entities.x,      &section.entities.y,     &section.entities.width,
            &section.entities.height, &section.displacements.x, &section.displacements.y};
}

/// Puts `come` among `stayed`, by id or at the end.
void merge(const Kind& kind, BodyReader& reader, Section& stayed, Section& come) {
    const std::size_t stayed_count = stayed.entities.x.size(), come_count = come.entities.x.size();
    Column order;
    if (kind.ids && stayed_count > 0) {
        order.reserve(stayed_count + come_count);
        const Column &a = stayed.entities.id, &b = come.entities.id;
        for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
            if (i < a.size() && j < b.size() && a[i] == b[j]) {
                reader.refuse("lets id " + std::to_string(a[i]) + " come, which is there");
                return;
            }
            const bool first = j == b.size() || (i < a.size() && a[i] < b[j]);
            order.push_back(static_cast<std::uint32_t>(first ? i++ : stayed_count + j++));
        }
    }
    const auto of_stayed = columns_of(stayed), of_come = columns_of(come);
    for (std::size_t c = 0; c < of_stayed.size(); ++c) {
        Column& column = *of_stayed[c];
        column.insert(column.end(), of_come[c]->begin(), of_come[c]->end());
        if (!order.empty() && !column.empty()) {
            column = at(column, order);
        }
    }
}

struct Step {
    std::uint16_t ticks, base_ticks;
    std::uint32_t position_bytes;
};

/// base  what the section is told from; count: of the picture.
Section read_section(const Kind& kind, BodyReader& reader, Section base, std::uint32_t count, const Step& step) {
    const auto parts = reader.number<std::uint8_t>();
    if (parts & ~(some_are_gone | some_have_come)) {
        reader.refuse("has parts " + std::to_string(parts) + ", not 0 to 3");
        return {};
    }
    const std::size_t base_count = base.entities.x.size();
    Section section = std::move(base);
    if (parts & some_are_gone) {
        const auto gone_count = reader.number<std::uint32_t>();
        if (gone_count > base_count) {
            reader.refuse("lets more go than there were");
            return {};
        }
        const Column gone = reader.rising_column(gone_count, base_count);
        for (Column* column : columns_of(section)) {
            *column = without(std::move(*column), gone);
        }
    }
    Section come;
    if (parts & some_have_come) {
        const auto come_count = reader.number<std::uint32_t>();
        // Places are never told in fewer bytes, so that what is read bounds the memory for all columns.
        if (come_count > count || reader.rest_bytes() / (2 * std::size_t{step.position_bytes}) < come_count) {
            reader.refuse("lets more come than there are");
            return {};
        }
        if (kind.ids) {
            come.entities.id = reader.rising_column(come_count, std::uint64_t{1} << 32);
        }
        come.entities.x = reader.planes(come_count, step.position_bytes);
        come.entities.y = reader.planes(come_count, step.position_bytes);
        if (kind.sizes) {
            come.entities.width = reader.planes(come_count, size_bytes);
            come.entities.height = reader.planes(come_count, size_bytes);
        }
        if (kind.displacements) {
            come.displacements.x = reader.column(come_count);
            come.displacements.y = reader.column(come_count);
        }
    }
    const std::size_t stayed_count = section.entities.x.size();
    if (!reader.damage() && stayed_count + come.entities.x.size() != count) {
        reader.refuse("comes to " + std::to_string(stayed_count + come.entities.x.size()) + " " + kind.name + ", not " +
                      std::to_string(count));
    }
    if (stayed_count > 0 && kind.displacements) {
        const Foretold foretold{step.ticks, step.base_ticks};
        const auto move = [&](Column& places, Column& displacements) {
            Column way = reader.column(stayed_count);
            if (reader.damage()) {
                return;
            }
            for (std::size_t i = 0; i < stayed_count; ++i) {
                way[i] += foretold(displacements[i]);
            }
            add(places, way);
            if (step.ticks > 0) {
                displacements = std::move(way);
            }
        };
        move(section.entities.x, section.displacements.x);
        move(section.entities.y, section.displacements.y);
    }
    if (stayed_count > 0 && kind.health) {
        const Column differences = reader.column(stayed_count);
        if (!reader.damage()) {
            add(section.entities.height, differences);
        }
    }
    const auto fits_not = [](std::uint32_t value) { return value > 0xffff; };
    if ((step.position_bytes == 2 &&
         (std::ranges::any_of(section.entities.x, fits_not) || std::ranges::any_of(section.entities.y, fits_not))) ||
        std::ranges::any_of(section.entities.height, fits_not)) {
        reader.refuse("takes a number out of its column's range");
    }
    if (!reader.damage() && !come.entities.x.empty()) {
        merge(kind, reader, section, come);
    }
    return section;
}

std::vector<float> in_px(const Column& steps) {
    std::vector<float> values(steps.size());
    std::transform(steps.begin(), steps.end(), values.begin(),
                   [](std::uint32_t step) { return static_cast<float>(step) * (1 / steps_per_px); });
    return values;
}

void draw(const Scene& scene, Picture& picture) {
    picture.organisms = {scene.organisms.id, in_px(scene.organisms.x), in_px(scene.organisms.y),
                         in_px(scene.organisms.width), in_px(scene.organisms.height)};
    picture.food = {scene.food.id, in_px(scene.food.x), in_px(scene.food.y)};
    picture.poison = {scene.poison.id, in_px(scene.poison.x), in_px(scene.poison.y)};
    picture.crates = {in_px(scene.crates.x), in_px(scene.crates.y), in_px(scene.crates.width),
                      in_px(scene.crates.height)};
    picture.obstacles = {in_px(scene.obstacles.x), in_px(scene.obstacles.y), in_px(scene.obstacles.width),
                         in_px(scene.obstacles.height)};
}

/// The longest body that a picture of these counts can have, told from `base`; null: a keyframe.
std::uint64_t body_bytes_max(const evod::v1::SnapshotFrame& frame, const Scene* base) {
    constexpr std::uint64_t row_bytes_max = 48, section_bytes_max = 64; // somewhat more than any can take
    std::uint64_t bytes = sizeof(std::uint16_t);
    for (const Kind& kind : kinds) {
        const std::uint64_t base_count = base ? (base->*kind.entities).x.size() : 0;
        bytes += section_bytes_max + row_bytes_max * (base_count + (frame.*kind.count)());
    }
    return std::min<std::uint64_t>(bytes, *client_limits.stream_bytes_max);
}

} // namespace

Scene scene_of(const evod::v1::SnapshotFrame& frame) {
    Scene scene;
    scene.position_bytes = frame.position_bytes();
    BodyReader reader{frame.body()};
    for (const Kind& kind : kinds) {
        Entities& entities = scene.*kind.entities;
        const std::size_t count = (frame.*kind.count)();
        if (kind.ids) {
            entities.id = reader.plain<std::uint32_t>(count);
        }
        entities.x = reader.positions(count, scene.position_bytes);
        entities.y = reader.positions(count, scene.position_bytes);
        if (kind.sizes) {
            entities.width = reader.plain<std::uint16_t>(count);
            entities.height = reader.plain<std::uint16_t>(count);
        }
    }
    return scene;
}

Footing standing(std::shared_ptr<const Scene> scene) {
    Footing footing;
    for (const Kind& kind : kinds) {
        if (kind.displacements) {
            Footing::Displacements& displacements = footing.*kind.displacements;
            displacements.x.resize(((*scene).*kind.entities).x.size());
            displacements.y = displacements.x;
        }
    }
    footing.scene = std::move(scene);
    return footing;
}

bool follows(const Scene& next, const Scene& base) {
    return next.position_bytes == base.position_bytes && next.obstacles == base.obstacles &&
           next.crates.width == base.crates.width && next.crates.height == base.crates.height;
}

Footing moved_on(const Footing& base, std::shared_ptr<const Scene> next, std::uint16_t ticks) {
    Footing footing = standing(std::move(next));
    footing.ticks = ticks > 0 ? ticks : base.ticks;
    for (const Kind& kind : kinds) {
        if (!kind.displacements) {
            continue;
        }
        const Entities &from = (*base.scene).*kind.entities, &to = (*footing.scene).*kind.entities;
        const Footing::Displacements& before = base.*kind.displacements;
        Footing::Displacements& displacements = footing.*kind.displacements;
        each_that_stayed(pair(kind, from, to), from.x.size(), [&](std::size_t i, std::size_t j) {
            displacements.x[j] = ticks > 0 ? to.x[j] - from.x[i] : before.x[i];
            displacements.y[j] = ticks > 0 ? to.y[j] - from.y[i] : before.y[i];
        });
    }
    return footing;
}

std::string encode_keyframe(const Footing& footing) {
    BodyWriter writer;
    writer.number(footing.ticks);
    for (const Kind& kind : kinds) {
        const Entities& entities = (*footing.scene).*kind.entities;
        Pairing everyone;
        everyone.come.resize(entities.x.size());
        std::iota(everyone.come.begin(), everyone.come.end(), 0U);
        write_parts(writer, kind, entities, footing.scene->position_bytes, everyone,
                    kind.displacements ? &(footing.*kind.displacements) : nullptr);
    }
    return writer.take();
}

std::string encode_delta(const Footing& base, const Scene& next, std::uint16_t ticks) {
    BodyWriter writer;
    writer.number(ticks);
    const Foretold foretold{ticks, base.ticks};
    for (const Kind& kind : kinds) {
        const Entities &from = (*base.scene).*kind.entities, &to = next.*kind.entities;
        const Pairing pairing = pair(kind, from, to);
        write_parts(writer, kind, to, next.position_bytes, pairing, nullptr);
        const std::size_t stayed_count = from.x.size() - pairing.gone.size();
        if (stayed_count == 0 || !kind.displacements) {
            continue;
        }
        Column x(stayed_count), y(stayed_count), health(kind.health ? stayed_count : 0);
        const Footing::Displacements& displacements = base.*kind.displacements;
        std::size_t k = 0;
        each_that_stayed(pairing, from.x.size(), [&](std::size_t i, std::size_t j) {
            x[k] = to.x[j] - from.x[i] - foretold(displacements.x[i]);
            y[k] = to.y[j] - from.y[i] - foretold(displacements.y[i]);
            if (kind.health) {
                health[k] = to.height[j] - from.height[i];
            }
            ++k;
        });
        writer.column(x);
        writer.column(y);
        if (kind.health) {
            writer.column(health);
        }
    }
    return writer.take();
}

std::uint32_t checksum_of(const evod::v1::SnapshotFrame& frame, std::string_view body) {
    std::array<char, 2 * 8 + 6 * 4> about;
    store(std::uint64_t{frame.sequence()}, &about[0]);
    store(std::uint64_t{frame.base_sequence()}, &about[8]);
    std::size_t to = 16;
    for (const Kind& kind : kinds) {
        store(std::uint32_t{(frame.*kind.count)()}, &about[to]);
        to += 4;
    }
    store(std::uint32_t{frame.position_bytes()}, &about[to]);
    return crc32(body, crc32({about.data(), about.size()}));
}

void leave_out_unchanging(evod::v1::SnapshotFrame& frame) {
    frame.clear_world();
    frame.clear_run_id();
    frame.clear_island_count();
    frame.clear_width_px();
    frame.clear_height_px();
    frame.clear_item_radius_px();
}

bool same_unchanging(const evod::v1::SnapshotFrame& a, const evod::v1::SnapshotFrame& b) {
    return a.world() == b.world() && a.run_id() == b.run_id() && a.island_count() == b.island_count() &&
           a.width_px() == b.width_px() && a.height_px() == b.height_px() && a.item_radius_px() == b.item_radius_px();
}

Result<Picture> PictureDecoder::decode(evod::v1::SnapshotFrame frame) {
    if (frame.codec() != evod::v1::CODEC_DELTA) {
        return wire::decode(std::move(frame));
    }
    auto picture = decode_delta(std::move(frame));
    if (!picture) {
        base_.reset();
    }
    return picture;
}

Result<Picture> PictureDecoder::decode_delta(evod::v1::SnapshotFrame frame) {
    const bool keyframe = frame.base_sequence() == 0;
    if (!keyframe && !base_) {
        return Damage{"a snapshot is told from one that is not known here: a keyframe is needed"};
    }
    if (!keyframe && frame.base_sequence() != base_->about.sequence()) {
        return Damage{"a snapshot's base_sequence is " + std::to_string(frame.base_sequence()) +
                      ", not the last one, " + std::to_string(base_->about.sequence())};
    }
    if (!keyframe) {
        frame.set_world(base_->about.world());
        frame.set_run_id(base_->about.run_id());
        frame.set_island_count(base_->about.island_count());
        frame.set_width_px(base_->about.width_px());
        frame.set_height_px(base_->about.height_px());
        frame.set_item_radius_px(base_->about.item_radius_px());
    }
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    const Scene* const base = keyframe ? nullptr : base_->footing.scene.get();
    if (base && base->position_bytes != frame.position_bytes()) {
        return Damage{"a snapshot's position_bytes differ from those of its base"};
    }
    std::string body = std::move(*frame.mutable_body());
    frame.clear_body();
    if (frame.compression() == evod::v1::COMPRESSION_ZSTD) {
        auto content = decompress(body, body_bytes_max(frame, base));
        if (!content) {
            return content.error();
        }
        body = *std::move(content);
    } else if (frame.compression() != evod::v1::COMPRESSION_NONE &&
               frame.compression() != evod::v1::COMPRESSION_UNSPECIFIED) {
        return Damage{"a snapshot's compression is " + std::to_string(frame.compression()) +
                      ", not one that is known here"};
    }
    if (checksum_of(frame, body) != frame.checksum()) {
        return Damage{"a snapshot's checksum is not that of its body"};
    }

    BodyReader reader{body};
    const auto ticks = reader.number<std::uint16_t>();
    const Step step{.ticks = ticks,
                    .base_ticks = keyframe ? std::uint16_t{0} : base_->footing.ticks,
                    .position_bytes = frame.position_bytes()};
    auto scene = std::make_shared<Scene>();
    scene->position_bytes = frame.position_bytes();
    Footing footing;
    footing.ticks = keyframe || ticks > 0 ? ticks : base_->footing.ticks;
    for (const Kind& kind : kinds) {
        Section from;
        if (base) {
            from.entities = base->*kind.entities;
            if (kind.displacements) {
                from.displacements = base_->footing.*kind.displacements;
            }
        }
        Section section = read_section(kind, reader, std::move(from), (frame.*kind.count)(), step);
        (*scene).*kind.entities = std::move(section.entities);
        if (kind.displacements) {
            footing.*kind.displacements = std::move(section.displacements);
        }
    }
    if (reader.rest_bytes() > 0) {
        reader.refuse("has bytes at its end that mean nothing");
    }
    if (reader.damage()) {
        return *reader.damage();
    }
    Picture picture;
    draw(*scene, picture);
    footing.scene = std::move(scene);
    base_ = Base{.footing = std::move(footing), .about = frame};
    picture.about = std::move(frame);
    return picture;
}

} // namespace evod::wire
