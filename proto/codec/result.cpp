#include "proto/codec/result.h"

#include <boost/throw_exception.hpp>

#include <stdexcept>

namespace evod::codec {

void throw_exception_from_error(const Damage& damage, const boost::source_location& where) {
    boost::throw_exception(std::runtime_error{damage.what}, where);
}

} // namespace evod::codec
