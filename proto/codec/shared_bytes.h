// SharedBytes: encoded bytes that several receivers share; immutable.
#pragma once

#include <memory>
#include <string>

namespace evod::codec {

using SharedBytes = std::shared_ptr<const std::string>;

} // namespace evod::codec
