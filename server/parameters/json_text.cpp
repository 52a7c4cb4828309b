#include "server/parameters/json_text.h"

#include <boost/json.hpp>

#include <algorithm>

namespace evod::parameters {

namespace json = boost::json;

std::size_t line_of(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, offset);
    return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

base::Result<json::value> parse_json(std::string_view text) {
    json::stream_parser parser;
    boost::system::error_code error;
    const std::size_t read = parser.write_some(text, error);
    if (!error && read < text.size() && text.find_first_not_of(" \t\r\n", read) != std::string_view::npos) {
        error = json::error::extra_data;
    }
    if (!error) {
        parser.finish(error);
    }
    if (error) {
        return base::refusal(base::RefusalCode::InvalidArgument,
                             "not JSON: line " + std::to_string(line_of(text, std::min(read, text.size()))) + ": " +
                                 error.message());
    }
    return parser.release();
}

} // namespace evod::parameters
