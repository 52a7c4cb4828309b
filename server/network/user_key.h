// UserKey: the client_key of commands, together with the user to whom it belongs. Equal client keys of different users
// are different keys.
#pragma once

#include <string>

namespace evod::network {

struct UserKey {
    std::string user; // name of the session's token; empty: the session has no token
    std::string client_key;

    friend bool operator==(const UserKey&, const UserKey&) = default;
};

} // namespace evod::network
