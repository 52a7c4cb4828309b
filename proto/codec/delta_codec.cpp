#include "proto/codec/delta_codec.h"

#include "proto/codec/body.h"
#include "proto/codec/compression.h"
#include "proto/codec/framing.h"
#include "proto/codec/prediction.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace evod::codec {

namespace {

// Flags in the parts of a section.
constexpr std::uint8_t some_are_gone = 1, some_have_come = 2, have_headings = 4, have_species = 8;
constexpr std::uint32_t size_bytes = 2;    // size of a radius, health, half width or half height
constexpr std::uint32_t heading_bytes = 1; // size of a heading
constexpr std::uint32_t species_bytes = 1; // size of a species

/// Describes a kind of entity: its columns, and which of them can change.
struct Kind {
    const char* name;
    Entities QuantisedSnapshot::*entities;
    EntitiesView QuantisedView::*seen;
    Baseline::Displacements Baseline::*displacements; // set if entities of this kind move
    BaselineView::Displacements BaselineView::*seen_displacements;
    bool ids; // entities have ids on a whole island; in a tile all kinds have ids
    bool sizes, health;
};

const std::array<Kind, 5> kinds{{
    {"organisms", &QuantisedSnapshot::organisms, &QuantisedView::organisms, &Baseline::organisms,
     &BaselineView::organisms, true, true, true},
    {"food", &QuantisedSnapshot::food, &QuantisedView::food, nullptr, nullptr, true, false, false},
    {"poison", &QuantisedSnapshot::poison, &QuantisedView::poison, nullptr, nullptr, true, false, false},
    {"crates", &QuantisedSnapshot::crates, &QuantisedView::crates, &Baseline::crates, &BaselineView::crates, false,
     true, false},
    {"obstacles", &QuantisedSnapshot::obstacles, &QuantisedView::obstacles, nullptr, nullptr, false, true, false},
}};

// ---- matching the entities of two snapshots --------------------------------------------------------------------

struct Pairing {
    Column gone; // indices in the base, in rising order
    Column come; // indices in the next snapshot, in rising order
};

bool have_ids(const Kind& kind, bool of_tile) {
    return kind.ids || of_tile;
}

/// Pairs entities by id. Compares whole blocks as long as all entities in them are the same, which is the usual case.
/// Otherwise it compares single entities without a branch, because the outcome is unpredictable.
///
/// same  takes two indices of entities with equal ids. Returns 1 if these entities are the same, otherwise 0.
template <class Same>
Pairing pair_by_id(const EntitiesView& base, const EntitiesView& next, const Same& same) {
    const auto base_count = static_cast<std::uint32_t>(base.id.size());
    const auto next_count = static_cast<std::uint32_t>(next.id.size());
    // The columns have one extra element, because the index of an entity that stays is also written; the next index
    // overwrites it.
    Pairing pairing{.gone = Column(base_count + std::size_t{1}), .come = Column(next_count + std::size_t{1})};
    std::uint32_t i = 0, j = 0, gone = 0, come = 0;
    constexpr std::uint32_t block = 32;
    while (i < base_count && j < next_count) {
        while (base_count - i >= block && next_count - j >= block) {
            unsigned all_same = 1;
            for (std::uint32_t k = 0; k < block; ++k) { // no branch, so that the compiler can use vector instructions
                all_same &= unsigned{base.id[i + k] == next.id[j + k]} & same(i + k, j + k);
            }
            if (!all_same) {
                break;
            }
            i += block;
            j += block;
        }
        for (std::uint32_t steps = 0; steps < block && i < base_count && j < next_count; ++steps) {
            const std::uint32_t a = base.id[i], b = next.id[j];
            const unsigned stays = unsigned{a == b} & same(i, j);
            pairing.gone[gone] = i;
            pairing.come[come] = j;
            gone += unsigned{a <= b} & ~stays;
            come += unsigned{b <= a} & ~stays;
            i += a <= b;
            j += b <= a;
        }
    }
    while (i < base_count) {
        pairing.gone[gone++] = i++;
    }
    while (j < next_count) {
        pairing.come[come++] = j++;
    }
    pairing.gone.resize(gone);
    pairing.come.resize(come);
    return pairing;
}

/// Two organisms are the same if their id, radius and species are equal; two items, if their id and position are equal;
/// two crates in a tile, if their id and size are equal; two obstacles in a tile, if their id, size and position are
/// equal.
/// The boxes of a whole island are the same if follows() is true.
Pairing pair(const Kind& kind, const EntitiesView& base, const EntitiesView& next, bool of_tile) {
    if (!have_ids(kind, of_tile)) {
        return {};
    }
    const auto same_at = [](Numbers a, Numbers b) {
        return [a, b](std::uint32_t i, std::uint32_t j) { return unsigned{a[i] == b[j]}; };
    };
    const auto width = same_at(base.width, next.width), height = same_at(base.height, next.height);
    const auto x = same_at(base.x, next.x), y = same_at(base.y, next.y);
    if (kind.health && !base.species.empty() && !next.species.empty()) {
        const auto species = same_at(base.species, next.species);
        return pair_by_id(base, next, [=](std::uint32_t i, std::uint32_t j) { return width(i, j) & species(i, j); });
    }
    if (kind.health) {
        return pair_by_id(base, next, width);
    }
    const auto same_size = [=](std::uint32_t i, std::uint32_t j) { return width(i, j) & height(i, j); };
    if (kind.displacements) {
        return pair_by_id(base, next, same_size);
    }
    const auto same_place = [=](std::uint32_t i, std::uint32_t j) { return x(i, j) & y(i, j); };
    if (kind.sizes) {
        return pair_by_id(base, next,
                          [=](std::uint32_t i, std::uint32_t j) { return same_place(i, j) & same_size(i, j); });
    }
    return pair_by_id(base, next, same_place);
}

/// Returns the numbers from 0 to count - 1.
Column indices(std::size_t count) {
    Column all(count);
    std::iota(all.begin(), all.end(), 0U);
    return all;
}

/// Returns whether most of a large number of immovable entities have been replaced. Sending all of them again then
/// needs about the same number of bytes and far less time. A sample of the first entities suffices, because positions
/// do not depend on ids.
bool mostly_replaced(const Kind& kind, const EntitiesView& base, const EntitiesView& next, bool of_tile) {
    constexpr std::size_t many = 2048, sampled = 256, stayed_max = sampled / 4;
    if (kind.displacements || base.id.size() < many) {
        return false;
    }
    const auto first = [](const EntitiesView& of, std::size_t count) {
        const auto part = [&](Numbers column) { return column.first(std::min(count, column.size())); };
        return EntitiesView{part(of.id), part(of.x), part(of.y), part(of.width), part(of.height)};
    };
    const auto next_sampled = std::ranges::lower_bound(next.id, base.id[sampled]) - next.id.begin();
    const Pairing pairing = pair(kind, first(base, sampled), first(next, next_sampled), of_tile);
    return sampled - pairing.gone.size() <= stayed_max;
}

/// Calls stayed(base index, next index, count) for each sequence of `count` adjacent entities that are in both
/// snapshots.
template <class Stayed>
void each_that_stayed(const Pairing& pairing, std::size_t base_count, const Stayed& stayed) {
    auto gone = pairing.gone.begin();
    auto come = pairing.come.begin();
    for (std::size_t i = 0, j = 0; i < base_count;) {
        if (gone != pairing.gone.end() && *gone == i) {
            ++gone;
            ++i;
        } else if (come != pairing.come.end() && *come == j) {
            ++come;
            ++j;
        } else {
            const std::size_t until_gone = (gone == pairing.gone.end() ? base_count : *gone) - i;
            const std::size_t count = come == pairing.come.end() ? until_gone : std::min(until_gone, *come - j);
            stayed(i, j, count);
            i += count;
            j += count;
        }
    }
}

Column at(Numbers column, Numbers indices) {
    Column chosen(indices.size());
    std::transform(indices.begin(), indices.end(), chosen.begin(), [&](std::uint32_t i) { return column[i]; });
    return chosen;
}

// ---- encoding --------------------------------------------------------------------------------------------------

/// Writes which entities of one kind are gone, and the entities that have come.
///
/// pairing        the match between the entities of the base and `entities`.
/// displacements  the displacements of `entities`; nullptr: all are 0.
void write_parts(BodyWriter& writer, const Kind& kind, const EntitiesView& entities, std::uint32_t position_bytes,
                 const Pairing& pairing, const BaselineView::Displacements* displacements) {
    const Column& come = pairing.come;
    writer.number(static_cast<std::uint8_t>(
        (pairing.gone.empty() ? 0 : some_are_gone) | (come.empty() ? 0 : some_have_come) |
        (entities.heading.empty() ? 0 : have_headings) | (entities.species.empty() ? 0 : have_species)));
    if (!pairing.gone.empty()) {
        writer.number(static_cast<std::uint32_t>(pairing.gone.size()));
        writer.rising_column(pairing.gone);
    }
    if (come.empty()) {
        return;
    }
    writer.number(static_cast<std::uint32_t>(come.size()));
    if (!entities.id.empty()) {
        writer.rising_column(at(entities.id, come));
    }
    writer.planes(entities.x, come, position_bytes);
    writer.planes(entities.y, come, position_bytes);
    if (kind.sizes) {
        writer.planes(entities.width, come, size_bytes);
        writer.planes(entities.height, come, size_bytes);
    }
    if (!entities.heading.empty()) {
        writer.planes(entities.heading, come, heading_bytes);
    }
    if (!entities.species.empty()) {
        writer.planes(entities.species, come, species_bytes);
    }
    if (kind.displacements) {
        const Column still(displacements ? 0 : come.size(), 0);
        writer.column(displacements ? at(displacements->x, come) : still);
        writer.column(displacements ? at(displacements->y, come) : still);
    }
}

// ---- decoding --------------------------------------------------------------------------------------------------

/// Returns `column` without the elements at `indices`, which are in rising order.
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
    Baseline::Displacements displacements;
};

/// Returns all columns of a section.
std::array<Column*, 9> columns_of(Section& section) {
    Entities& of = section.entities;
    return {&of.id,
            &of.x,
            &of.y,
            &of.width,
            &of.height,
            &of.heading,
            &of.species,
            &section.displacements.x,
            &section.displacements.y};
}

/// Inserts the entities `come` into `stayed`: ordered by id, or at the end if the kind has no ids.
void merge(BodyReader& reader, Section& stayed, Section come) {
    const std::size_t stayed_count = stayed.entities.x.size(), come_count = come.entities.x.size();
    Column order;
    if (!come.entities.id.empty() && stayed_count > 0) {
        order.reserve(stayed_count + come_count);
        const Column &a = stayed.entities.id, &b = come.entities.id;
        for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
            if (i < a.size() && j < b.size() && a[i] == b[j]) {
                reader.refuse("adds id " + std::to_string(a[i]) + ", which its base already has");
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
    bool of_tile;
};

/// Reads the entities of one kind that have come.
///
/// count_max  the number of entities of this kind in the snapshot.
Section read_come(const Kind& kind, BodyReader& reader, unsigned parts, std::uint32_t count_max, const Step& step) {
    Section come;
    const auto come_count = reader.number<std::uint32_t>();
    // Each entity needs at least the bytes of its position, so the remaining bytes limit the memory that is
    // allocated.
    if (come_count > count_max || reader.rest_bytes() / (2 * std::size_t{step.position_bytes}) < come_count) {
        reader.refuse("adds more entities than its count says");
        return {};
    }
    if (have_ids(kind, step.of_tile)) {
        come.entities.id = reader.rising_column(come_count, std::uint64_t{1} << 32);
    }
    come.entities.x = reader.planes(come_count, step.position_bytes);
    come.entities.y = reader.planes(come_count, step.position_bytes);
    if (kind.sizes) {
        come.entities.width = reader.planes(come_count, size_bytes);
        come.entities.height = reader.planes(come_count, size_bytes);
    }
    if (parts & have_headings) {
        come.entities.heading = reader.planes(come_count, heading_bytes);
    }
    if (parts & have_species) {
        come.entities.species = reader.planes(come_count, species_bytes);
    }
    if (kind.displacements) {
        come.displacements.x = reader.column(come_count);
        come.displacements.y = reader.column(come_count);
    }
    return come;
}

/// Reads the section of one kind of entity.
///
/// base   the section of this kind in the baseline.
/// count  the number of entities of this kind in the snapshot.
Section read_section(const Kind& kind, BodyReader& reader, Section base, std::uint32_t count, const Step& step) {
    const auto parts = reader.number<std::uint8_t>();
    const unsigned parts_max = kind.health ? 15 : 3; // only organisms have headings and species
    if (parts > parts_max) {
        reader.refuse("has parts " + std::to_string(parts) + ", not 0 to " + std::to_string(parts_max));
        return {};
    }
    const std::size_t base_count = base.entities.x.size();
    const bool headings = (parts & have_headings) != 0;
    if (base_count > 0 && headings != base.entities.has_headings() && count > 0) {
        reader.refuse(headings ? "has headings, unlike its base" : "has no headings, unlike its base");
        return {};
    }
    const bool species = (parts & have_species) != 0;
    if (base_count > 0 && species != base.entities.has_species() && count > 0) {
        reader.refuse(species ? "has species, unlike its base" : "has no species, unlike its base");
        return {};
    }
    Section section = std::move(base);
    if (parts & some_are_gone) {
        const auto gone_count = reader.number<std::uint32_t>();
        if (gone_count > base_count) {
            reader.refuse("removes more entities than its base has");
            return {};
        }
        const Column gone = reader.rising_column(gone_count, base_count);
        for (Column* column : columns_of(section)) {
            *column = without(std::move(*column), gone);
        }
    }
    Section come = parts & some_have_come ? read_come(kind, reader, parts, count, step) : Section{};
    const std::size_t stayed_count = section.entities.x.size();
    if (!reader.damage() && stayed_count + come.entities.x.size() != count) {
        reader.refuse("has " + std::to_string(stayed_count + come.entities.x.size()) + " " + kind.name + ", not " +
                      std::to_string(count));
    }
    if (stayed_count > 0 && kind.displacements) {
        const Prediction predicted{step.ticks, step.base_ticks};
        const auto move = [&](Column& positions, Column& displacements) {
            Column moved = reader.column(stayed_count);
            if (reader.damage()) {
                return;
            }
            for (std::size_t i = 0; i < stayed_count; ++i) {
                moved[i] += predicted(displacements[i]);
            }
            add(positions, moved);
            if (step.ticks > 0) {
                displacements = std::move(moved);
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
    if (stayed_count > 0 && headings) {
        const Column differences = reader.column(stayed_count);
        for (std::size_t i = 0; !reader.damage() && i < stayed_count; ++i) {
            section.entities.heading[i] = (section.entities.heading[i] + differences[i]) % heading_steps;
        }
    }
    const auto too_large = [](std::uint32_t value) { return value > 0xffff; };
    if ((step.position_bytes == 2 &&
         (std::ranges::any_of(section.entities.x, too_large) || std::ranges::any_of(section.entities.y, too_large))) ||
        std::ranges::any_of(section.entities.height, too_large)) {
        reader.refuse("moves a number out of its range");
    }
    if (!reader.damage() && !come.entities.x.empty()) {
        merge(reader, section, std::move(come));
    }
    return section;
}

} // namespace

Baseline initial_baseline(std::shared_ptr<const QuantisedSnapshot> snapshot) {
    Baseline baseline;
    for (const Kind& kind : kinds) {
        if (kind.displacements) {
            Baseline::Displacements& displacements = baseline.*kind.displacements;
            displacements.x.assign(((*snapshot).*kind.entities).x.size(), 0);
            displacements.y = displacements.x;
        }
    }
    baseline.snapshot = std::move(snapshot);
    return baseline;
}

QuantisedView::QuantisedView(const QuantisedSnapshot& snapshot)
    : position_bytes{snapshot.position_bytes}, of_tile{snapshot.of_tile} {
    for (const Kind& kind : kinds) {
        const Entities& entities = snapshot.*kind.entities;
        this->*kind.seen = {entities.id,     entities.x,       entities.y,      entities.width,
                            entities.height, entities.heading, entities.species};
    }
}

BaselineView::BaselineView(const Baseline& baseline)
    : snapshot{*baseline.snapshot}
    , organisms{baseline.organisms.x, baseline.organisms.y}
    , crates{baseline.crates.x, baseline.crates.y}
    , ticks{baseline.ticks} {}

bool follows(const QuantisedView& next, const QuantisedView& base) {
    const auto same = [](Numbers a, Numbers b) { return std::ranges::equal(a, b); };
    const auto same_sizes = [&](const EntitiesView& a, const EntitiesView& b) {
        return same(a.width, b.width) && same(a.height, b.height);
    };
    const bool both_have_organisms = !next.organisms.x.empty() && !base.organisms.x.empty();
    return next.position_bytes == base.position_bytes && next.of_tile == base.of_tile &&
           (!both_have_organisms || (next.organisms.heading.empty() == base.organisms.heading.empty() &&
                                     next.organisms.species.empty() == base.organisms.species.empty())) &&
           (next.of_tile || (same_sizes(next.crates, base.crates) && same_sizes(next.obstacles, base.obstacles) &&
                             same(next.obstacles.x, base.obstacles.x) && same(next.obstacles.y, base.obstacles.y)));
}

namespace {

/// Returns the displacements for a kind of entity that moves.
const AdvancedColumns::Displacements& of_kind(const AdvancedColumns& to, const Kind& kind) {
    return kind.health ? to.organisms : to.crates;
}

} // namespace

void advance_baseline(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                      const AdvancedColumns& moved) {
    for (const Kind& kind : kinds) {
        if (!kind.seen_displacements) {
            continue;
        }
        const EntitiesView &from = base.snapshot.*kind.seen, &to = next.*kind.seen;
        const BaselineView::Displacements& before = base.*kind.seen_displacements;
        const AdvancedColumns::Displacements& now = of_kind(moved, kind);
        each_that_stayed(
            pair(kind, from, to, next.of_tile), from.x.size(), [&](std::size_t i, std::size_t j, std::size_t count) {
                const auto move = [=](Numbers here, Numbers there, Numbers was, std::span<std::uint32_t> is) {
                    for (std::size_t k = 0; k < count; ++k) {
                        is[j + k] = ticks > 0 ? here[j + k] - there[i + k] : was[i + k];
                    }
                };
                move(to.x, from.x, before.x, now.x);
                move(to.y, from.y, before.y, now.y);
            });
    }
}

Baseline advanced_baseline(const Baseline& base, std::shared_ptr<const QuantisedSnapshot> next, std::uint16_t ticks) {
    Baseline baseline = initial_baseline(std::move(next));
    baseline.ticks = ticks > 0 ? ticks : base.ticks;
    advance_baseline(
        base, *baseline.snapshot, ticks,
        {.organisms = {baseline.organisms.x, baseline.organisms.y}, .crates = {baseline.crates.x, baseline.crates.y}});
    return baseline;
}

std::string encode_keyframe(const BaselineView& baseline, Seams* seams) {
    BodyWriter writer;
    writer.number(baseline.ticks);
    for (const Kind& kind : kinds) {
        const EntitiesView& entities = baseline.snapshot.*kind.seen;
        const Pairing everyone{.gone = {}, .come = indices(entities.x.size())};
        write_parts(writer, kind, entities, baseline.snapshot.position_bytes, everyone,
                    kind.seen_displacements ? &(baseline.*kind.seen_displacements) : nullptr);
    }
    if (seams) {
        *seams = writer.take_seams();
    }
    return writer.take();
}

std::string encode_delta(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                         const AdvancedColumns* moved, Seams* seams) {
    BodyWriter writer;
    writer.number(ticks);
    const Prediction predicted{ticks, base.ticks};
    for (const Kind& kind : kinds) {
        const EntitiesView &from = base.snapshot.*kind.seen, &to = next.*kind.seen;
        const Pairing pairing = mostly_replaced(kind, from, to, next.of_tile)
                                    ? Pairing{.gone = indices(from.x.size()), .come = indices(to.x.size())}
                                    : pair(kind, from, to, next.of_tile);
        write_parts(writer, kind, to, next.position_bytes, pairing, nullptr);
        const std::size_t stayed_count = from.x.size() - pairing.gone.size();
        if (stayed_count == 0 || !kind.seen_displacements) {
            continue;
        }
        const auto memory = std::make_unique_for_overwrite<std::uint32_t[]>(stayed_count);
        const std::span residuals{memory.get(), stayed_count};
        const BaselineView::Displacements& displacements = base.*kind.seen_displacements;
        const AdvancedColumns::Displacements* const now = moved ? &of_kind(*moved, kind) : nullptr;
        const auto write = [&](Numbers here, Numbers there, Numbers was, std::span<std::uint32_t> is) {
            std::size_t k = 0;
            each_that_stayed(pairing, from.x.size(), [&](std::size_t i, std::size_t j, std::size_t count) {
                predicted.residuals({here.data() + j, count}, {there.data() + i, count}, {was.data() + i, count},
                                    residuals.data() + k);
                for (std::size_t n = 0; now && n < count; ++n) {
                    is[j + n] = ticks > 0 ? here[j + n] - there[i + n] : was[i + n];
                }
                k += count;
            });
            writer.column(residuals);
        };
        write(to.x, from.x, displacements.x, now ? now->x : std::span<std::uint32_t>{});
        write(to.y, from.y, displacements.y, now ? now->y : std::span<std::uint32_t>{});
        if (kind.health) {
            std::size_t k = 0;
            each_that_stayed(pairing, from.x.size(), [&](std::size_t i, std::size_t j, std::size_t count) {
                for (std::size_t n = 0; n < count; ++n) {
                    residuals[k + n] = to.height[j + n] - from.height[i + n];
                }
                k += count;
            });
            writer.column(residuals);
        }
        if (!to.heading.empty()) {
            std::size_t k = 0;
            each_that_stayed(pairing, from.x.size(), [&](std::size_t i, std::size_t j, std::size_t count) {
                for (std::size_t n = 0; n < count; ++n) {
                    // The cast keeps the difference modulo 256 within one signed byte.
                    residuals[k + n] = static_cast<std::uint32_t>(
                        std::int32_t{static_cast<std::int8_t>(to.heading[j + n] - from.heading[i + n])});
                }
                k += count;
            });
            writer.column(residuals);
        }
    }
    if (seams) {
        *seams = writer.take_seams();
    }
    return writer.take();
}

Result<Baseline> decode_body(std::string_view body, const BodyShape& shape, const Baseline* base) {
    if (base && base->snapshot->position_bytes != shape.position_bytes) {
        return Damage{"a snapshot's position_bytes differ from those of its base"};
    }
    BodyReader reader{body};
    const auto ticks = reader.number<std::uint16_t>();
    const Step step{.ticks = ticks,
                    .base_ticks = base ? base->ticks : std::uint16_t{0},
                    .position_bytes = shape.position_bytes,
                    .of_tile = shape.of_tile};
    auto snapshot = std::make_shared<QuantisedSnapshot>();
    snapshot->position_bytes = shape.position_bytes;
    snapshot->of_tile = shape.of_tile;
    Baseline baseline;
    baseline.ticks = !base || ticks > 0 ? ticks : base->ticks;
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        const Kind& kind = kinds[k];
        Section from;
        if (base) {
            from.entities = (*base->snapshot).*kind.entities;
            if (kind.displacements) {
                from.displacements = base->*kind.displacements;
            }
        }
        Section section = read_section(kind, reader, std::move(from), shape.counts[k], step);
        (*snapshot).*kind.entities = std::move(section.entities);
        if (kind.displacements) {
            baseline.*kind.displacements = std::move(section.displacements);
        }
    }
    if (reader.rest_bytes() > 0) {
        reader.refuse("has surplus bytes at its end");
    }
    if (reader.damage()) {
        return *reader.damage();
    }
    baseline.snapshot = std::move(snapshot);
    return baseline;
}

std::uint64_t body_bytes_max(const Counts& counts, const QuantisedSnapshot* base) {
    constexpr std::uint64_t row_bytes_max = 48, section_bytes_max = 64; // upper bounds of the real sizes
    const Counts base_counts = base ? counts_of(*base) : Counts{};
    std::uint64_t bytes = sizeof(std::uint16_t);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        bytes += section_bytes_max + row_bytes_max * (std::uint64_t{base_counts[k]} + counts[k]);
    }
    return std::min<std::uint64_t>(bytes, *client_limits.stream_bytes_max);
}

std::uint32_t checksum_of(const ChecksummedFields& fields, std::string_view body, std::uint32_t before) {
    std::array<char, 2 * 8 + 6 * 4> about;
    store(fields.sequence, &about[0]);
    store(fields.base_sequence, &about[8]);
    for (std::size_t k = 0; k < fields.counts.size(); ++k) {
        store(fields.counts[k], &about[16 + 4 * k]);
    }
    store(fields.position_bytes, &about[36]);
    return crc32(body, crc32({about.data(), about.size()}, before));
}

std::uint32_t checksum_of(const evod::v1::SnapshotFrame& frame, std::string_view body) {
    return checksum_of({.sequence = frame.sequence(),
                        .base_sequence = frame.base_sequence(),
                        .counts = counts_of(frame),
                        .position_bytes = frame.position_bytes()},
                       body);
}

void clear_unchanging(evod::v1::SnapshotFrame& frame) {
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

} // namespace evod::codec
