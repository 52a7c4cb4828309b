// Columns of snapshots for tests, written in px or in health.
#pragma once

#include "proto/codec/quantised_snapshot.h"

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <utility>

namespace evod::codec {

/// The values must be multiples of 1/16.
inline Column px_column(std::initializer_list<float> px) {
    Column column(px.size());
    std::transform(px.begin(), px.end(), column.begin(), steps_of);
    return column;
}

/// A snapshot with these organisms and nothing else.
inline std::shared_ptr<const QuantisedSnapshot> snapshot_with(Entities organisms) {
    QuantisedSnapshot snapshot;
    snapshot.organisms = std::move(organisms);
    return std::make_shared<const QuantisedSnapshot>(std::move(snapshot));
}

} // namespace evod::codec
