// Run fault: why the file of one run cannot be written, while the files of other runs can.
//
// The code of a refusal decides whose trouble a failed write is. DATA_LOSS and FAILED_PRECONDITION: the file is
// damaged, or this version of evod cannot write to it. NOT_FOUND, ALREADY_EXISTS and INVALID_ARGUMENT: the name belongs
// to another file, or to no file. All other codes: the disk cannot be written, which concerns all runs.
#pragma once

#include "server/base/result.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace evod::recording {

/// Identifies a run as long as the storage thread writes it.
using RunNumber = std::uint64_t;

struct RunFault {
    enum class Kind {
        Displaced, // the file was moved or deleted; the storage thread retries until it is back
        Damaged,   // final: nothing is written to the file any more
        Full,      // the file can be written, but it is so large that the run of a member of a class must not go on
    };
    Kind kind = Kind::Displaced;
    base::Refusal why;

    bool operator==(const RunFault& other) const { return kind == other.kind && why.message == other.why.message; }
};

using RunFaults = std::map<RunNumber, RunFault>;

/// Returns the fault that a failed write of a run's file means; nullopt: the disk cannot be written.
inline std::optional<RunFault> fault_of(const base::Refusal& why) {
    switch (why.code) {
    case base::RefusalCode::DataLoss:
    case base::RefusalCode::FailedPrecondition:
        return RunFault{.kind = RunFault::Kind::Damaged, .why = why};
    case base::RefusalCode::NotFound:
    case base::RefusalCode::AlreadyExists:
    case base::RefusalCode::InvalidArgument:
        return RunFault{.kind = RunFault::Kind::Displaced, .why = why};
    default:
        return std::nullopt;
    }
}

} // namespace evod::recording
