#include "client/ctl/qr_text.h"

#include <cstddef>

namespace evod::ctl {

std::string qr_text(const v1::QrCode& code, bool colored) {
    constexpr int quiet_zone = 4, size_max = 177; // modules; the largest code of the standard
    const int size = static_cast<int>(code.size());
    if (code.size() < 1 || code.size() > size_max ||
        code.modules().size() != static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {
        return "";
    }
    const auto is_light = [&](int row, int column) {
        const bool outside = row < 0 || column < 0 || row >= size || column >= size;
        return outside || code.modules()[static_cast<std::size_t>(row * size + column)] == 0;
    };
    std::string text;
    for (int row = -quiet_zone; row < size + quiet_zone; row += 2) {
        text += colored ? "\033[40;97m" : "";
        for (int column = -quiet_zone; column < size + quiet_zone; ++column) {
            const bool upper = is_light(row, column);
            const bool lower = row + 1 < size + quiet_zone && is_light(row + 1, column);
            text += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
        }
        text += colored ? "\033[0m\n" : "\n";
    }
    return text;
}

} // namespace evod::ctl
