#include "server/classes/qr_code.h"

#include <qrencode.h>

#include <memory>

namespace evod::classes {

std::optional<QrModules> qr_code_of(const std::string& text) {
    constexpr int smallest_version = 0;
    const std::unique_ptr<QRcode, void (*)(QRcode*)> code{
        QRcode_encodeData(static_cast<int>(text.size()), reinterpret_cast<const unsigned char*>(text.data()),
                          smallest_version, QR_ECLEVEL_M),
        QRcode_free};
    if (!code) {
        return std::nullopt;
    }
    const auto side = static_cast<std::uint32_t>(code->width);
    QrModules made{.size = side, .modules = std::string(std::size_t{side} * side, '\0')};
    for (std::size_t i = 0; i < made.modules.size(); ++i) {
        made.modules[i] = static_cast<char>(code->data[i] & 1); // the other bits say what the module is for
    }
    return made;
}

} // namespace evod::classes
