#include "server/files/regular_file.h"

#include <utility>

namespace evod::files {

using base::RefusalCode;
using base::Result;

namespace {

RefusalCode code_of(InputError::Kind kind) {
    switch (kind) {
    case InputError::Kind::NotFound:
        return RefusalCode::NotFound;
    case InputError::Kind::NotAFile:
        return RefusalCode::FailedPrecondition;
    case InputError::Kind::TooLarge:
        return RefusalCode::InvalidArgument;
    case InputError::Kind::Unreadable:
        break;
    }
    return RefusalCode::Unavailable;
}

base::Refusal refused(const std::string& path, const InputError& error) {
    return refusal(code_of(error.kind), path + ": " + error.why);
}

} // namespace

Result<RegularFile> RegularFile::open(const std::string& path, std::string_view kind, Links links) {
    auto file = InputFile::open(path, kind, links);
    if (!file) {
        return refused(path, file.error());
    }
    return RegularFile{path, *std::move(file)};
}

Result<std::string> RegularFile::read(std::size_t bytes_max) const {
    auto text = file_.read(bytes_max);
    if (!text) {
        return refused(path_, text.error());
    }
    return *std::move(text);
}

Result<std::string> read_file(const std::string& path, std::string_view kind, std::size_t bytes_max) {
    auto text = read_input(path, kind, bytes_max);
    if (!text) {
        return refused(path, text.error());
    }
    return *std::move(text);
}

} // namespace evod::files
