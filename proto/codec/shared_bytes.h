// SharedBytes: immutable encoded bytes that several receivers share.
#pragma once

#include <memory>
#include <string>

namespace evod::codec {

using SharedBytes = std::shared_ptr<const std::string>;

} // namespace evod::codec
