// The interface of the component evod_mpi, which processes.cpp loads.
#pragma once

#include "server/runtime/processes.h"

extern "C" {
/// Returns EVOD_VERSION of the component. The program uses a component only if this is its own version.
const char* evod_mpi_version();
/// Starts MPI and joins the other processes (join_processes()). Called at most once in a process. The caller deletes
/// the object.
evod::runtime::Processes* evod_mpi_join(long long patience_s, bool first_may_rest);
}
