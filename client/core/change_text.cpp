#include "client/core/change_text.h"

#include "client/core/actor.h"
#include "proto/text/number_text.h"

namespace evod::core {

std::string to_text(const v1::ParameterValue& value) {
    switch (value.kind_case()) {
    case v1::ParameterValue::kReal:
        return text::number_text(value.real(), text::Exponent::IfLong);
    case v1::ParameterValue::kCount:
        return std::to_string(value.count());
    case v1::ParameterValue::kFlag:
        return value.flag() ? "true" : "false";
    case v1::ParameterValue::kChoice:
        return value.choice();
    default:
        return "-";
    }
}

std::string to_text(const v1::AppliedChange& change) {
    std::string text = "generation " + std::to_string(change.generation()) + ":";
    for (int i = 0; i < change.values_size(); ++i) {
        const v1::ChangedValue& value = change.values(i);
        text += (i > 0 ? ", " : " ") + value.name() + " " + to_text(value.before()) + " → " + to_text(value.after());
    }
    return text + " by " + to_text(change.by());
}

} // namespace evod::core
