#include "server/network/description.h"

#include "evod/v1/session.pb.h"
#include "server/protocol/parameters.h"

#include <google/protobuf/descriptor.pb.h>

#include <set>
#include <string>

namespace evod::network {
namespace {

/// Adds a file after all files that it imports.
void add(const google::protobuf::FileDescriptor& file, google::protobuf::FileDescriptorSet& set,
         std::set<std::string>& added) {
    if (!added.insert(file.name()).second) {
        return;
    }
    for (int i = 0; i < file.dependency_count(); ++i) {
        add(*file.dependency(i), set, added);
    }
    file.CopyTo(set.add_file());
}

v1::Description make_description() {
    v1::Description description;
    google::protobuf::FileDescriptorSet set;
    std::set<std::string> added;
    add(*v1::ClientMessage::descriptor()->file(), set, added);
    description.set_file_descriptor_set(set.SerializeAsString());
    for (const auto& parameter : parameters::parameter_registry()) {
        *description.add_parameters() = protocol::to_proto(parameter);
    }
    return description;
}

} // namespace

const v1::Description& description() {
    static const v1::Description description = make_description();
    return description;
}

} // namespace evod::network
