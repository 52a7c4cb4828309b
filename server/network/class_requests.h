// Class requests: handles the requests of REQUEST_KIND_CLASS. A teacher reads and changes only the own classes.
//
// Owner        the dispatcher, on the network thread.
// Durable      the registry has written each change before it is answered.
#pragma once

#include "server/classes/membership.h"
#include "server/classes/registry.h"
#include "server/network/class_admission.h"
#include "server/network/class_events.h"
#include "server/network/session.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace evod::network {

/// What the simulation does for classes. All functions are called and call back on the network thread.
struct ClassActions {
    /// Creates the world of a member. Returns false if the simulation is too busy.
    std::function<bool(v1::Request, simulation::Ownership)> create_world;
    /// Sends a command on behalf of the server.
    std::function<void(v1::Request)> send;
    /// Sets the rules of a class for its worlds, then calls `done` with all its worlds.
    ///
    /// rules  nullopt: the class is deleted.
    std::function<void(const std::string& name, std::optional<simulation::ClassRules> rules, base::Actor by,
                       std::function<void(const std::vector<std::string>& worlds)> done)>
        set_class;
};

class ClassRequests {
  public:
    /// All arguments must outlive this object.
    ///
    /// draw  random bits for codes and tokens.
    ClassRequests(asio::io_context& context, classes::Registry& registry, const Sessions& sessions, SessionHost& host,
                  ClassActions actions, classes::Draw draw);

    /// Must be called once, after the registry was read and before clients are served.
    void begin();
    /// Handles a request that the session has admitted.
    void handle(Session& session, const v1::Request& request);
    /// Returns why a ForEachWorld of this session is refused whatever its action is; nullopt: its class is one that the
    /// session may change.
    std::optional<base::Refusal> refusal_of(const Session& session, const v1::ForEachWorld& request) const;
    /// ClassAdmission::admit().
    std::optional<base::Result<AdmittedMember>> admit(const v1::Hello& hello) { return admission_.admit(hello); }
    /// Must be called when a session has ended.
    void forget(const Session& session);

  private:
    using Answer = base::Result<v1::Response>;

    /// The class that a request describes.
    base::Result<classes::Class> checked(const v1::CreateClass& given, const std::string& teacher) const;
    void create(Session& session, const v1::Request& request);
    void update(Session& session, const v1::Request& request);
    void erase(Session& session, const v1::Request& request);
    v1::Response list(const Session& session, std::uint64_t request_id) const;
    base::Result<v1::Response> add_members(const Session& session, const v1::Request& request);
    base::Result<v1::Response> change_member(const Session& session, const v1::Request& request);
    /// Makes the codes one after another, and lets the thread do other work in between.
    void make_qr_codes(Session& session, const v1::Request& request);

    /// The class with this name, which the session may change.
    base::Result<const classes::Class*> managed(const Session& session, const std::string& name,
                                                const std::string& field) const;
    v1::ClassInfo info_of(const classes::Class& of) const;
    void delete_worlds(const std::vector<std::string>& worlds) const;
    void create_world(const classes::Class& of, const classes::Member& member);
    /// Ends the sessions of this user, or of all members of a class if `user` ends with a "/".
    void end_sessions(const std::string& user, const base::Refusal& why) const;

    asio::io_context& context_;
    classes::Registry& registry_;
    const Sessions& sessions_;
    ClassActions actions_;
    const ClassAdmission::Services services_;
    ClassEvents events_;
    ClassAdmission admission_;
};

} // namespace evod::network
